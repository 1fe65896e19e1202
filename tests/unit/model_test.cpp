// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models of the fast engine whose vertices move.
#include "limber/model.h"
#include "limber/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "bvh/tree.h"
#include "bvh/tree_cost.h"
#include "reference/reference.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

void expect_refused(const Result<void>& result, ErrorCode code, const std::string& part) {
  ASSERT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().code, code);
  EXPECT_NE(result.error().text.find(part), std::string::npos) << result.error().text;
}

TEST(Model, RefusesWhatItCannotTakeAndStaysAsItWas) {
  Model model(scenes::thesis_ball());
  const std::vector<Vec3> before = model.mesh().positions();
  const auto last = static_cast<VertexId>(before.size() - 1);
  const std::vector<Vec3> two{{0, 0, 1}, {0, 0, 2}};
  expect_refused(model.move_vertices(std::vector<VertexId>{0, last + 1}, two), ErrorCode::index_out_of_range,
                 "entry 1");
  expect_refused(model.move_vertices(std::vector<VertexId>{0}, two), ErrorCode::size_mismatch, "2 positions for 1 ids");
  expect_refused(model.move_vertices(std::vector<VertexId>{0, 1}, std::vector<Vec3>{{0, 0, 1}, {0, NAN, 0}}),
                 ErrorCode::non_finite, "entry 1");
  expect_refused(model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{1e70, 0, 1}}), ErrorCode::too_large,
                 "entry 0");
  expect_refused(model.move_all(two), ErrorCode::size_mismatch, "2 positions for");
  std::vector<Vec3> all = before;
  all[5].x = INFINITY;
  expect_refused(model.move_all(all), ErrorCode::non_finite, "entry 5");
  EXPECT_EQ(model.mesh().positions(), before);
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 0U);
}

TEST(Model, RefitsEveryNodeAboveAVertexOnceHoweverOftenItMoves) {
  Model model(scenes::wave_sheet(100, 100, 0));
  const std::vector<VertexId> ids{5000, 5000, 5001, 5000};
  const std::vector<Vec3> positions(4, {2, 2, 3});
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, positions)));
  EXPECT_FALSE(model.is_committed());
  model.commit();
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.mesh().positions()[5000], (Vec3{2, 2, 3}));
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 4U);
  // At most the nodes of the triangles at two neighbours, and a path to the root for each.
  EXPECT_GE(model.maintenance_stats().refits, model.tree_stats().levels);
  EXPECT_LE(model.maintenance_stats().refits, 4 * model.tree_stats().levels);
  ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
}

TEST(Model, StopsWhereNothingChanges) {
  Model model(scenes::wave_sheet(100, 100, 0));
  const Vec3 same = model.mesh().positions()[777];
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{777}, std::vector<Vec3>{same})));
  model.commit();
  EXPECT_LE(model.maintenance_stats().refits, 4U);
  model.commit();  // nothing is left
  EXPECT_LE(model.maintenance_stats().refits, 4U);
}

TEST(Model, IsAfterRebuildAsIfJustBuilt) {
  const scenes::Motion soup = scenes::shuffled_soup(3000);
  for (const double motion_margin : {0.0, 10.0}) {
    Model moved(soup.mesh, {.motion_margin = motion_margin, .rebuild_policy = RebuildPolicy::off});
    ASSERT_TRUE(static_cast<bool>(moved.move_all(soup.positions(400))));
    moved.commit();
    moved.rebuild();
    const Model built(Mesh::create(soup.positions(400), soup.mesh.triangles()).value());
    ASSERT_TRUE(static_cast<bool>(moved.validate())) << moved.validate().error().text;
    ASSERT_EQ(tree_of(moved).slack, 0);
    // The centers by which triangles are sorted are rounded relative to another origin, so a few triangles may be in
    // other leaves.
    EXPECT_NEAR(bvh::TreeCost::of(tree_of(moved), bvh::subtree_of(tree_of(moved), bvh::root_slot)),
                bvh::TreeCost::of(tree_of(built), bvh::subtree_of(tree_of(built), bvh::root_slot)), 0.02);
  }
}

/// Plays a motion in which triangles change places, and checks every frame. Returns for each model the ratio of its
/// node tests to those with newly built trees.
std::vector<double> play(const scenes::Motion& motion, const std::vector<Model*>& models, int frames) {
  std::vector<Vec3> small = scenes::ball(8, 5).positions();
  for (Vec3& p : small) p *= 0.05;
  const Model probe(Mesh::create(small, scenes::ball(8, 5).triangles()).value());
  Rng rng(312);
  std::vector<double> visits(models.size());
  double fresh_visits = 0;
  for (int frame = 1; frame <= frames; ++frame) {
    const std::vector<Vec3> positions = motion.positions(frame);
    for (Model* model : models) {
      EXPECT_TRUE(static_cast<bool>(model->move_all(positions)));
      model->commit();
      EXPECT_TRUE(static_cast<bool>(model->validate())) << model->validate().error().text << " in frame " << frame;
    }
    const Model fresh(Mesh::create(positions, motion.mesh.triangles()).value());
    for (int i = 0; i < 4; ++i) {
      const Placed placed{probe, random_pose(rng, 1)};
      const bool counts = 2 * frame >= frames;
      const DistanceResult wanted = distance({fresh}, placed);
      fresh_visits += counts ? static_cast<double>(wanted.stats.node_tests) : 0;
      for (std::size_t m = 0; m < models.size(); ++m) {
        const DistanceResult found = distance({*models[m]}, placed);
        EXPECT_NEAR(found.upper, wanted.upper, 1e-14) << frame;
        visits[m] += counts ? static_cast<double>(found.stats.node_tests) : 0;
      }
    }
  }
  for (double& count : visits) count /= fresh_visits;
  return visits;
}

TEST(Model, KeepsUpWithTrianglesThatChangePlaces) {
  const scenes::Motion soup = scenes::shuffled_soup(4000);
  Model never_rebuilt(soup.mesh, {.rebuild_policy = RebuildPolicy::off}), no_time(soup.mesh, {.rebuild_budget_us = 0});
  Model in_commit(soup.mesh), slowly(soup.mesh, {.rebuild_budget_us = 100});
  Model on_worker(soup.mesh, {.rebuild_policy = RebuildPolicy::on_worker});
  const std::vector<Model*> models{&never_rebuilt, &no_time, &in_commit, &slowly, &on_worker};
  const std::vector<double> visits = play(soup, models, 150);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::uint64_t rebuilt_triangles = models[m]->maintenance_stats().rebuilt_triangles;
    if (m < 2) {
      EXPECT_GT(visits[m], 2) << m;
      EXPECT_EQ(rebuilt_triangles, 0U) << m;
    } else {
      EXPECT_LT(visits[m], 1.3) << m;
      EXPECT_GT(rebuilt_triangles, 4000U) << m;
    }
  }
}

TEST(Model, RebuildsOnlyWhatHasDegraded) {
  // Eight soups in a row, of which one is shuffled.
  constexpr std::uint32_t count = 1024, soups = 8;
  const scenes::Motion soup = scenes::shuffled_soup(count);
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t k = 0; k < soups; ++k) {
    const auto first = static_cast<VertexId>(positions.size());
    for (const Vec3& p : soup.mesh.positions()) positions.push_back(p + Vec3{10.0 * k, 0, 0});
    for (const Corners& c : soup.mesh.triangles()) triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
  }
  Model model(Mesh::create(positions, triangles).value());
  for (int frame = 1; model.maintenance_stats().rebuilt_triangles == 0; ++frame) {
    ASSERT_LT(frame, 32);
    const std::vector<Vec3> shuffled = soup.positions(4 * frame);
    std::copy(shuffled.begin(), shuffled.end(), positions.begin());
    ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
    model.commit();
    ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
  }
  EXPECT_LE(model.maintenance_stats().rebuilt_triangles, count);
}

TEST(Model, StartsOverWithAnotherMesh) {
  Model model(scenes::thesis_ball(), {.motion_margin = 0.25});
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{3}, std::vector<Vec3>{{1, 2, 3}})));
  model.reset(scenes::thesis_square());
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.options().motion_margin, 0.25);
  EXPECT_EQ(model.mesh().triangles().size(), 8192U);
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 0U);
  EXPECT_TRUE(static_cast<bool>(model.validate()));
}

TEST(Model, IsAfterMovingAllPieceByPieceAsIfJustFitted) {
  // One tree is refitted in hundreds of commits, each of a few nodes and their ancestors. The other tree had the same
  // leaves at the start and is fitted once at the end.
  const Mesh start = scenes::wave_sheet(60, 60, 0), end = scenes::wave_sheet(60, 60, 0.4);
  Model moved(start, {.rebuild_policy = RebuildPolicy::off});
  bvh::Tree fitted = tree_of(moved);
  bvh::fit(fitted, end);
  constexpr std::size_t at_once = 10;
  const std::size_t count = start.positions().size();
  for (std::size_t first = 0; first < count; first += at_once) {
    std::vector<VertexId> ids;
    for (std::size_t v = first; v < std::min(first + at_once, count); ++v) ids.push_back(static_cast<VertexId>(v));
    ASSERT_TRUE(static_cast<bool>(moved.move_vertices(ids, std::span(end.positions()).subspan(first, ids.size()))));
    moved.commit();
  }
  ASSERT_LT(moved.maintenance_stats().refits, count / at_once * fitted.nodes.size() / 4);
  ASSERT_TRUE(static_cast<bool>(moved.validate())) << moved.validate().error().text;
  const bvh::Tree& tree = tree_of(moved);
  ASSERT_EQ(tree.unit, fitted.unit);
  for (std::uint32_t i = 0; i < fitted.nodes.size(); ++i) {
    const bvh::ChildBounds &n = tree.nodes[i].bounds, &m = fitted.nodes[i].bounds;
    for (std::uint32_t k = 0; k < fitted.nodes[i].child_count; ++k) {
      // Origins of nodes are corners of either sheet, so float32 rounds differently.
      const float rounding = 1e-5F * m.radius[k];
      const Vec3 apart = bvh::slot_center(tree, i * bvh::width + k) - bvh::slot_center(fitted, i * bvh::width + k);
      ASSERT_LE(length(apart), static_cast<double>(rounding) * tree.unit) << i;
      for (const auto& [now, wanted] :
           {std::pair(n.radius, m.radius), std::pair(n.half_x, m.half_x), std::pair(n.half_y, m.half_y),
            std::pair(n.half_z, m.half_z), std::pair(n.low, m.low), std::pair(n.high, m.high)}) {
        ASSERT_NEAR(now[k], wanted[k], rounding) << i;
      }
    }
  }
}

TEST(Model, StaysSoundWhereverItsVerticesMove) {
  // The mesh moves far away and back, collapses to a point, grows and shrinks. Units and origins have to adapt.
  Rng rng(310);
  Model model(scenes::ball(12, 7));
  const std::vector<Vec3> start = model.mesh().positions();
  const Model other(scenes::grid(6, 6, -3, -3, 1, 1));
  for (const double scale : {1.0, 0x1p-60, 1e-6, 0.0, 1.0, 0x1p90, 1e3, 1.0}) {
    for (const Vec3& at : {Vec3{}, Vec3{1e5, -2e6, 3}, Vec3{0.1, 0.2, 40}}) {
      std::vector<Vec3> positions = start;
      for (Vec3& p : positions) p = p * scale + at;
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text << " at scale " << scale;
      const double truth = reference::distance({model.mesh()}, {other.mesh()}).upper;
      ASSERT_NEAR(distance({model}, {other}).upper, truth, 1e-14 * (scale + length(at) + 10)) << scale;
      // The same with one vertex at a time.
      for (int i = 0; i < 20; ++i) {
        const auto v = static_cast<VertexId>(rng.below(start.size()));
        ASSERT_TRUE(static_cast<bool>(
            model.move_vertices(std::vector<VertexId>{v}, std::vector<Vec3>{start[v] * rng.uniform(0, 2)})));
        model.commit();
        ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text << " at scale " << scale;
      }
    }
  }
}

TEST(Model, GrowsFromAPointAndByAnyFactor) {
  const Mesh ball = scenes::ball(12, 7);
  const Model other(scenes::grid(6, 6, -3, -3, 1, 1));
  const auto check = [&](Model& model) {
    ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
    const double truth = reference::distance({model.mesh()}, {other.mesh(), {{}, {0, 0, -3}}}).upper;
    const double size = max_abs(model.mesh().positions()[5]) + 1;
    ASSERT_NEAR(distance({model}, {other, {{}, {0, 0, -3}}}).upper, truth, 1e-14 * size);
  };
  const std::vector<Vec3> nowhere(ball.positions().size());
  for (const double motion_margin : {0.0, 0.1, 10.0}) {
    // A placeholder that becomes a shape, collapses, and comes back.
    Model model(Mesh::create(nowhere, ball.triangles()).value(), {.motion_margin = motion_margin});
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(static_cast<bool>(model.move_all(ball.positions())));
      model.commit();
      check(model);
      for (int k = 0; k < 3; ++k) {
        ASSERT_TRUE(static_cast<bool>(model.move_all(nowhere)));
        model.commit();
        check(model);
      }
    }
    // One vertex far out, and back.
    for (const double far : {1e39, 1e10, 1e59, 1.0}) {
      const std::vector<Vec3> to{{far, 0, 0}};
      ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{5}, to)));
      model.commit();
      check(model);
    }
  }
}

TEST(Model, RebuildsFromThePresentPositions) {
  const scenes::Motion soup = scenes::shuffled_soup(3000);
  Model model(soup.mesh);
  std::vector<Vec3> positions = soup.positions(400);
  for (Vec3& p : positions) p += Vec3{1e9, 1e9, 1e9};
  ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
  model.rebuild();
  const Model built(Mesh::create(positions, soup.mesh.triangles()).value());
  EXPECT_NEAR(bvh::TreeCost::of(tree_of(model), bvh::subtree_of(tree_of(model), bvh::root_slot)),
              bvh::TreeCost::of(tree_of(built), bvh::subtree_of(tree_of(built), bvh::root_slot)), 0.02);
}

TEST(Model, ValidateNamesAVertexBeyondTheMotionMarginInUse) {
  Model model(scenes::thesis_ball(), {.motion_margin = 0.5});
  const Vec3 at = model.mesh().positions()[7];
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(std::vector<VertexId>{7}, std::vector<Vec3>{at * 1.25})));
  model.commit();
  ASSERT_TRUE(static_cast<bool>(model.validate()));
  // Queries rely on this margin.
  const_cast<bvh::Tree&>(tree_of(model)).slack *= 0.5;
  const Result<void> result = model.validate();
  ASSERT_FALSE(static_cast<bool>(result));
  EXPECT_EQ(result.error().where, 7U);
}

TEST(Model, InvalidatesCachesWhenItMoves) {
  Model ball(scenes::thesis_ball());
  const Model square(scenes::thesis_square());
  const Placed there{ball, {{}, {0, 0, 3}}};
  QueryCache cache;
  EXPECT_NEAR(distance({square}, there, {.cache = &cache}).upper, 2, 1e-2);
  std::vector<Vec3> positions = ball.mesh().positions();
  for (Vec3& p : positions) p.z -= 1.5;
  ASSERT_TRUE(static_cast<bool>(ball.move_all(positions)));
  ball.commit();
  EXPECT_EQ(distance({square}, there, {.cache = &cache}).upper, distance({square}, there).upper);
  // The closest triangles stay where they are, and a triangle in a node that the cache has pruned comes closer.
  const auto top =
      std::max_element(positions.begin(), positions.end(), [](const Vec3& p, const Vec3& q) { return p.z < q.z; });
  const std::vector<VertexId> ids{static_cast<VertexId>(top - positions.begin())};
  ASSERT_TRUE(static_cast<bool>(ball.move_vertices(ids, std::vector<Vec3>{{0.5, 0.5, -2.75}})));
  ball.commit();
  EXPECT_NEAR(distance({square}, there, {.cache = &cache}).upper, 0.25, 1e-12);
}

// A rebuild keeps the unit it has begun with, in which most centers are infinite after such a motion.
TEST(Model, IsRebuiltWhileItGrowsBeyondFloat32) {
  for (const std::uint32_t side : {9U, 13U}) {
    const Mesh mesh = scenes::wave_sheet(side, side, 0);
    Model model(mesh, {.rebuild_budget_us = 5});
    std::vector<Vec3> positions = mesh.positions();
    for (int frame = 0; frame < 100; ++frame) {
      const double scale = std::ldexp(1 + 1e-3 * frame, frame > 20 && frame % 2 == 1 ? 190 : 0);
      for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = scale * mesh.positions()[v];
      ASSERT_TRUE(model.move_all(positions));
      model.commit();
      ASSERT_TRUE(model.validate()) << side << " " << frame;
    }
    EXPECT_GT(model.maintenance_stats().rebuilt_triangles, 0U);
  }
}

}  // namespace
}  // namespace limber::testing

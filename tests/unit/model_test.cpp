// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models of the fast engine whose vertices move.
#include "limber/model.h"
#include "limber/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "bvh/rebuild.h"
#include "bvh/tree.h"
#include "geometry/primitives.h"
#include "reference/reference.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

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
  for (const auto& [motion_margin, far] : {std::pair(0.0, Vec3{}), {10.0, Vec3{}}, {0.0, Vec3{1e9, 1e9, 1e9}}}) {
    Model moved(soup.mesh, {.motion_margin = motion_margin, .rebuild_policy = RebuildPolicy::off});
    std::vector<Vec3> positions = soup.positions(400);
    for (Vec3& p : positions) p += far;
    ASSERT_TRUE(static_cast<bool>(moved.move_all(positions)));
    if (far == Vec3{}) moved.commit();  // otherwise rebuild() is the commit
    moved.rebuild();
    const Model built(Mesh::create(positions, soup.mesh.triangles()).value());
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
  Model real_time(soup.mesh, ModelOptions::real_time(100));
  const std::vector<Model*> models{&never_rebuilt, &no_time, &in_commit, &slowly, &on_worker, &real_time};
  const std::vector<double> visits = play(soup, models, 150);
  for (std::size_t m = 0; m < models.size(); ++m) {
    const std::uint64_t rebuilt_triangles = models[m]->maintenance_stats().rebuilt_triangles;
    if (m < 2) {
      EXPECT_GT(visits[m], 1.6) << m;
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

void expect_bounds_hold(const Model& model) {
  const Box box = model.bounding_box();
  const Sphere sphere = model.bounding_sphere();
  Vec3 low = model.mesh().triangle(0).v0, high = low;
  for (TriangleId t = 0; t < model.mesh().triangles().size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 p = model.mesh().triangle(t)[i];
      low = min(low, p), high = max(high, p);
      ASSERT_LE(length(p - sphere.center), sphere.radius);
    }
  }
  EXPECT_EQ(min(box.low, low), box.low);
  EXPECT_EQ(max(box.high, high), box.high);
  const double size = length(high - low), margin = model.maintenance_stats().motion_margin;
  const double tolerance = 1e-5 * size + 2 * margin + 1e-12 * max_abs(high) + 1e-280;
  EXPECT_LE(max_abs(box.high - high), tolerance);
  EXPECT_LE(max_abs(box.low - low), tolerance);
  EXPECT_LE(sphere.radius, 0.75 * size + tolerance);
}

TEST(ModelBounds, ContainEveryVertexWhateverTheScale) {
  Rng rng(710);
  for (const double scale : {0.0, 1e-300, 1e-3, 1.0, 1e6, 1e50}) {
    for (const double offset : {0.0, 1.0, 1e9}) {
      std::vector<Triangle> triangles;
      for (std::size_t i = 0; i < 1 + rng.below(200); ++i) {
        const Vec3 at = scale * (offset * Vec3{1, -1, 1} + uniform_point(rng));
        triangles.push_back({at, at + 0.1 * scale * uniform_point(rng), at + 0.1 * scale * uniform_point(rng)});
      }
      Model model(soup(triangles), {.motion_margin = rng.below(2) == 0 ? 0 : 0.1 * scale});
      expect_bounds_hold(model);
      for (int frame = 0; frame < 4; ++frame) {
        std::vector<Vec3> positions = model.mesh().positions();
        for (Vec3& p : positions) p += 0.05 * scale * uniform_point(rng);
        ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
        model.commit();
        expect_bounds_hold(model);
      }
    }
  }
}

/// Whether each level of spheres holds all triangles, each triangle in one of them.
void expect_spheres_hold(const Model& model) {
  const TreeStats stats = model.tree_stats();
  std::size_t count = 0;
  for (std::uint32_t level = 0; level < stats.levels; ++level) {
    const std::vector<Sphere> spheres = model.node_spheres(level);
    count += spheres.size();
    for (TriangleId t = 0; t < model.mesh().triangles().size(); ++t) {
      const auto holds = [&](const Sphere& sphere) { return geometry::contains(sphere, model.mesh().triangle(t)); };
      ASSERT_TRUE(std::any_of(spheres.begin(), spheres.end(), holds)) << "level " << level << ", triangle " << t;
    }
  }
  EXPECT_EQ(count, stats.nodes);
  EXPECT_EQ(model.node_spheres(stats.levels - 1).size(), stats.leaves);
  const Sphere root = model.bounding_sphere();
  ASSERT_EQ(model.node_spheres(0).size(), 1U);
  EXPECT_EQ(model.node_spheres(0)[0].center, root.center);
  EXPECT_EQ(model.node_spheres(0)[0].radius, root.radius);
  EXPECT_THROW(static_cast<void>(model.node_spheres(stats.levels)), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(model.node_spheres(no_id)), std::invalid_argument);
}

TEST(ModelBounds, SpheresOfEveryLevelHoldEveryTriangle) {
  Rng rng(711);
  for (const double offset : {0.0, 1e9}) {
    for (const std::uint32_t triangles : {1U, 8U, 9U, 600U}) {
      std::vector<Vec3> positions = scenes::random_soup(rng, triangles, 0.1).positions();
      const std::vector<Corners> corners = scenes::random_soup(rng, triangles, 0.1).triangles();
      for (Vec3& p : positions) p += offset * Vec3{1, -1, 1};
      Model model(Mesh::create(positions, corners).value(), {.motion_margin = triangles > 8 ? 0.05 : 0});
      expect_spheres_hold(model);
      for (Vec3& p : positions) p += 0.02 * uniform_point(rng);
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      EXPECT_THROW(static_cast<void>(model.node_spheres(0)), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_box()), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_sphere()), std::invalid_argument);
      model.commit();
      expect_spheres_hold(model);
    }
  }
}

}  // namespace
}  // namespace limber::testing

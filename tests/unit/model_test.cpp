// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models of the fast engine whose vertices move, and models of thousands of triangles at one place: duplicates, and
// meshes that have collapsed.
#include "limber/model.h"
#include "limber/distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <stdexcept>
#include <vector>

#include "base/rounding.h"
#include "bvh/rebuild.h"
#include "bvh/tree.h"
#include "reference/reference.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"
#include "unit/internals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

/// Moves one vertex, and commits.
void move_one(Model& model, VertexId vertex, const Vec3& to) {
  model.move_vertices(std::vector<VertexId>{vertex}, std::vector<Vec3>{to}).value();
  model.commit();
}

TEST(Model, RefitsEveryNodeAboveAVertexOnceHoweverOftenItMoves) {
  Model model(scenes::wave_sheet(100, 100, 0));
  model.move_vertices(std::vector<VertexId>{5000, 5000, 5001, 5000}, std::vector<Vec3>(4, {2, 2, 3})).value();
  EXPECT_FALSE(model.is_committed());
  model.commit();
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.mesh().positions()[5000], (Vec3{2, 2, 3}));
  EXPECT_EQ(model.maintenance_stats().moved_vertices, 4U);
  // At most the nodes of the triangles at two neighbours, and a path to the root for each.
  const std::uint64_t refits = model.maintenance_stats().refits, levels = model.tree_stats().levels;
  EXPECT_GE(refits, levels);
  EXPECT_LE(refits, 4 * levels);
  ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
  move_one(model, 777, model.mesh().positions()[777]);  // nothing changes above its nodes
  EXPECT_LE(model.maintenance_stats().refits, refits + 4);
}

/// 64 triangles of one lowest node: most are at the corners of an octahedron, which alone decide the node's volume, and
/// some in its middle. The last is the point in the middle itself.
void add_octahedron(const Vec3& middle, std::vector<Triangle>& triangles) {
  for (std::uint32_t i = 0; i < 63; ++i) {
    Vec3 at = middle + 0.002 * Vec3{static_cast<double>(i % 4), static_cast<double>(i % 3), static_cast<double>(i % 5)};
    if (i < 48) at[i % 3] += i % 6 < 3 ? 1 : -1;
    triangles.push_back({at, at + Vec3{0.01, 0, 0}, at + Vec3{0, 0.01, 0}});
  }
  triangles.push_back({middle, middle, middle});
}

TEST(Model, HoldsWhatMovesInsideOfTheVolumeOfItsNode) {
  // That volume stays as it is, so a refit ends there. The volumes above it have to hold what has moved nevertheless.
  std::vector<Triangle> triangles;
  for (int group = 0; group < 3; ++group) {
    for (int k = 0; k < 8; ++k) {
      const Vec3 side{k % 2 == 0 ? -1.5 : 1.5, k / 2 % 2 == 0 ? -1.5 : 1.5, k / 4 == 0 ? -1.5 : 1.5};
      add_octahedron(Vec3{40.0 * group, 0, 0} + side, triangles);
    }
  }
  const Mesh mesh = soup(triangles);
  for (TriangleId point = 63; point < mesh.triangles().size(); point += 64) {
    const Vec3 from = mesh.triangle(point).v0, middle{40.0 * std::floor(from.x / 40 + 0.5), 0, 0};
    for (int step = 0; step < 16; ++step) {
      Model model(mesh, {.rebuild_policy = RebuildPolicy::off});
      const Vec3 to = from + (0.26 + 0.008 * step) * (from - middle);
      model.move_vertices(mesh.triangles()[point], std::vector<Vec3>(3, to)).value();
      model.commit();
      ASSERT_TRUE(model.validate()) << point << " " << step;
      const Model probe(soup({{to, to, to}}));
      ASSERT_TRUE(collide({model}, {probe}).is_yes()) << point << " " << step;
    }
  }
}

TEST(Model, KeepsUpWithTrianglesThatChangePlaces) {
  const scenes::Motion soup = scenes::shuffled_soup(4000);
  Model never_rebuilt(soup.mesh, {.rebuild_policy = RebuildPolicy::off}), no_time(soup.mesh, {.rebuild_budget_us = 0});
  Model in_commit(soup.mesh), slowly(soup.mesh, {.rebuild_budget_us = 100});
  Model on_worker(soup.mesh, {.rebuild_policy = RebuildPolicy::on_worker});
  Model real_time(soup.mesh, ModelOptions::real_time(100));
  Model* const models[] = {&never_rebuilt, &no_time, &in_commit, &slowly, &on_worker, &real_time};
  const Model probe(scaled(scenes::ball(8, 5), 0.05));
  Rng rng(312);
  double visits[6] = {}, fresh_visits = 0;  // in the second half of the motion
  for (int frame = 1; frame <= 150; ++frame) {
    const std::vector<Vec3> positions = soup.positions(frame);
    for (Model* model : models) {
      model->move_all(positions).value();
      model->commit();
      ASSERT_TRUE(static_cast<bool>(model->validate())) << model->validate().error().text << " in frame " << frame;
    }
    const Model fresh(Mesh::create(positions, soup.mesh.triangles()).value());
    for (int i = 0; i < 4; ++i) {
      const Placed placed{probe, random_pose(rng, 1)};
      const double counts = frame < 75 ? 0 : 1;
      const DistanceResult wanted = distance({fresh}, placed);
      fresh_visits += counts * static_cast<double>(wanted.stats.node_tests);
      for (std::size_t m = 0; m < 6; ++m) {
        const DistanceResult found = distance({*models[m]}, placed);
        EXPECT_NEAR(found.upper, wanted.upper, 1e-14) << frame;
        visits[m] += counts * static_cast<double>(found.stats.node_tests);
      }
    }
  }
  for (std::size_t m = 0; m < 6; ++m) {
    const std::uint64_t rebuilt_triangles = models[m]->maintenance_stats().rebuilt_triangles;
    if (m < 2) {
      EXPECT_GT(visits[m], 1.6 * fresh_visits) << m;
      EXPECT_EQ(rebuilt_triangles, 0U) << m;
    } else {
      EXPECT_LT(visits[m], 1.3 * fresh_visits) << m;
      EXPECT_GT(rebuilt_triangles, 4000U) << m;
    }
  }
}

TEST(Model, RebuildsOnlyWhatHasDegraded) {
  // Eight soups in a row, of which one is shuffled.
  constexpr std::uint32_t count = 1024;
  const scenes::Motion soup = scenes::shuffled_soup(count);
  Mesh row = soup.mesh;
  for (int k = 1; k < 8; ++k) {
    row = joined(row, mapped(soup.mesh, [&](const Vec3& p) { return p + Vec3{10.0 * k, 0, 0}; }));
  }
  Model model(row);
  std::vector<Vec3> positions = row.positions();
  for (int frame = 1; model.maintenance_stats().rebuilt_triangles == 0; ++frame) {
    ASSERT_LT(frame, 32);
    const std::vector<Vec3> shuffled = soup.positions(4 * frame);
    std::copy(shuffled.begin(), shuffled.end(), positions.begin());
    model.move_all(positions).value();
    model.commit();
    ASSERT_TRUE(static_cast<bool>(model.validate())) << model.validate().error().text;
  }
  EXPECT_LE(model.maintenance_stats().rebuilt_triangles, count);
}

TEST(Model, ValidateNamesAVertexBeyondTheMotionMarginInUse) {
  Model model(scenes::thesis_ball(), {.motion_margin = 0.5});
  move_one(model, 7, 1.25 * model.mesh().positions()[7]);
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
    for (int frame = 0; frame < 100; ++frame) {
      const double scale = std::ldexp(1 + 1e-3 * frame, frame > 20 && frame % 2 == 1 ? 190 : 0);
      model.move_all(scaled(mesh, scale).positions()).value();
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
        deform(model, [&](const Vec3& p) { return p + 0.05 * scale * uniform_point(rng); });
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
      const Triangle triangle = model.mesh().triangle(t);
      const auto holds = [&](const Sphere& sphere) {
        const auto has = [&](const Vec3& p) { return base::distance_up(sphere.center, p) <= sphere.radius; };
        return has(triangle.v0) && has(triangle.v1) && has(triangle.v2);
      };
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
      const Mesh soup = scenes::random_soup(rng, triangles, 0.1);
      Model model(mapped(soup,
                         [&](const Vec3& p) {
                           return p + offset * Vec3{1, -1, 1};
                         }),
                  {.motion_margin = triangles > 8 ? 0.05 : 0});
      expect_spheres_hold(model);
      deform(model, [&](const Vec3& p) { return p + 0.02 * uniform_point(rng); });
      expect_spheres_hold(model);
      model.move_all(model.mesh().positions()).value();
      EXPECT_THROW(static_cast<void>(model.node_spheres(0)), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_box()), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(model.bounding_sphere()), std::invalid_argument);
    }
  }
}

// --- triangles at one place ---

/// A mesh of `count` equal triangles, which share their vertices or have their own.
Mesh repeated(const Triangle& t, std::uint32_t count, bool shares_vertices) {
  if (!shares_vertices) return soup(std::vector<Triangle>(count, t));
  return Mesh::create({t.v0, t.v1, t.v2}, std::vector<Corners>(count, Corners{0, 1, 2})).value();
}

TEST(Coincident, TrianglesCostNoMoreThanAFew) {
  const Triangle low{{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0}}, high{{0, 0, 1}, {1, 0, 1.5}, {0.3, 1, 2}};
  for (const bool shares_vertices : {false, true}) {
    const Model a(repeated(low, 8000, shares_vertices)), b(repeated(high, 8000, shares_vertices));
    ASSERT_TRUE(static_cast<bool>(a.validate()));
    const DistanceResult found = distance({a}, {b});
    EXPECT_EQ(found.upper, closest_points(low, high).distance);
    EXPECT_EQ(found.status, DistanceStatus::exact);
    EXPECT_LT(found.stats.node_tests + found.stats.primitive_tests, 100U);
    EXPECT_FALSE(collide({a}, {b}).is_yes());
    EXPECT_TRUE(collide({a}, {a, {{}, {0.1, 0.1, 0}}}).is_yes());
  }
}

TEST(Coincident, TrianglesAmongOthersAreFoundAsBefore) {
  Rng rng(701);
  for (int i = 0; i < 100; ++i) {
    std::vector<Triangle> triangles;
    while (triangles.size() < 600) {
      const Triangle t = uniform_triangle(rng);
      // 64 to 200 times, or once: equal triangles fill whole nodes and parts of nodes.
      triangles.insert(triangles.end(), rng.below(2) == 0 ? 64 + rng.below(137) : 1, t);
    }
    const Mesh mesh = soup(triangles), other = soup({uniform_triangle(rng), uniform_triangle(rng)});
    const Model a(mesh), b(other);
    ASSERT_TRUE(static_cast<bool>(a.validate()));
    const Transform pose = random_pose(rng, 3);
    const double truth = reference::distance({mesh}, {other, pose}).upper;
    ASSERT_NEAR(distance({a}, {b, pose}).upper, truth, 1e-14);
    ASSERT_NEAR(distance({b, pose}, {a}).upper, truth, 1e-14);
    ASSERT_EQ(collide({a}, {b, pose}).is_yes(), truth == 0);
  }
}

TEST(Coincident, TrianglesThatPartByLessThanASquareCanTellAreToldApart) {
  // The last of many equal triangles moves to the other model, by a displacement whose square is 0 in float64.
  constexpr double little = 0x1p-600;
  const Triangle high{{0, 0, little}, {1, 0, little}, {0, 1, little}}, low{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  constexpr std::uint32_t count = 200;
  const std::vector<VertexId> last{3 * count - 3, 3 * count - 2, 3 * count - 1};
  for (const bool moves_all : {false, true}) {
    Model many(repeated(high, count, false), {.motion_margin = 0.5});
    const Model probe(soup({low}));
    ASSERT_FALSE(collide({many}, {probe}).is_yes());
    std::vector<Vec3> positions = many.mesh().positions();
    for (std::size_t k = 0; k < 3; ++k) positions[last[k]] = low[k];
    if (moves_all) {
      many.move_all(positions).value();
    } else {
      many.move_vertices(last, std::span(positions).last(3)).value();
    }
    many.commit();
    ASSERT_TRUE(static_cast<bool>(many.validate()));
    EXPECT_TRUE(collide({many}, {probe}).is_yes()) << moves_all;
    EXPECT_EQ(distance({many}, {probe}).upper, 0) << moves_all;
  }
}

TEST(Coincident, TrianglesThatPartByLessThanBoundsCanTellAreToldApart) {
  // Some of many equal triangles move so little that no bound changes. The marks of all slots above have to change.
  constexpr double little = 0x1p-200;
  const Triangle flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Model many(repeated(flat, 1000, false));
  const Model probe(soup({{{-1, -1, little}, {3, -1, little}, {-1, 3, little}}}));
  const auto is_one_again = [&] {
    const DistanceResult found = distance({many}, {probe});
    return found.upper == little && found.stats.node_tests + found.stats.primitive_tests < 100;
  };
  ASSERT_TRUE(is_one_again());
  const bvh::Tree& tree = tree_of(many);
  ASSERT_GT(tree.first_lowest_node(), 1U);
  const auto raise = [&](const bvh::Leaf& leaf, double height) {
    std::vector<VertexId> ids;
    for (const auto& corners : leaf.vertices) ids.push_back(corners[0]);
    many.move_vertices(ids, std::vector<Vec3>(ids.size(), {0, 0, height})).value();
  };
  for (std::size_t n = tree.first_lowest_node(); n < tree.nodes.size(); n += 3) {
    const std::uint32_t first = tree.nodes[n].first_child;
    for (const std::uint32_t count : {1U, tree.nodes[n].child_count}) {  // a leaf, or all leaves of a node
      for (const double height : {little, 0.0}) {
        for (std::uint32_t k = 0; k < count; ++k) raise(tree.leaves[first + k], height);
        many.commit();
        const auto sound = many.validate();
        ASSERT_TRUE(static_cast<bool>(sound)) << n << ": " << sound.error().text;
        ASSERT_EQ(collide({many}, {probe}).is_yes(), height > 0) << n;
      }
      ASSERT_TRUE(is_one_again()) << n;
    }
  }
}

}  // namespace
}  // namespace limber::testing

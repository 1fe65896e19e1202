// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
// The classic engine: its tree, its maintenance, the work of its queries. What all engines promise is in
// query_test.cpp.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <vector>

#include "reference/classic/classic.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using classic::Maintenance;

Mesh triangles_in_a_row(std::size_t count) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const auto x = static_cast<double>(i);
    triangles.push_back({{x, 0, 0}, {x + 0.5, 0, 0}, {x, 0.5, 0}});
  }
  return soup(triangles);
}

TEST(ClassicTree, HasSmallestSpheresAroundTriangles) {
  const Vec3 p{3, -4, 5};
  const struct {
    Triangle triangle;
    Vec3 center;
    double radius;
  } cases[] = {
      {{{0, 0, 0}, {6, 0, 0}, {0, 8, 0}}, {3, 4, 0}, 5},  // a right angle: at the middle of the longest edge
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, Vec3{1, 1, 1} * (1.0 / 3), std::sqrt(2.0 / 3)},  // equilateral
      {{p, p, p}, p, 0},
      {{{0, 0, 0}, {1, 0, 0}, {-1e-170, 1e-170, 0}}, {0.5, 0, 0}, 0.5},  // a needle with a vanishing side
  };
  for (const auto& [triangle, center, radius] : cases) {
    const classic::Model model(soup({triangle}));
    const Sphere& sphere = model.tree().nodes[0].sphere;
    EXPECT_LE(length(sphere.center - center), radius * 1e-15) << radius;
    EXPECT_NEAR(sphere.radius, radius, radius * 1e-14);
  }
}

TEST(ClassicTree, IsBalancedForEveryCount) {
  for (std::size_t n = 1; n <= 70; ++n) {
    const classic::Model model(triangles_in_a_row(n));
    ASSERT_TRUE(static_cast<bool>(model.validate())) << n;
    EXPECT_EQ(model.tree().nodes.size(), 2 * n - 1);
    EXPECT_EQ(model.tree().nodes.back().depth, static_cast<std::uint32_t>(std::bit_width(n - 1)));
  }
}

TEST(ClassicTree, SiblingsOfARowAreApart) {
  // Equal-count halves of a row must not interleave, whichever axis the row runs along.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<Triangle> row;
    for (std::uint64_t i = 0; i < 64; ++i) {
      Vec3 at, along, across;
      at[axis] = static_cast<double>(37 * i % 64);  // not in order
      along[axis] = 0.5;
      across[(axis + 1) % 3] = 0.5;
      row.push_back({at, at + along, at + across});
    }
    const classic::Model model(soup(row));
    const auto& nodes = model.tree().nodes;
    for (const classic::Node& node : nodes) {
      if (node.is_leaf()) continue;
      const Sphere &first = nodes[node.first_child].sphere, &second = nodes[node.first_child + 1].sphere;
      EXPECT_LT(first.center[axis] + first.radius * 0.5, second.center[axis]) << "axis " << axis;
    }
  }
}

TEST(ClassicTree, DoesNotSplitCoincidentTrianglesUnevenly) {
  const std::vector<Triangle> same(33, Triangle{{1, 2, 3}, {2, 2, 3}, {1, 3, 3}});
  const classic::Model model(soup(same));
  EXPECT_TRUE(static_cast<bool>(model.validate()));
  EXPECT_EQ(model.tree().nodes.back().depth, 6U);
}

/// Moves the first vertex of the given triangles up a little and commits.
classic::MaintenanceStats stats_after_moving(Maintenance mode, const std::vector<TriangleId>& which) {
  classic::Model model(triangles_in_a_row(16), {.maintenance = mode});
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
  for (const TriangleId t : which) {
    ids.push_back(3 * t);
    positions.push_back(model.mesh().positions()[3 * t] + Vec3{0, 0, 0.1});
  }
  model.move_vertices(ids, positions).value();
  model.commit();
  EXPECT_TRUE(static_cast<bool>(model.validate()));
  return model.maintenance_stats();
}

TEST(ClassicMaintenance, CountsWhatEachModeMustRefit) {
  // 16 triangles: depth 4, five nodes from leaf to root. Triangles 0 and 1 are siblings; 0 is moved twice.
  EXPECT_EQ(stats_after_moving(Maintenance::immediate, {0, 0, 1}).refits, 15U);
  EXPECT_EQ(stats_after_moving(Maintenance::batched, {0, 0, 1}).refits, 10U);
  EXPECT_EQ(stats_after_moving(Maintenance::by_depth, {0, 0, 1}).refits, 6U);
  // Triangles of different halves share the root only.
  EXPECT_EQ(stats_after_moving(Maintenance::batched, {0, 15}).refits, 10U);
  EXPECT_EQ(stats_after_moving(Maintenance::by_depth, {0, 15}).refits, 9U);
}

TEST(ClassicMaintenance, ByDepthRefitsEveryNodeOnceWhenAllVerticesMove) {
  classic::Model model(scenes::thesis_ball());
  std::vector<Vec3> positions = model.mesh().positions();
  for (Vec3& p : positions) p *= 1.5;
  model.move_all(positions).value();
  EXPECT_FALSE(model.is_committed());
  model.commit();
  EXPECT_TRUE(model.is_committed());
  EXPECT_EQ(model.maintenance_stats().refits, model.tree().nodes.size());
  EXPECT_EQ(model.maintenance_stats().absorbed, 0U);
  EXPECT_EQ(model.maintenance_stats().moved_vertices, positions.size());
  classic::Model immediate(triangles_in_a_row(4), {.maintenance = Maintenance::immediate});
  immediate.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{0, 0, 1}}).value();
  EXPECT_TRUE(immediate.is_committed());
}

TEST(ClassicMaintenance, AllModesGiveTheSameTightTree) {
  Rng rng(50);
  classic::Model models[] = {classic::Model(scenes::thesis_ball(), {.maintenance = Maintenance::immediate}),
                             classic::Model(scenes::thesis_ball(), {.maintenance = Maintenance::batched}),
                             classic::Model(scenes::thesis_ball(), {.maintenance = Maintenance::by_depth})};
  for (int round = 0; round < 20; ++round) {
    const scenes::Dent dent{rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(0.1, 1), 0.1};
    for (classic::Model& model : models) {
      const auto moves = scenes::dent_moves(dent, model.mesh().positions());
      model.move_vertices(moves.ids, moves.positions).value();
      model.commit();
    }
  }
  for (std::size_t n = 0; n < models[0].tree().nodes.size(); ++n) {
    for (const classic::Model& model : models) {
      ASSERT_EQ(model.tree().nodes[n].sphere.center, models[0].tree().nodes[n].sphere.center);
      ASSERT_EQ(model.tree().nodes[n].sphere.radius, models[0].tree().nodes[n].sphere.radius);
    }
  }
}

TEST(ClassicMaintenance, UnreferencedVerticesMoveForFree) {
  classic::Model model(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {9, 9, 9}}, {{0, 1, 2}}).value());
  model.move_vertices(std::vector<VertexId>{3}, std::vector<Vec3>{{1, 1, 1}}).value();
  model.commit();
  EXPECT_EQ(model.maintenance_stats().refits, 0U);
  EXPECT_EQ(model.mesh().positions()[3], (Vec3{1, 1, 1}));
}

TEST(ClassicLooseness, AbsorbsSmallMotionsAndNotLargeOnes) {
  for (const Maintenance mode : {Maintenance::immediate, Maintenance::batched, Maintenance::by_depth}) {
    classic::Model model(triangles_in_a_row(16), {.maintenance = mode, .looseness = {.extra_radius = 0.2}});
    const auto raise = [&](double height) {
      model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{0, 0, height}}).value();
      model.commit();
      EXPECT_TRUE(static_cast<bool>(model.validate()));
      return model.maintenance_stats();
    };
    EXPECT_EQ(raise(0.01).refits, 0U);
    EXPECT_EQ(raise(0.02).absorbed, 2U);
    EXPECT_GT(raise(5).refits, 0U);
  }
}

TEST(ClassicLooseness, SpheresThatBecameStaleShrinkAgain) {
  classic::Model model(triangles_in_a_row(16), {.looseness = {.extra_radius = 0.1, .stale_ratio = 1.5}});
  const double radius = model.tree().nodes[0].sphere.radius;
  std::vector<Vec3> positions = model.mesh().positions();
  for (Vec3& p : positions) p *= 0.01;
  model.move_all(positions).value();
  model.commit();
  EXPECT_LT(model.tree().nodes[0].sphere.radius, 0.02 * radius);
}

TEST(ClassicCollide, StopsAtTheFirstPair) {
  const classic::Model a(scenes::thesis_ball()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b});
  ASSERT_TRUE(r.is_yes());
  EXPECT_LT(r.stats.primitive_tests, 20U);
  EXPECT_TRUE(intersects(a.mesh().triangle(r.witness->triangle_a), b.mesh().triangle(r.witness->triangle_b)));
}

TEST(ClassicCollide, FarModelsCostOneTest) {
  const classic::Model a(scenes::thesis_square()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b, {{}, {0, 0, 50}}});
  EXPECT_FALSE(r.is_yes());
  EXPECT_FALSE(r.witness.has_value());
  EXPECT_EQ(r.stats.node_tests, 1U);
  EXPECT_EQ(r.stats.primitive_tests, 0U);
}

TEST(ClassicQueries, DoTheWorkThatWasMeasured) {
  // The counts are the same on every machine. Other counts mean another traversal, and then the experiments have to be
  // run again.
  const classic::Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const Transform pose = scenes::ball_over_square(ball.mesh(), 0.1, 0);
  const QueryStats collide = classic::collide({square}, {ball, pose}).stats;
  EXPECT_EQ(collide.node_tests, 6919U);
  EXPECT_EQ(collide.primitive_tests, 560U);
  const QueryStats distance = classic::distance({square}, {ball, pose}).stats;
  EXPECT_EQ(distance.node_tests, 29055U);
  EXPECT_EQ(distance.primitive_tests, 5914U);
}

TEST(Reference, PicksTheFirstPairInTheOrderOfIds) {
  const Triangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Mesh a = soup({unit, unit}), b = soup({{{0, 0, 9}, {1, 0, 9}, {0, 1, 9}}, {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}});
  const DistanceResult r = reference::distance({a}, {b});
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.witness->triangle_a, 0U);
  EXPECT_EQ(r.witness->triangle_b, 1U);
  EXPECT_EQ(r.stats.primitive_tests, 4U);
}

}  // namespace
}  // namespace limber::testing

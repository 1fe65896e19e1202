// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Shadows of bodies that pass each other, next to distances at many times, and what they spare.
#include "motion/rigid/moving_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "limber/scene.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using motion::MovingBodies;
using motion::Shadow;

Mat3 about_z(double angle) {
  return {{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
}

/// A tube about the z axis from z = 0 to 1, of 2 n^2 triangles; with a bottom, of more.
Mesh tube(double radius, std::uint32_t n, bool has_bottom = false) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i <= n; ++i) {
    for (std::uint32_t k = 0; k < n; ++k) {
      positions.push_back({radius * std::cos(2 * std::numbers::pi * k / n),
                           radius * std::sin(2 * std::numbers::pi * k / n), static_cast<double>(i) / n});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t k = 0; k < n; ++k) {
      const VertexId a = i * n + k, b = i * n + (k + 1) % n;
      triangles.push_back({a, a + n, b}), triangles.push_back({b, a + n, b + n});
    }
  }
  for (std::uint32_t k = 1; has_bottom && k + 1 < n; ++k) triangles.push_back({0, k + 1, k});
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// Coarse and fine meshes, at their axis or beside it, some with triangles that the axis crosses.
Mesh random_mesh(Rng& rng) {
  switch (rng.below(4)) {
    case 0:
      return scenes::ring(12, 6, 0.3);
    case 1:
      return tube(rng.uniform(0.1, 1), 8, rng.below(2) == 0);
    case 2:
      return scenes::grid(2, 2, -1, -1, 1, 1);
    default:
      return scenes::random_soup(rng, 1 + static_cast<std::uint32_t>(rng.below(9)), 1);
  }
}

/// A motion that slides, turns, does both as a screw about some axis, or anything.
RigidMotion random_motion(Rng& rng) {
  const Transform start = random_pose(rng, 2);
  Transform end = start;
  const std::uint64_t kind = rng.below(5);
  if (kind == 1) end.translation += uniform_point(rng, -3, 3);
  if (kind >= 2) end.rotation = random_pose(rng, 1).rotation;
  if (kind == 3) return RigidMotion::screw(start, {end.rotation, start.translation + uniform_point(rng)});
  if (kind == 4) end.translation += uniform_point(rng, -3, 3);
  return {start, end, rng.below(2) == 0 ? Vec3{} : uniform_point(rng)};
}

TEST(Shadow, BoundsTheDistanceAtAllTimes) {
  Rng rng(4711);
  int far_bounds = 0, about_axes = 0;
  for (int i = 0; i < 1500 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Model a(random_mesh(rng)), b(random_mesh(rng));
    const RigidMotion motion_a = random_motion(rng), motion_b = random_motion(rng);
    const MovingBodies bodies{a, motion_a, b, motion_b};
    const double time = rng.uniform(), straight_speed = std::exp2(-rng.uniform(0, 20));
    const Shadow shadow(bodies, time, straight_speed);
    QueryStats stats;
    const double bound = shadow.distance({}, stats).value();
    for (int k = 0; k <= 24; ++k) {
      const double t = k / 24.0, lower = bound - shadow.speed() * std::abs(t - time);
      const double truth = distance({a, motion_a.at(t)}, {b, motion_b.at(t)}).upper;
      ASSERT_LE(lower, truth + 1e-13) << t;
      far_bounds += static_cast<int>(std::abs(t - time) > 0.25 && lower > 0.5 * truth);
    }
    about_axes += static_cast<int>(motion_a.axis() != Vec3{} || motion_b.axis() != Vec3{});
  }
  EXPECT_GT(far_bounds, 1000);
  EXPECT_GT(about_axes, 300);
}

TEST(Shadow, IsZeroWherePointsWillMeet) {
  Rng rng(4712);
  int tight = 0;
  for (int i = 0; i < 40'000 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const RigidMotion motion_a = random_motion(rng);
    const RigidMotion motion_b = rng.below(2) == 0 ? random_motion(rng) : RigidMotion(random_pose(rng, 2));
    // A triangle, or one of its points, whose corner, or any point of it, is to meet a point.
    Vec3 corners[3];
    for (Vec3& p : corners) p = rng.below(4) == 0 ? corners[0] : uniform_point(rng);
    const double u = rng.uniform(), v = rng.uniform(0, 1 - u);
    const Vec3 meets = rng.below(2) == 0 ? corners[0] : point_on({corners[0], corners[1], corners[2]}, u, v);
    const double time = rng.uniform(),
                 meeting_time = std::clamp(time + std::exp2(-rng.uniform(0, 16)) * rng.uniform(-0.4, 0.4), 0.0, 1.0);
    const Vec3 there = inverse(motion_b.at(meeting_time))(motion_a.at(meeting_time)(meets));
    const Model a(Mesh::create({corners[0], corners[1], corners[2]}, {{0, 1, 2}}).value());
    const Model b(Mesh::create({there}, {{0, 0, 0}}).value());
    const bool is_swapped = rng.below(2) == 0;
    const MovingBodies bodies =
        is_swapped ? MovingBodies{b, motion_b, a, motion_a} : MovingBodies{a, motion_a, b, motion_b};
    const Shadow shadow(bodies, time, std::exp2(-rng.uniform(0, 20)));
    QueryStats stats;
    const double bound = shadow.distance({}, stats).value(), change = shadow.speed() * std::abs(meeting_time - time);
    ASSERT_LE(bound, change + 1e-13);
    tight += static_cast<int>(bound > 0.95 * change);
  }
  EXPECT_GT(tight, 500);
}

TEST(Shadow, SparesDistancesWhereBodiesPassClosely) {
  const Model peg(tube(0.1, 24)), hole(tube(0.1009, 24)), blind(tube(0.1009, 24, true));
  const Model sheet(scenes::grid(20, 20, -0.1, -0.1, 0.01, 0.01)), floor(scenes::grid(60, 60, -2, -2, 0.07, 0.07));
  const Transform above{{}, {0, 0, 1.5}}, turned{about_z(2), {}}, screwed{about_z(2), {0, 0, -0.9}};
  const struct {
    const Model &a, &b;
    RigidMotion motion;
    std::optional<double> touches;
    std::uint64_t most_distances = 300;
  } cases[] = {
      {peg, hole, {above, {}}, {}},
      {peg, hole, {above, {{}, {0, 0, -1.5}}}, {}},
      {peg, hole, {{}, turned}, {}},
      {peg, hole, {{}, screwed}, {}},
      {peg, blind, {above, {{}, {0, 0, -0.5}}}, 0.75},
      {sheet, floor, {{{}, {-1, 0, 1e-4}}, {{}, {1, 0.3, 1e-4}}}, {}, 500},
      {sheet, floor, {{{}, {-1, 0, 1e-4}}, {{}, {1, 0.3, -1e-4}}}, 0.5, 5'000},
  };
  int number = 0;
  for (const auto& [a, b, motion, touches, most_distances] : cases) {
    SCOPED_TRACE(number++);
    QueryCache cache;
    for (QueryCache* some : {static_cast<QueryCache*>(nullptr), &cache}) {
      const PathImpact found = time_of_impact(a, motion, b, {}, {.distance_error = 1e-9, .cache = some});
      EXPECT_EQ(found.status, touches ? ImpactStatus::contact : ImpactStatus::clear);
      if (touches) {
        EXPECT_NEAR(found.time, *touches, 1e-5);
      }
      EXPECT_LT(found.distance_count, most_distances);
    }
    const PathDistance nearest = min_distance(a, motion, b, {}, {.distance_error = 1e-4});
    EXPECT_LE(nearest.upper - nearest.lower, 1e-4);
    EXPECT_LT(nearest.distance_count, touches ? 100'000U : 2'000U);
    limber::Scene scene;
    const ObjectId standing = scene.add(b);
    scene.commit();
    const ObjectImpactResult swept = scene.time_of_impact(a, motion, {.path = {.distance_error = 1e-9}});
    EXPECT_EQ(swept.object == standing, touches.has_value());
    EXPECT_LT(swept.result.distance_count, most_distances);
  }
}

TEST(Shadow, KeepsToTheBudget) {
  const Model peg(tube(0.1, 24)), hole(tube(0.1009, 24));
  const RigidMotion slides({{}, {0, 0, 1.5}}, {});
  for (std::uint64_t steps = 1; steps < 60; ++steps) {
    const PathImpact found = time_of_impact(peg, slides, hole, {}, {.budget = {.max_steps = steps}});
    EXPECT_LE(found.distance_count, steps);
    EXPECT_TRUE(found.status == ImpactStatus::clear || found.time < 1);
  }
}

}  // namespace
}  // namespace limber::testing

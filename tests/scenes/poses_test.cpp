// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "reference/reference.h"
#include "scenes/scenes.h"

namespace limber::scenes {
namespace {

/// Rounding of vertices that are placed within a hundred units.
constexpr double tolerance = 1e-14;

TEST(BallOverSquare, LowestVertexIsAtTheSeparationOverTheSquare) {
  const Mesh mesh = thesis_ball();
  for (std::uint32_t index = 0; index < 32; ++index) {
    for (const double separation : {64.0, 1.0, 0.001, 0.0, -0.5}) {
      const Transform pose = ball_over_square(mesh, separation, index);
      EXPECT_TRUE(is_rigid(pose));
      Vec3 lowest{0, 0, std::numeric_limits<double>::infinity()};
      for (const Vec3& p : mesh.positions()) {
        const Vec3 placed = pose(p);
        if (placed.z < lowest.z) lowest = placed;
      }
      EXPECT_NEAR(lowest.z, separation, tolerance);
      EXPECT_LE(std::max(std::abs(lowest.x), std::abs(lowest.y)), 2) << "beside the square";
    }
  }
}

TEST(BallOverSquare, CanonicalPoseStandsAtItsPlace) {
  const Transform pose = ball_over_square(thesis_ball(), 1, 0);
  EXPECT_EQ(pose.translation.x, 0.1 * std::sqrt(2.0));
  EXPECT_EQ(pose.translation.y, 0.1 * std::sqrt(3.0));
}

TEST(BallOverSquare, PosesDifferInPlaceAndTurn) {
  const Mesh mesh = thesis_ball();
  const Transform first = ball_over_square(mesh, 1, 1);
  const Transform second = ball_over_square(mesh, 1, 2);
  EXPECT_NE(first.translation.x, second.translation.x);
  EXPECT_NE(first.rotation, second.rotation);
}

TEST(BallOverSquare, ExactDistanceIsTheSeparation) {
  const Mesh plane = grid(8, 8, -4, -4, 1, 1);  // the plane of the square, in larger squares
  const Mesh mesh = thesis_ball();
  for (const std::uint32_t index : {0U, 1U, 2U}) {
    for (const double separation : {64.0, 1.0, 0.001}) {
      const Transform pose = ball_over_square(mesh, separation, index);
      const DistanceResult result = reference::distance({plane.view()}, {mesh.view(), pose});
      EXPECT_NEAR(result.upper, separation, tolerance);
      EXPECT_FALSE(reference::collide({plane.view()}, {mesh.view(), pose}).is_yes());
    }
    for (const double separation : {-0.001, -0.5}) {
      const Transform pose = ball_over_square(mesh, separation, index);
      EXPECT_EQ(reference::distance({plane.view()}, {mesh.view(), pose}).upper, 0);
      EXPECT_TRUE(reference::collide({plane.view()}, {mesh.view(), pose}).is_yes());
    }
  }
}

TEST(LinkedRing, PassesThroughTheOtherOnceAndKeepsAway) {
  constexpr int points = 1000;
  for (std::uint32_t index = 0; index < 100; ++index) {
    const Transform pose = linked_ring(index);
    ASSERT_TRUE(is_rigid(pose));
    int through_the_hole = 0;
    Vec3 last = pose({1, 0, 0});
    for (int i = 1; i <= points; ++i) {
      const double angle = 2 * std::numbers::pi * i / points;
      const Vec3 p = pose({std::cos(angle), std::sin(angle), 0});
      if ((p.z < 0) != (last.z < 0) && std::hypot(p.x, p.y) < 1) ++through_the_hole;
      EXPECT_GT(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.2) << "tubes of 0.1 meet";
      last = p;
    }
    EXPECT_EQ(through_the_hole, 1) << index;
  }
}

}  // namespace
}  // namespace limber::scenes

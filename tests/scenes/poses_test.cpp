// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "limber/reference.h"
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
      EXPECT_FALSE(reference::collide({plane.view()}, {mesh.view(), pose}).collision);
    }
    for (const double separation : {-0.001, -0.5}) {
      const Transform pose = ball_over_square(mesh, separation, index);
      EXPECT_EQ(reference::distance({plane.view()}, {mesh.view(), pose}).upper, 0);
      EXPECT_TRUE(reference::collide({plane.view()}, {mesh.view(), pose}).collision);
    }
  }
}

}  // namespace
}  // namespace limber::scenes

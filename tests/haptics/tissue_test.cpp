// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_models.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

namespace limber::program {
namespace {

constexpr double least_move = 0.005;  // mm; less is handed over later

/// A sheet that is moved as a model would be.
struct MovedTissue {
  explicit MovedTissue(double tick_s) : tissue(20'000, tick_s) {}

  std::size_t press(const Vec3& tip) {
    const Tissue::Moves moves = tissue.press(tip);
    EXPECT_EQ(std::set<VertexId>(moves.ids.begin(), moves.ids.end()).size(), moves.ids.size());
    mesh.set_positions(moves.ids, moves.positions).value();
    return moves.ids.size();
  }

  Tissue tissue;
  Mesh mesh = tissue.mesh(), resting = tissue.mesh();
};

TEST(Tissue, IsAClosedMeshOfNearlyTheNumberAskedFor) {
  for (const std::uint64_t at_most : {96U, 1000U, 1001U, 50'000U, 100'000U}) {
    const Mesh mesh = Tissue(at_most, 0.001).mesh();
    EXPECT_LE(mesh.triangles().size(), at_most);
    EXPECT_GE(static_cast<double>(mesh.triangles().size()), static_cast<double>(at_most) * (at_most < 1000 ? 1 : 0.85));
    std::map<std::pair<VertexId, VertexId>, int> edges;
    for (const Corners& c : mesh.triangles()) {
      for (std::size_t k = 0; k < 3; ++k) ++edges[{c[k], c[(k + 1) % 3]}];
    }
    for (const auto& [edge, count] : edges) {
      ASSERT_EQ(count, 1);
      ASSERT_EQ(edges.count({edge.second, edge.first}), 1U);
    }
    // Outward: the volume is positive.
    double volume = 0;
    for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
      const Triangle triangle = mesh.triangle(t);
      volume += dot(triangle.v0, cross(triangle.v1, triangle.v2)) / 6;
    }
    EXPECT_NEAR(volume, 120. * 120 * 20, 0.01 * 120 * 120 * 20);
  }
}

TEST(Tissue, IsLeftAloneByAToolAboveIt) {
  MovedTissue moved(0.001);
  EXPECT_EQ(moved.press({0, 0, 5}), 0U);
  EXPECT_EQ(moved.press({10, 0, resting_height(10, 0) + 0.5}), 0U);
  EXPECT_EQ(moved.press({500, 500, -3}), 0U);  // beside it
}

TEST(Tissue, GivesWayToTwoThirdsOfTheDepthInAParaboloid) {
  MovedTissue moved(0.001);
  for (const Vec3& center : {Vec3{10, 20, 0}, Vec3{-59, 3, 0}, Vec3{59.9, -59.9, 0}}) {
    MovedTissue fresh(0.001);
    const Vec3 tip = center + Vec3{0, 0, resting_height(center.x, center.y) - 3};
    const auto depth_below = [&](const Vec3& p, double z) {
      return p.z - z - ((p.x - tip.x) * (p.x - tip.x) + (p.y - tip.y) * (p.y - tip.y)) / 24;
    };
    double deepest = 0;
    const std::size_t upper_count = fresh.mesh.positions().size() / 2;
    for (VertexId v = 0; v < upper_count; ++v) {
      deepest = std::max(deepest, depth_below(fresh.resting.positions()[v], tip.z));
    }
    ASSERT_GT(deepest, 1);
    const std::size_t count = fresh.press(tip);
    EXPECT_GT(count, 5U);
    for (VertexId v = 0; v < fresh.mesh.positions().size(); ++v) {
      const Vec3 before = fresh.resting.positions()[v], now = fresh.mesh.positions()[v];
      const double expected = v < upper_count ? std::max(0., depth_below(before, tip.z + deepest / 3)) : 0;
      EXPECT_EQ(now.x, before.x);
      EXPECT_EQ(now.y, before.y);
      // The shallowest dents come back at once.
      if (expected < 0.0201) {
        ASSERT_NEAR(now.z, before.z, 0.0201) << v;
      } else {
        ASSERT_NEAR(now.z, before.z - expected, 1e-9) << v;
      }
    }
  }
}

TEST(Tissue, ComesBackInTimeWhateverTheRate) {
  for (const double rate : {200., 1000., 5000.}) {
    MovedTissue moved(1 / rate);
    const Vec3 tip{10, 20, resting_height(10, 20) - 3}, lifted{0, 0, 10};
    moved.press(tip);
    const auto deepest = [&] {
      double depth = 0;
      for (VertexId v = 0; v < moved.mesh.positions().size(); ++v) {
        depth = std::max(depth, moved.resting.positions()[v].z - moved.mesh.positions()[v].z);
      }
      return depth;
    };
    const double at_first = deepest();
    for (int tick = 0; tick < static_cast<int>(0.05 * rate); ++tick) moved.press(lifted);
    EXPECT_NEAR(deepest(), at_first / std::exp(1), least_move);
    for (int tick = 0; tick < static_cast<int>(rate); ++tick) moved.press(lifted);
    EXPECT_EQ(moved.mesh.positions(), moved.resting.positions());
    EXPECT_EQ(moved.press(lifted), 0U);
  }
}

TEST(Tool, HasNearlyAsManyTrianglesAsAskedFor) {
  EXPECT_EQ(tool_mesh(10'000).triangles().size(), 10'000U);
  for (const std::uint64_t at_most : {1000U, 9999U, 20'000U}) {
    const std::size_t count = tool_mesh(at_most).triangles().size();
    EXPECT_LE(count, at_most);
    EXPECT_GE(static_cast<double>(count), 0.85 * static_cast<double>(at_most));
  }
}

TEST(Tool, ComesDownPressesAndIsLiftedInsideTheTissue) {
  double highest = -100, lowest = 100, fastest = 0;
  constexpr double step = 0.001;
  for (double t = 0; t < 60; t += step) {
    const Vec3 tip = tip_at(device_pose(t)), next = tip_at(device_pose(t + step));
    const double height = tip.z - resting_height(tip.x, tip.y);
    highest = std::max(highest, height);
    lowest = std::min(lowest, height);
    fastest = std::max(fastest, length(device_pose(t + step).translation - device_pose(t).translation) / step);
    EXPECT_LT(std::max(std::abs(next.x), std::abs(next.y)), 50);
  }
  EXPECT_NEAR(highest, 5, 0.01);
  EXPECT_NEAR(lowest, -3, 0.01);
  EXPECT_LE(fastest, fastest_mm_per_s);
}

}  // namespace
}  // namespace limber::program

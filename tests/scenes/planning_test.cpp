// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "scenes/surfaces.h"

namespace limber::scenes {
namespace {

double area(const Triangle& t) { return length(cross(t.v1 - t.v0, t.v2 - t.v0)) / 2; }

double volume(const Mesh& mesh) {
  double sum = 0;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle c = mesh.triangle(t);
    sum += dot(c.v0, cross(c.v1, c.v2)) / 6;
  }
  return sum;
}

void expect_sound(const Mesh& mesh) {
  EXPECT_TRUE(mesh.is_closed());
  EXPECT_GT(volume(mesh), 0) << "faces inward";
  double least = std::numeric_limits<double>::infinity();
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) least = std::min(least, area(mesh.triangle(t)));
  EXPECT_GT(least, 1e-9);
}

struct KnownScene {
  const char* name;
  PlanningScene (*make)(double detail);
  std::size_t triangles[2];
  std::uint64_t hashes[2];
};

constexpr KnownScene known_scenes[] = {
    {"sculptures", sculptures, {1390, 48}, {0x21d7e590e5b4fd5f, 0x42fec20194dd4ab3}},
    {"house", house, {696, 120}, {0xf94077746943bf37, 0x765f39d8da2b8cfb}},
    {"twisty wall", twisty_wall, {176, 56}, {0x268653b30758a36c, 0x88161a160dcbad18}},
    {"cubicles", cubicles, {624, 40}, {0x24a0000dd948e3d3, 0x24d34a4e8783ef53}},
    {"alpha puzzle", alpha_puzzle, {2012, 2012}, {0xf405fb2f725696e0, 0xf405fb2f725696e0}},
    {"bug trap", bug_trap, {5184, 264}, {0x8cca8ff2bc8b004a, 0x1854c1052f210302}},
    {"spiral tunnel", spiral_tunnel, {42'752, 5756}, {0x5e69db43310271e6, 0xdf8be08ccf7c07ec}},
    {"furnished flat", furnished_flat, {36'876, 3358}, {0xc5a4726482edbdd3, 0x41eb0da48f9e599c}},
    {"assembly", assembly, {7992, 496}, {0xcb6fbc7967bd2779, 0x8b7d8003e96a2847}},
};

TEST(Planning, ScenesAreTheKnownOnesToTheBit) {
  for (const KnownScene& known : known_scenes) {
    const auto [environment, robot] = known.make(1);
    for (const auto& [mesh, i] : {std::pair{&environment, 0}, std::pair{&robot, 1}}) {
      SCOPED_TRACE(testing::Message() << known.name << (i == 0 ? "" : ", robot"));
      EXPECT_EQ(mesh->triangles().size(), known.triangles[i]);
      EXPECT_EQ(hash(*mesh), known.hashes[i]) << std::hex << "0x" << hash(*mesh);
      expect_sound(*mesh);
    }
  }
}

TEST(Planning, DetailMultipliesTheTriangles) {
  for (const KnownScene& known : known_scenes) {
    const Mesh large = known.make(10).environment;
    const double times = static_cast<double>(large.triangles().size()) / static_cast<double>(known.triangles[0]);
    EXPECT_GT(times, 8) << known.name;
    EXPECT_LT(times, 12) << known.name;
    EXPECT_TRUE(large.is_closed()) << known.name;
  }
}

TEST(Planning, AlphaTubesAreOfThinTriangles) {
  for (const auto& [detail, sides] : {std::pair{1, 42U}, std::pair{10, 133U}}) {
    const Mesh tube = alpha_puzzle(detail).robot;
    const std::size_t caps = 2 * (sides - 2);  // the last triangles
    double least = std::numeric_limits<double>::infinity();
    for (TriangleId t = 0; t < tube.triangles().size() - caps; ++t) {
      const Triangle c = tube.triangle(t);
      const double edge_sq = std::max({length_sq(c.v1 - c.v0), length_sq(c.v2 - c.v1), length_sq(c.v0 - c.v2)});
      least = std::min(least, edge_sq / (2 * area(c)));  // the longest edge over the height on it
    }
    EXPECT_GT(least, 20) << detail;
  }
}

TEST(Planning, BugFitsThroughTheNeckOfItsTrap) {
  const auto [trap, bug] = bug_trap();
  const auto from_axis = [](const Vec3& p) { return p.x * p.x + p.y * p.y; };
  double neck_sq = 1, bug_sq = 0;
  for (const Vec3& p : trap.positions()) {
    if (p.z >= 0 && p.z < 0.8) neck_sq = std::min(neck_sq, from_axis(p));
  }
  for (const Vec3& p : bug.positions()) bug_sq = std::max(bug_sq, from_axis(p));
  EXPECT_NEAR(neck_sq, 0.2 * 0.2, 1e-12);
  EXPECT_LT(bug_sq, 0.16 * 0.16);
}

TEST(Surfaces, HaveTheVolumesOfTheirSolids) {
  EXPECT_NEAR(volume(boxes({{{0, 0, 0}, {1, 2, 3}}, {{1, 2, 3}, {2, 3, 4}}})), 7, 1e-14);
  EXPECT_NEAR(volume(loft({circle(4, 1, 0), circle(4, 1, 3)}, Ends::capped)), 6, 1e-14);
  const std::vector<ProfilePoint> spindle = {{0, -1}, {1, 0}, {0, 1}};
  for (const std::uint32_t pieces : {1U, 3U}) EXPECT_NEAR(volume(lathe(spindle, 4, pieces)), 4.0 / 3, 1e-14);
  const auto bar = [](double t) { return Vec3{5 * t, 0, t}; };
  EXPECT_NEAR(volume(loft(circles_along(bar, 3, 4, 1), Ends::capped)), 2 * std::sqrt(26.0), 1e-13);
  const Transform moved = {{{0, -2, 0}, {2, 0, 0}, {0, 0, 2}}, {1, 2, 3}};
  EXPECT_NEAR(volume(together({lathe(spindle, 4), lathe(spindle, 4)}, moved)), 8 * 8.0 / 3, 1e-13);
}

TEST(Surfaces, AreClosed) {
  expect_sound(boxes({{{0, 0, 0}, {1, 2, 3}}, {{1, 2, 3}, {2, 3, 4}}}));
  expect_sound(loft({circle(5, 1, 0), circle(5, 1, 1), circle(5, 0.5, 1), circle(5, 0.5, 0)}, Ends::joined));
  expect_sound(lathe({{0, 0}, {1, 0}, {0, 1}}, 3, 2));
  const auto round = [](double t) { return Vec3{cosine(2 * std::numbers::pi * t), sine(2 * std::numbers::pi * t), 0}; };
  const Mesh torus = loft(circles_along(round, 40, 30, 0.2, Ends::joined), Ends::joined);
  expect_sound(torus);
  EXPECT_EQ(torus.triangles().size(), 2U * 40 * 30);
  for (const Vec3& p : torus.positions()) EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.2, 1e-12);
}

}  // namespace
}  // namespace limber::scenes

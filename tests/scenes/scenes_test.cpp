// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "reference/reference.h"
#include "scenes/motions.h"
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

Mesh moved(Mesh mesh, const VertexMoves& moves) {
  for (std::size_t i = 0; i < moves.ids.size(); ++i) mesh.set_position(moves.ids[i], moves.positions[i]).value();
  return mesh;
}

TEST(Scenes, MeshesAreTheKnownOnesToTheBit) {
  struct Known {
    Mesh mesh;
    std::size_t triangles, vertices;
    std::uint64_t hash;
  };
  for (const Known& k :
       {Known{thesis_square(), 8192, 4225, 0xc6136dff7cca64f3}, Known{thesis_ball(), 1024, 514, 0xd152506c0b33b2b7},
        Known{thesis_sheet(), 20'000, 10'201, 0x1d6184a29b36d97a},
        Known{wave_sheet(100, 100, 0), 20'000, 10'201, 0xe9b27b5af0c9d746},
        Known{wave_sheet(400, 250, 0), 200'000, 100'651, 0xa7b693708a51e5ce}}) {
    EXPECT_EQ(k.mesh.triangles().size(), k.triangles);
    EXPECT_EQ(k.mesh.positions().size(), k.vertices);
    EXPECT_EQ(hash(k.mesh), k.hash);
  }
}

TEST(Scenes, TwoHundredDentsGiveTheKnownSheet) {
  Mesh sheet = thesis_sheet();
  Rng rng(0x5EED0003);
  std::size_t moved_vertices = 0;
  for (int step = 0; step < 200; ++step) {
    const VertexMoves moves = dent_moves(random_dent(rng), sheet.positions());
    moved_vertices += moves.ids.size();
    sheet = moved(std::move(sheet), moves);
  }
  EXPECT_EQ(moved_vertices, 21227U);
  EXPECT_EQ(hash(sheet), 0xba587062faec7597U);
}

TEST(Scenes, RingIsClosedAndOnItsTube) {
  const Mesh mesh = ring(7, 5, 0.25);
  EXPECT_EQ(mesh.triangles().size(), 2U * 7 * 5);
  for (const Vec3& p : mesh.positions()) EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.25, 1e-15);
  expect_sound(mesh);
}

TEST(Scenes, SineAndCosineAreAccurate) {
  for (int i = -2000; i <= 2000; ++i) {
    const double x = 0.01 * i;
    EXPECT_NEAR(sine(x), std::sin(x), 4e-15) << x;
    EXPECT_NEAR(cosine(x), std::cos(x), 4e-15) << x;
  }
}

TEST(Soups, LatticeCoordinatesAreSmallIntegers) {
  Rng rng(8);
  const Mesh mesh = lattice_soup(rng, 300, 3);
  EXPECT_EQ(mesh.triangles().size(), 300U);
  for (const Vec3& p : mesh.positions()) {
    for (const double x : {p.x, p.y, p.z}) EXPECT_TRUE(x == 0 || x == 1 || x == 2);
  }
  const Mesh single = lattice_soup(rng, 4, 1);
  for (const Vec3& p : single.positions()) EXPECT_EQ(p, Vec3{});
}

/// Rounding of vertices that are placed within a hundred units.
constexpr double tolerance = 1e-14;

TEST(BallOverSquare, ExactDistanceIsTheSeparation) {
  const Mesh plane = grid(8, 8, -4, -4, 1, 1);  // the plane of the square, in larger squares
  const Mesh mesh = thesis_ball();
  EXPECT_EQ(ball_over_square(mesh, 1, 0).translation.x, 0.1 * std::sqrt(2.0));
  EXPECT_EQ(ball_over_square(mesh, 1, 0).translation.y, 0.1 * std::sqrt(3.0));
  EXPECT_NE(ball_over_square(mesh, 1, 1).rotation, ball_over_square(mesh, 1, 2).rotation);
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

struct Expected {
  Motion motion;
  std::uint64_t start, later;  // hashes of frames 0 and 100
};

std::uint64_t hash_at(const Motion& motion, double frame) {
  const std::vector<Vec3> positions = motion.positions(frame);
  return hash(MeshView{positions, motion.mesh.triangles()});
}

TEST(Motions, AreTheSameToTheBitOnEveryMachine) {
  const Expected all[] = {
      {waving_sheet(20, 10), 0x626562b68b91e032, 0xc33d5be7d6bcdcbb},
      {twisting_bar(5), 0xd1ff959ad5fcda7c, 0x3346af4acc6148a5},
      {crumpling_cloth(20), 0x3ab486cb921808d4, 0x3391a57572677942},
      {shuffled_soup(100), 0xa0eec1773746da06, 0x2ea4d064bbd7e30d},
  };
  for (const Expected& e : all) {
    EXPECT_EQ(hash_at(e.motion, 0), e.start) << e.motion.name << std::hex << " 0x" << hash_at(e.motion, 0);
    EXPECT_EQ(hash_at(e.motion, 100), e.later) << e.motion.name << std::hex << " 0x" << hash_at(e.motion, 100);
    EXPECT_EQ(hash(e.motion.mesh), e.start) << e.motion.name;
  }
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

}  // namespace
}  // namespace limber::scenes

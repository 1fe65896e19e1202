// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "reference/reference.h"
#include "scenes/motions.h"

namespace limber::scenes {
namespace {

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

void expect_closed(const Mesh& mesh) {
  std::multiset<std::pair<VertexId, VertexId>> edges;
  for (const Corners& c : mesh.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) edges.insert({c[i], c[(i + 1) % 3]});
  }
  for (const auto& [from, to] : edges) {
    EXPECT_EQ(edges.count({from, to}), 1U);
    EXPECT_EQ(edges.count({to, from}), 1U) << "edge " << from << " " << to << " has no neighbour";
  }
}

TEST(Scenes, BallIsClosedAndOnTheUnitSphere) {
  const Mesh mesh = ball(8, 5);
  EXPECT_EQ(mesh.triangles().size(), 2U * 8 * (5 - 1));
  for (const Vec3& p : mesh.positions()) EXPECT_NEAR(length(p), 1, 4e-16);
  expect_closed(mesh);
}

TEST(Scenes, RingIsClosedAndOnItsTube) {
  const Mesh mesh = ring(7, 5, 0.25);
  EXPECT_EQ(mesh.triangles().size(), 2U * 7 * 5);
  for (const Vec3& p : mesh.positions()) EXPECT_NEAR(std::hypot(std::hypot(p.x, p.y) - 1, p.z), 0.25, 1e-15);
  expect_closed(mesh);
  const Corners& first = mesh.triangles()[0];
  const Vec3 &a = mesh.positions()[first[0]], &b = mesh.positions()[first[1]], &c = mesh.positions()[first[2]];
  EXPECT_GT(dot(cross(b - a, c - a), a - Vec3{1, 0, 0}), 0) << "faces inward";
}

TEST(Scenes, SineAndCosineAreAccurate) {
  for (int i = -2000; i <= 2000; ++i) {
    const double x = 0.01 * i;
    EXPECT_NEAR(sine(x), std::sin(x), 4e-15) << x;
    EXPECT_NEAR(cosine(x), std::cos(x), 4e-15) << x;
  }
}

TEST(Scenes, RngGivesTheSplitmixSequence) {
  Rng rng(1234567);
  EXPECT_EQ(rng.next(), 6457827717110365317U);
  EXPECT_EQ(rng.next(), 3203168211198807973U);
  EXPECT_EQ(rng.next(), 9817491932198370423U);
}

TEST(Dents, MoveExactlyTheVerticesWithinTheRadiusInProportion) {
  const Mesh sheet = grid(10, 10, 0, 0, 1, 1);
  const Dent dent{.x = 5, .y = 5, .radius = 2, .slope = -0.25};
  const VertexMoves moves = dent_moves(dent, sheet.positions());
  EXPECT_EQ(moves.ids.size(), 13U);  // lattice points within 2, the four at exactly 2 included
  EXPECT_TRUE(std::is_sorted(moves.ids.begin(), moves.ids.end()));
  const Mesh dented = moved(sheet, moves);
  for (std::size_t v = 0; v < sheet.positions().size(); ++v) {
    const Vec3& before = sheet.positions()[v];
    const double distance = std::hypot(before.x - 5, before.y - 5);
    const double shift = distance <= 2 ? -0.25 * distance : 0;
    EXPECT_NEAR(dented.positions()[v].z, before.z + shift, 1e-15);
    EXPECT_EQ(dented.positions()[v].x, before.x);
    EXPECT_EQ(dented.positions()[v].y, before.y);
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

}  // namespace
}  // namespace limber::scenes

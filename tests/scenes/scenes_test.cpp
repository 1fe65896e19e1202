// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <string>

namespace limber::scenes {
namespace {

Mesh moved(Mesh mesh, const VertexMoves& moves) {
  for (std::size_t i = 0; i < moves.ids.size(); ++i) mesh.set_position(moves.ids[i], moves.positions[i]).value();
  return mesh;
}

TEST(Scenes, ThesisMeshesAreThoseOfTheExperimentToTheBit) {
  EXPECT_EQ(thesis_square().triangles().size(), 8192U);
  EXPECT_EQ(thesis_square().positions().size(), 4225U);
  EXPECT_EQ(hash(thesis_square()), 0xc6136dff7cca64f3U);
  EXPECT_EQ(thesis_ball().triangles().size(), 1024U);
  EXPECT_EQ(thesis_ball().positions().size(), 514U);
  EXPECT_EQ(hash(thesis_ball()), 0xd152506c0b33b2b7U);
  EXPECT_EQ(thesis_sheet().triangles().size(), 20000U);
  EXPECT_EQ(thesis_sheet().positions().size(), 10201U);
  EXPECT_EQ(hash(thesis_sheet()), 0x1d6184a29b36d97aU);
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
  EXPECT_EQ(hash(by_name("dented").value()), hash(sheet));
}

TEST(Scenes, WaveSheetsAreTheKnownOnes) {
  EXPECT_EQ(hash(wave_sheet(100, 100, 0)), 0xe9b27b5af0c9d746U);
  EXPECT_EQ(hash(wave_sheet(400, 250, 0)), 0xa7b693708a51e5ceU);
  EXPECT_EQ(wave_sheet(400, 250, 0).triangles().size(), 200000U);
}

TEST(Scenes, WaveFramesShareTrianglesAndDifferInPositions) {
  const Mesh first = wave_sheet(20, 10, 0);
  const Mesh second = wave_sheet(20, 10, 1);
  EXPECT_EQ(first.triangles(), second.triangles());
  EXPECT_NE(first.positions(), second.positions());
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

TEST(Scenes, RngStaysInItsRanges) {
  Rng rng(1);
  for (int i = 0; i < 1000; ++i) {
    const double u = rng.uniform();
    EXPECT_TRUE(0 <= u && u < 1);
    const double v = rng.uniform(-3, 5);
    EXPECT_TRUE(-3 <= v && v < 5);
    EXPECT_LT(rng.below(7), 7U);
  }
  EXPECT_EQ(rng.below(1), 0U);
}

TEST(Scenes, RandomRotationsAreRigid) {
  Rng rng(2);
  for (int i = 0; i < 100; ++i) EXPECT_TRUE(is_rigid({random_rotation(rng), {}}));
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

TEST(Dents, AddUpWhenRepeated) {
  const Mesh sheet = grid(10, 10, 0, 0, 1, 1);
  const Dent dent{.x = 4.5, .y = 4.5, .radius = 3, .slope = 0.5};
  const Mesh once = moved(sheet, dent_moves(dent, sheet.positions()));
  const Mesh twice = moved(once, dent_moves(dent, once.positions()));
  for (std::size_t v = 0; v < sheet.positions().size(); ++v) {
    EXPECT_EQ(twice.positions()[v].z, 2 * once.positions()[v].z);
  }
}

TEST(Dents, RandomOnesAreInTheirRanges) {
  Rng rng(3);
  int up = 0;
  for (int i = 0; i < 1000; ++i) {
    const Dent dent = random_dent(rng);
    EXPECT_TRUE(0 <= dent.x && dent.x < 100);
    EXPECT_TRUE(0 <= dent.y && dent.y < 100);
    EXPECT_TRUE(1 <= dent.radius && dent.radius < 10);
    EXPECT_EQ(std::abs(dent.slope), 0.1);
    up += dent.slope > 0 ? 1 : 0;
  }
  EXPECT_NEAR(up, 500, 80);
}

TEST(Soups, OwnTheirVerticesAndFollowTheSeed) {
  Rng rng_a(7);
  Rng rng_b(7);
  const Mesh a = random_soup(rng_a, 50, 0.5);
  EXPECT_EQ(hash(a), hash(random_soup(rng_b, 50, 0.5)));
  EXPECT_NE(hash(a), hash(random_soup(rng_b, 50, 0.5)));  // the generator has moved on
  EXPECT_EQ(a.triangles().size(), 50U);
  EXPECT_EQ(a.positions().size(), 150U);
  for (const Vec3& p : a.positions()) EXPECT_LE(max_abs(p), 1.25);
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

TEST(Soups, LatticeTrianglesAreOftenDegenerate) {
  Rng rng(9);
  const Mesh mesh = lattice_soup(rng, 300, 2);
  int points = 0;
  int segments = 0;
  for (TriangleId id = 0; id < 300; ++id) {
    const Triangle t = mesh.triangle(id);
    if (t.v0 == t.v1 && t.v1 == t.v2) {
      ++points;
    } else if (cross(t.v1 - t.v0, t.v2 - t.v0) == Vec3{}) {
      ++segments;
    }
  }
  EXPECT_GT(points, 0);
  EXPECT_GT(segments, 0);
}

TEST(ByName, KnowsEverySceneItNames) {
  for (const char* name : {"square", "ball", "sheet", "dented", "dented:5", "wave", "wave:3", "soup", "soup:9",
                           "lattice", "lattice:18446744073709551615"}) {
    EXPECT_TRUE(by_name(name)) << name;
  }
  EXPECT_EQ(hash(by_name("ball").value()), hash(thesis_ball()));
  EXPECT_EQ(hash(by_name("wave:3").value()), hash(wave_sheet(100, 100, 3)));
}

TEST(ByName, IsDeterministicPerSeedAndDiffersBetweenSeeds) {
  for (const char* name : {"dented:", "wave:", "soup:", "lattice:"}) {
    const std::string base(name);
    EXPECT_EQ(hash(by_name(base + "4").value()), hash(by_name(base + "4").value())) << base;
    EXPECT_NE(hash(by_name(base + "4").value()), hash(by_name(base + "5").value())) << base;
  }
}

TEST(ByName, RefusesWhatItDoesNotKnowAndListsWhatItDoes) {
  for (const char* name : {"", ":", "bowl", "ball:1", "soup:", "soup:x", "soup:1x", "soup:-1", "soup:1:2", "Soup",
                           "soup:18446744073709551616"}) {
    const Result<Mesh> scene = by_name(name);
    ASSERT_FALSE(scene) << name;
    EXPECT_EQ(scene.error().code, ErrorCode::unsupported_format);
    EXPECT_NE(scene.error().text.find("square, ball, sheet, dented[:number]"), std::string::npos) << scene.error().text;
  }
}

}  // namespace
}  // namespace limber::scenes

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Welding of equal positions: known answers, a brute-force twin, any order of vertices, soups that become surfaces, and
// mistakes of callers. Positions whose hash values collide are in tests/io.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "limber/mesh.h"
#include "limber/model.h"
#include "limber/points.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

/// What weld() says, by comparing each position with all before it.
Weld brute_force_weld(const std::vector<Vec3>& positions) {
  Weld result;
  for (const Vec3& p : positions) {
    std::size_t w = 0;
    while (w < result.first_of.size() && positions[result.first_of[w]] != p) ++w;
    if (w == result.first_of.size()) result.first_of.push_back(static_cast<VertexId>(result.welded_of.size()));
    result.welded_of.push_back(static_cast<VertexId>(w));
  }
  return result;
}

void expect_twin(const std::vector<Vec3>& positions) {
  const Weld found = weld(positions), truth = brute_force_weld(positions);
  EXPECT_EQ(found.welded_of, truth.welded_of);
  EXPECT_EQ(found.first_of, truth.first_of);
}

/// A mesh whose triangles have vertices of their own.
Mesh soup_of(const Mesh& mesh) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (const Corners& corners : mesh.triangles()) {
    const auto first = static_cast<VertexId>(positions.size());
    for (const VertexId v : corners) positions.push_back(mesh.positions()[v]);
    triangles.push_back({first, first + 1, first + 2});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

TEST(Weld, OfPositionsIsThatOfTheTwin) {
  Rng rng(1601);
  expect_twin({});
  expect_twin({{0.0, 0, 0}, {-0.0, 0, -0.0}, {0x1p-1074, 0, 0}, {0, 0, 0}, {1, 0, 0}, {1 + 0x1p-52, 0, 0}});
  for (int i = 0; i < 60 && !HasFailure(); ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(rng.below(400)) - 200);
    const std::uint64_t side = 1 + rng.below(9);
    const Vec3 offset = rng.below(2) == 0 ? Vec3{} : uniform_point(rng, -1e12, 1e12);
    std::vector<Vec3> positions(rng.below(700));
    for (Vec3& p : positions) p = scale * (lattice_point(rng, side) - Vec3{1, 1, 1} + offset);
    expect_twin(positions);
  }
}

TEST(Weld, OfAPlaneOfAnyDirectionIsFast) {
  // Each axis with two others: a table that took only some bits of a coordinate would be slow for one of them.
  for (std::size_t axis = 0; axis < 3; ++axis) {
    std::vector<Vec3> positions(1'000'000);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i][(axis + 1) % 3] = static_cast<double>(i % 1000);
      positions[i][(axis + 2) % 3] = static_cast<double>(i / 1000);
    }
    EXPECT_EQ(weld(positions).first_of.size(), positions.size());
  }
}

TEST(Weld, OfASoupIsASurfaceWithTheSameTriangles) {
  const Mesh ball = scenes::ball(20, 12), soup = soup_of(ball);
  ASSERT_FALSE(soup.is_closed());
  const WeldedMesh welded = weld(soup);
  EXPECT_TRUE(welded.mesh.is_closed());
  EXPECT_EQ(welded.mesh.positions().size(), ball.positions().size());
  ASSERT_EQ(welded.mesh.triangles().size(), ball.triangles().size());
  for (std::size_t v = 0; v < soup.positions().size(); ++v) {
    EXPECT_EQ(welded.mesh.positions()[welded.vertices.welded_of[v]], soup.positions()[v]);
  }
  for (std::size_t v = 0; v < welded.vertices.first_of.size(); ++v) {
    EXPECT_EQ(welded.mesh.positions()[v], soup.positions()[welded.vertices.first_of[v]]);
  }
  for (TriangleId t = 0; t < ball.triangles().size(); ++t) {
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(welded.mesh.triangle(t)[i], ball.triangle(t)[i]);
  }
  const Model model(welded.mesh);
  EXPECT_TRUE(ClosedSurface::create(model).value().contains({}));
  // Once more changes nothing.
  EXPECT_EQ(weld(welded.mesh).mesh.triangles(), welded.mesh.triangles());
}

TEST(Weld, KeepsTrianglesThatBecomeSegmentsAndPoints) {
  const Vec3 p{1, 2, 3}, q{4, 5, 6};
  const Mesh mesh = Mesh::create({p, q, p, p, {7, 7, 7}}, {{0, 1, 2}, {3, 2, 0}}).value();
  const WeldedMesh welded = weld(mesh);
  EXPECT_EQ(welded.mesh.positions(), (std::vector<Vec3>{p, q, {7, 7, 7}}));
  EXPECT_EQ(welded.mesh.triangles(), (std::vector<Corners>{{0, 1, 0}, {0, 0, 0}}));
  EXPECT_EQ(welded.vertices.welded_of, (std::vector<VertexId>{0, 1, 0, 0, 2}));
}

TEST(Weld, RefusesWhatIsNoNumberAndMeshesThatWereMovedFrom) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  try {
    static_cast<void>(weld(std::vector<Vec3>{{0, 0, 0}, {0, 0, nan}}));
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "limber::weld: vertex 1 has a coordinate that is not a number");
  }
  Mesh mesh = scenes::ball(6, 4);
  const Mesh taken = std::move(mesh);
  EXPECT_THROW(static_cast<void>(weld(mesh)),
               std::invalid_argument);  // NOLINT(bugprone-use-after-move): that is the mistake
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Meshes, welding of equal positions, and triangles that are near along the surface: known answers, twins, mistakes of
// callers. Weld also has a random order of vertices, and soups that become surfaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "limber/contacts.h"
#include "limber/mesh.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "support/random_scene.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

const std::vector<Vec3> corner_positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(Mesh, KeepsWhatItIsGiven) {
  const Mesh mesh = Mesh::create(corner_positions, {{0, 1, 2}, {2, 1, 0}}).value();
  EXPECT_EQ(mesh.triangles().size(), 2U);
  EXPECT_EQ(mesh.triangle(1).v0, corner_positions[2]);
  EXPECT_EQ(mesh.view().positions.size(), 3U);
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corner_positions, {{0, 0, 0}})));  // degenerate, two unreferenced vertices
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corner_positions, {{0, 1, 1}})));
}

/// By a table of edges.
bool is_closed_for_certain(const std::vector<Corners>& triangles) {
  std::map<std::pair<VertexId, VertexId>, int> uses;
  for (const Corners& c : triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++uses[{c[k], c[(k + 1) % 3]}], --uses[{c[(k + 1) % 3], c[k]}];
  }
  return std::all_of(uses.begin(), uses.end(), [](const auto& edge) { return edge.second == 0; });
}

TEST(Mesh, IsClosedExactlyWhereATableOfEdgesSaysSo) {
  scenes::Rng rng(51);
  int closed = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::vector<Corners> triangles;
    // Tetrahedra at random vertices, some turned; a face of some is missing or turned.
    const std::uint64_t vertex_count = 4 + rng.below(150);
    for (std::uint64_t t = 0; t < 1 + rng.below(6); ++t) {
      VertexId v[4];
      for (VertexId& corner : v) corner = static_cast<VertexId>(rng.below(vertex_count));
      for (const Corners& c : {Corners{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) {
        triangles.push_back({v[c[0]], v[c[1]], v[c[2]]});
      }
    }
    if (rng.below(3) == 0) std::swap(triangles[rng.below(triangles.size())][0], triangles.back()[1]);
    if (rng.below(4) == 0 && triangles.size() > 1) triangles.pop_back();
    const bool truth = is_closed_for_certain(triangles);
    closed += truth;
    ASSERT_EQ(Mesh::create(std::vector<Vec3>(vertex_count), triangles).value().is_closed(), truth) << "case " << i;
  }
  EXPECT_GT(closed, 5000);
  EXPECT_LT(closed, 15'000);
}

TEST(Mesh, NamesTheFirstOffence) {
  const struct {
    std::vector<Vec3> positions;
    std::vector<Corners> triangles;
    ErrorCode code;
    std::size_t where;
    const char* text;
  } cases[] = {
      {corner_positions, {}, ErrorCode::empty_mesh, no_id, ""},
      {corner_positions,
       {{0, 1, 2}, {0, 1, 3}},
       ErrorCode::index_out_of_range,
       1,
       "triangle 1 names vertex 3, but there are only 3 vertices"},
      {{{0, 0, 0}, {1, NAN, 0}, {0, 1, 0}}, {{0, 1, 2}}, ErrorCode::non_finite, 1, "vertex 1 is not finite"},
      {{{0, 0, 0}, {1, 0, INFINITY}, {0, 1, 0}}, {{0, 1, 2}}, ErrorCode::non_finite, 1, ""},
      {{{0, 0, 0}, {1, 0, 0}, {0, -1e100, 0}}, {{0, 1, 2}}, ErrorCode::too_large, 2, ""},
  };
  for (const auto& [positions, triangles, code, where, text] : cases) {
    const Error error = Mesh::create(positions, triangles).error();
    EXPECT_EQ(error.code, code) << error.text;
    EXPECT_EQ(error.where.value_or(no_id), where) << error.text;
    EXPECT_NE(error.text.find(text), std::string::npos) << error.text;
  }
}

TEST(Mesh, ReplacesPositionsThatAreSoundAndNoOthers) {
  Mesh mesh = Mesh::create(corner_positions, {{0, 1, 2}}).value();
  const std::vector<Vec3> moved{{0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, infinite{{0, 0, 1}, {1, 0, INFINITY}, {0, 1, 1}};
  const std::vector<VertexId> ids{0, 1, 2}, beyond{0, 3, 1};
  EXPECT_EQ(mesh.set_position(3, {}).error().code, ErrorCode::index_out_of_range);
  EXPECT_EQ(mesh.set_position(0, {NAN, 0, 0}).error().code, ErrorCode::non_finite);
  EXPECT_EQ(mesh.set_position(0, {1e100, 0, 0}).error().code, ErrorCode::too_large);
  EXPECT_EQ(mesh.set_positions(ids, {}).error().code, ErrorCode::size_mismatch);
  EXPECT_EQ(mesh.set_positions(beyond, moved).error().where, 1U);
  EXPECT_EQ(mesh.set_positions(ids, infinite).error().where, 1U);
  EXPECT_EQ(mesh.set_positions(std::vector<Vec3>{{}}).error().code, ErrorCode::size_mismatch);
  EXPECT_EQ(mesh.set_positions(infinite).error().text, "entry 1 of the update is not finite");
  EXPECT_EQ(mesh.positions(), corner_positions);

  mesh.set_position(1, moved[1]).value();
  EXPECT_EQ(mesh.positions(), (std::vector<Vec3>{corner_positions[0], moved[1], corner_positions[2]}));
  mesh.set_positions(moved).value();
  EXPECT_EQ(mesh.positions(), moved);
  mesh.set_positions(ids, corner_positions).value();
  EXPECT_EQ(mesh.positions(), corner_positions);
}

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
  const Mesh ball = scenes::ball(20, 12);
  const auto triangles_of = [](const Mesh& mesh) {
    std::vector<Triangle> triangles;
    for (TriangleId t = 0; t < mesh.triangles().size(); ++t) triangles.push_back(mesh.triangle(t));
    return triangles;
  };
  const Mesh apart = soup(triangles_of(ball));
  ASSERT_FALSE(apart.is_closed());
  const WeldedMesh welded = weld(apart);
  EXPECT_TRUE(welded.mesh.is_closed());
  EXPECT_EQ(welded.mesh.positions().size(), ball.positions().size());
  EXPECT_EQ(soup(triangles_of(welded.mesh)).positions(), apart.positions());
  EXPECT_EQ(welded.vertices.welded_of, weld(apart.positions()).welded_of);
  EXPECT_EQ(welded.vertices.first_of, weld(apart.positions()).first_of);
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
  EXPECT_TRUE(is_refused(
      [] {
        static_cast<void>(weld(std::vector<Vec3>{{0, 0, 0}, {0, 0, NAN}}));
      },
      {"limber::weld: vertex 1 has a coordinate that is not a number"}));
  Mesh mesh = scenes::ball(6, 4);
  const Mesh taken = std::move(mesh);
  EXPECT_TRUE(is_refused([&] { static_cast<void>(weld(mesh)); }, {"moved from"}));  // NOLINT(bugprone-use-after-move)
}

/// Triangles of random vertices, some of which name a vertex twice; sheets and balls with odd triangles.
Mesh tangled(Rng& rng) {
  if (rng.below(3) == 0) {
    std::vector<Vec3> positions(1 + rng.below(60));
    std::vector<Corners> triangles(1 + rng.below(40));
    for (Corners& c : triangles) {
      for (VertexId& v : c) v = static_cast<VertexId>(rng.below(positions.size()));
    }
    return Mesh::create(std::move(positions), std::move(triangles)).value();
  }
  const Mesh mesh = rng.below(2) == 0 ? scenes::ball(some(rng, 3, 10), some(rng, 2, 8))
                                      : scenes::grid(some(rng, 1, 10), some(rng, 1, 10), 0, 0, 1, 1);
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& c : triangles) {
    if (rng.below(30) == 0) c[rng.below(3)] = static_cast<VertexId>(rng.below(mesh.positions().size()));
  }
  return Mesh::create(mesh.positions(), std::move(triangles)).value();
}

TEST(NeighborRings, AreThoseOfASearchFromEveryVertex) {
  Rng rng(1501);
  std::size_t near_count = 0, far_count = 0;
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = tangled(rng);
    const auto edges = static_cast<std::uint32_t>(rng.below(6));
    const NeighborRings rings(mesh, edges);
    const std::vector<TrianglePair> truth = reference::near_pairs(mesh, edges);
    ASSERT_EQ(rings.pair_count(), truth.size());
    std::size_t next = 0;
    for (TriangleId a = 0; a < mesh.triangles().size(); ++a) {
      for (TriangleId b = a + 1; b < mesh.triangles().size(); ++b) {
        const bool is_near = next < truth.size() && truth[next] == TrianglePair{a, b};
        next += is_near ? 1 : 0;
        ASSERT_EQ(rings.are_near(a, b), is_near) << a << ' ' << b;
        ASSERT_EQ(rings.are_near(b, a), is_near) << b << ' ' << a;
        ++(is_near ? near_count : far_count);
      }
    }
  }
  EXPECT_GT(near_count, 10'000U);
  EXPECT_GT(far_count, 10'000U);
}

TEST(NeighborRings, DoNotJumpFromPieceToPiece) {
  const NeighborRings rings(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}),
                            std::numeric_limits<std::uint32_t>::max());
  EXPECT_FALSE(rings.are_near(0, 1));  // equal positions, other vertices
  EXPECT_TRUE(rings.are_near(0, 0));
  EXPECT_EQ(rings.pair_count(), 0U);
}

TEST(NeighborRings, LeaveOnlyContactsOfOtherParts) {
  // A sheet that is folded in the middle, a little above itself.
  const Mesh flat = scenes::grid(20, 4, 0, 0, 1, 1);
  const Model model(mapped(flat, [](const Vec3& p) { return p.x > 10 ? Vec3{20 - p.x, p.y, 0.5} : p; }));
  const NeighborRings rings(flat, 2);
  std::vector<Contact> found(self_contacts(model, 0.6, {}).count);
  const std::size_t far = self_contacts(model, 0.6, found, {.filter = rings}).count;
  EXPECT_GT(far, 100U);
  EXPECT_LT(far, found.size());
  for (std::size_t i = 0; i < far; ++i) EXPECT_NE(found[i].point_a.z, found[i].point_b.z);
}

TEST(NeighborRings, RefuseMeshesAndTrianglesThatAreNotThere) {
  Mesh mesh = scenes::grid(2, 2, 0, 0, 1, 1);
  NeighborRings rings(mesh, 1);
  EXPECT_THROW((void)rings.are_near(0, 8), std::invalid_argument);
  EXPECT_THROW((void)rings(no_id, 0), std::invalid_argument);
  const Model larger(scenes::grid(6, 6, 0, 0, 1, 1));
  EXPECT_THROW(self_contacts(larger, 10, {}, {.filter = rings}), std::invalid_argument);
  const NeighborRings taken_rings = std::move(rings);
  EXPECT_TRUE(taken_rings.are_near(0, 1));
  EXPECT_THROW((void)rings.are_near(0, 1), std::invalid_argument);  // NOLINT(*-use-after-move,*-cplusplus.Move)
  const Mesh taken = std::move(mesh);
  EXPECT_EQ(taken.triangles().size(), 8U);
  EXPECT_THROW(NeighborRings(mesh, 1), std::invalid_argument);  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "scenes/scenes.h"

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

TEST(Mesh, IsClosedWhereOppositeEdgesCancel) {
  const auto is_closed = [](std::vector<Corners> triangles) {
    return Mesh::create(std::vector<Vec3>(200), std::move(triangles)).value().is_closed();
  };
  const std::vector<Corners> tetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  EXPECT_TRUE(is_closed(tetrahedron));
  EXPECT_FALSE(is_closed({tetrahedron[0], tetrahedron[1], tetrahedron[2]}));
  EXPECT_FALSE(is_closed({tetrahedron[0], tetrahedron[1], tetrahedron[2], {0, 2, 3}}));  // one face is turned
  EXPECT_TRUE(is_closed({{0, 1, 2}, {0, 2, 1}}));
  EXPECT_FALSE(is_closed({{0, 1, 2}, {0, 1, 2}}));
  EXPECT_TRUE(is_closed({{5, 5, 5}, {1, 1, 2}}));  // no side of them is an edge that counts, or both cancel
  EXPECT_TRUE(scenes::ball(20, 12).is_closed());
  EXPECT_TRUE(scenes::ring(20, 12, 0.3).is_closed());
  EXPECT_FALSE(scenes::grid(3, 3, 0, 0, 1, 1).is_closed());
  // Two tetrahedra that share an edge: four triangles have it.
  std::vector<Corners> two = tetrahedron;
  for (const Corners& c : tetrahedron)
    two.push_back({c[0] < 2 ? c[0] : c[0] + 2, c[1] < 2 ? c[1] : c[1] + 2, c[2] < 2 ? c[2] : c[2] + 2});
  EXPECT_TRUE(is_closed(two));
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
  const auto error_of = [](std::vector<Vec3> positions, std::vector<Corners> triangles) {
    return Mesh::create(std::move(positions), std::move(triangles)).error();
  };
  EXPECT_EQ(error_of(corner_positions, {}).code, ErrorCode::empty_mesh);
  const Error index = error_of(corner_positions, {{0, 1, 2}, {0, 1, 3}});
  EXPECT_EQ(index.code, ErrorCode::index_out_of_range);
  EXPECT_EQ(index.where, 1U);
  EXPECT_EQ(index.text, "triangle 1 names vertex 3, but there are only 3 vertices");
  const Error nan = error_of({{0, 0, 0}, {1, NAN, 0}, {0, 1, 0}}, {{0, 1, 2}});
  EXPECT_EQ(nan.code, ErrorCode::non_finite);
  EXPECT_EQ(nan.text, "vertex 1 is not finite");
  EXPECT_EQ(error_of({{0, 0, 0}, {1, 0, INFINITY}, {0, 1, 0}}, {{0, 1, 2}}).code, ErrorCode::non_finite);
  const Error large = error_of({{0, 0, 0}, {1, 0, 0}, {0, -1e100, 0}}, {{0, 1, 2}});
  EXPECT_EQ(large.code, ErrorCode::too_large);
  EXPECT_EQ(large.where, 2U);
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

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::testing {
namespace {

const std::vector<Vec3> corner_positions{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(Mesh, KeepsWhatItIsGiven) {
  const Mesh mesh = Mesh::create(corner_positions, {{0, 1, 2}, {2, 1, 0}}).value();
  EXPECT_EQ(mesh.triangles().size(), 2U);
  EXPECT_EQ(mesh.triangle(1).v0, corner_positions[2]);
  EXPECT_EQ(mesh.view().positions.size(), 3U);
}

TEST(Mesh, AcceptsDegenerateTrianglesAndUnreferencedVertices) {
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corner_positions, {{0, 0, 0}})));
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corner_positions, {{0, 1, 1}})));
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

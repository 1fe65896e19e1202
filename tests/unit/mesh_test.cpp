// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/mesh.h"

#include <gtest/gtest.h>

#include <cmath>

namespace limber::testing {
namespace {

const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(Mesh, KeepsWhatItIsGiven) {
  const Mesh mesh = Mesh::create(corners, {{0, 1, 2}, {2, 1, 0}}).value();
  EXPECT_EQ(mesh.triangles().size(), 2U);
  EXPECT_EQ(mesh.triangle(1).v0, corners[2]);
  EXPECT_EQ(mesh.view().positions.size(), 3U);
}

TEST(Mesh, AcceptsDegenerateTrianglesAndUnreferencedVertices) {
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corners, {{0, 0, 0}})));
  EXPECT_TRUE(static_cast<bool>(Mesh::create(corners, {{0, 1, 1}})));
}

TEST(Mesh, NamesTheFirstOffence) {
  const auto error_of = [](std::vector<Vec3> positions, std::vector<Corners> triangles) {
    return Mesh::create(std::move(positions), std::move(triangles)).error();
  };
  EXPECT_EQ(error_of(corners, {}).code, ErrorCode::empty_mesh);
  const Error index = error_of(corners, {{0, 1, 2}, {0, 1, 3}});
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

}  // namespace
}  // namespace limber::testing

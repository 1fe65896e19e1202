// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "geometry/rigid.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

TEST(Transform, TurnsThenShifts) {
  const double h = std::sqrt(0.5);  // a quarter turn around z
  const Transform t = transform_from_quaternion({10, 0, 0}, h, 0, 0, h).value();
  EXPECT_NEAR(length(t({1, 0, 0}) - Vec3{10, 1, 0}), 0, 1e-15);
}

TEST(Transform, InverseAndProductUndoEachOther) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Transform a = random_pose(rng, 5), b = random_pose(rng, 5);
    const Vec3 p = uniform_point(rng);
    EXPECT_NEAR(length((a * b)(p)-a(b(p))), 0, 1e-14);
    EXPECT_NEAR(length(inverse(a)(a(p)) - p), 0, 1e-14);
    EXPECT_TRUE(is_rigid(a));
    EXPECT_TRUE(is_rigid(inverse(a * b)));
  }
}

TEST(Transform, QuaternionOfAnyLengthGivesTheSameRotation) {
  const Transform one = transform_from_quaternion({}, 0.5, 0.5, 0.5, 0.5).value();
  for (const double scale : {1e-300, 3.0, 1e300}) {
    const Transform other = transform_from_quaternion({}, scale, scale, scale, scale).value();
    EXPECT_NEAR(length(other({1, 2, 3}) - one({1, 2, 3})), 0, 1e-14);
  }
  EXPECT_NEAR(length(one({1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-15);
}

TEST(Transform, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(transform_from_quaternion({}, 0, 0, 0, 0).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({}, nan, 0, 0, 1).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({nan, 0, 0}, 1, 0, 0, 0).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({1e300, 0, 0}, 1, 0, 0, 0).error().code, ErrorCode::too_large);
}

TEST(Transform, ReflectionsAndStretchesAreNotRigid) {
  EXPECT_TRUE(is_rigid({}));
  EXPECT_FALSE(is_rigid({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}));
  EXPECT_FALSE(is_rigid({{{1.001, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}));
  EXPECT_FALSE(is_rigid({{}, {std::numeric_limits<double>::infinity(), 0, 0}}));
  EXPECT_FALSE(is_rigid({{}, {0x1p201, 0, 0}}));
}

TEST(Transform, ErrorsSayWhatIsNotRigid) {
  const auto text_of = [](const Mat3& m) {
    return transform_from_matrix(std::array{m.row0.x, m.row0.y, m.row0.z, 0.0, m.row1.x, m.row1.y, m.row1.z, 0.0,
                                            m.row2.x, m.row2.y, m.row2.z, 0.0, 0.0, 0.0, 0.0, 1.0},
                                 MatrixOrder::row_major)
        .error()
        .text;
  };
  Rng rng(4);
  const Mat3 turn = scenes::random_rotation(rng);
  const auto turned = [&](double x, double y, double z) { return turn * Mat3{{x, 0, 0}, {0, y, 0}, {0, 0, z}}; };
  const std::string start = "the matrix is not rigid: it ", end = "; that belongs into the vertices";
  EXPECT_EQ(text_of(turned(25.4, 25.4, 25.4)), start + "scales by 25.4" + end);
  EXPECT_EQ(text_of(turned(1, 2, 0.5)), start + "scales by 1, 2 and 0.5 along x, y and z" + end);
  EXPECT_EQ(text_of(turned(1, 1, -1)), start + "mirrors" + end);
  EXPECT_EQ(text_of(turned(2, 2, -2)), start + "scales by 2, and mirrors" + end);
  const Mat3 sheared = turn * Mat3{{1, 0.6, 0}, {0, 0.8, 0}, {0, 0, 1}};
  EXPECT_EQ(text_of(sheared), start + "shears" + end);
  EXPECT_NE(text_of(turned(1, 1 + 1e-7, 1)).find("its rotation is off by 2e-07"), std::string::npos);
  EXPECT_NE(text_of(turned(0, 0, 0)).find("scales by 0"), std::string::npos);
}

const std::vector<Corners> one_triangle{{0, 1, 2}};

TEST(PositionsView, ReadsPackedCoordinatesOfEitherPrecision) {
  const std::vector<float> floats{0, 0, 0, 0.1F, 0, 0, 0, 0.5F, 0};
  const std::vector<double> doubles{0, 0, 0, 0.1, 0, 0, 0, 0.5, 0};
  const Mesh of_floats = Mesh::create(PositionsView::packed(floats), one_triangle).value();
  const Mesh of_doubles = Mesh::create(PositionsView::packed(doubles), one_triangle).value();
  EXPECT_EQ(of_floats.positions()[1], (Vec3{double{0.1F}, 0, 0}));
  EXPECT_EQ(of_doubles.positions()[1], (Vec3{0.1, 0, 0}));
  EXPECT_EQ(of_floats.positions()[2], of_doubles.positions()[2]);
  EXPECT_THROW(PositionsView::packed(std::span(floats).first(8)), std::invalid_argument);
}

TEST(PositionsView, ReadsStridedCoordinatesWithoutAlignment) {
  struct Vertex {
    float normal[3], position[3];
    unsigned char color[4];
  };
  const std::vector<Vertex> vertices{{{}, {1, 2, 3}, {}}, {{}, {4, 5, 6}, {}}, {{}, {7, 8, 9}, {}}};
  const PositionsView view = PositionsView::strided(vertices[0].position, vertices.size(), sizeof(Vertex));
  EXPECT_EQ(view[1], (Vec3{4, 5, 6}));
  // One byte off, and a stride that is no multiple of anything.
  std::vector<unsigned char> bytes(1 + 3 * 29);
  for (std::size_t i = 0; i < 3; ++i) {
    const double p[3] = {1.0 * static_cast<double>(i), 2, 3};
    std::memcpy(bytes.data() + 1 + 29 * i, p, sizeof(p));
  }
  const PositionsView odd = PositionsView::strided(reinterpret_cast<const double*>(bytes.data() + 1), 3, 29);
  EXPECT_EQ(odd[2], (Vec3{2, 2, 3}));
}

TEST(PositionsView, RefusesNegativeStrides) {
  const std::vector<float> floats(6);
  const std::vector<double> doubles(6);
  const auto backwards = static_cast<std::size_t>(-24);
  EXPECT_THROW(PositionsView::strided(floats.data() + 3, 2, backwards), std::invalid_argument);
  EXPECT_THROW(PositionsView::strided(doubles.data() + 3, 2, backwards), std::invalid_argument);
  EXPECT_EQ(PositionsView::strided(doubles.data(), 2, 0).size(), 2U);
}

TEST(PositionsView, MovesModels) {
  Model model(scenes::grid(4, 4, 0, 0, 1, 1)), same(scenes::grid(4, 4, 0, 0, 1, 1));
  std::vector<Vec3> positions = model.mesh().positions();
  std::vector<float> floats;
  for (Vec3& p : positions) {
    p.z = 0.25 * p.x;
    for (std::size_t k = 0; k < 3; ++k) floats.push_back(static_cast<float>(p[k]));
  }
  model.move_all(PositionsView::packed(floats)).value();
  same.move_all(positions).value();
  EXPECT_EQ(model.mesh().positions(), same.mesh().positions());
  const std::vector<VertexId> ids{3};
  const std::vector<double> to{9, 8, 7};
  model.move_vertices(ids, PositionsView::packed(to)).value();
  EXPECT_EQ(model.mesh().positions()[3], (Vec3{9, 8, 7}));
  floats.pop_back(), floats.pop_back(), floats.pop_back();
  EXPECT_EQ(model.move_all(PositionsView::packed(floats)).error().code, ErrorCode::size_mismatch);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>

#include "limber/math.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

Mat3 in_float32(const Mat3& m) {
  const auto rounded = [](const Vec3& v) {
    const auto x = static_cast<float>(v.x), y = static_cast<float>(v.y), z = static_cast<float>(v.z);
    return Vec3{x, y, z};
  };
  return {rounded(m.row0), rounded(m.row1), rounded(m.row2)};
}

double largest_difference(const Mat3& a, const Mat3& b) {
  return std::max({max_abs(a.row0 - b.row0), max_abs(a.row1 - b.row1), max_abs(a.row2 - b.row2)});
}

TEST(Orthonormalized, MakesRotationsOfFloat32Rigid) {
  Rng rng(700);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 rotation = scenes::random_rotation(rng), rounded = in_float32(rotation);
    const Mat3 mended = orthonormalized(rounded).value();
    ASSERT_TRUE(is_rigid({mended, {}}));
    ASSERT_LE(max_stretch(mended) - 1, 1e-14);
    ASSERT_LE(largest_difference(mended, rotation), 2e-7);
  }
}

TEST(Orthonormalized, FindsTheNearestRotation) {
  // A symmetric stretch leaves the nearest rotation as it is.
  Rng rng(701);
  for (int i = 0; i < 1000; ++i) {
    const Mat3 rotation = scenes::random_rotation(rng), frame = scenes::random_rotation(rng);
    const Mat3 scale{{1 + rng.uniform(-0.01, 0.01), 0, 0}, {0, 1 + rng.uniform(-0.01, 0.01), 0}, {0, 0, 1}};
    const Mat3 stretched = rotation * (transpose(frame) * (scale * frame));
    ASSERT_LE(largest_difference(orthonormalized(stretched).value(), rotation), 1e-14);
  }
}

TEST(Orthonormalized, RefusesWhatIsNoRotation) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(orthonormalized({{1, 0, 0}, {0, 1, 0}, {0, 0, -1}}).error().code, ErrorCode::not_rigid);
  EXPECT_EQ(orthonormalized({{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}).error().code, ErrorCode::not_rigid);
  EXPECT_EQ(orthonormalized({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}).error().code, ErrorCode::not_rigid);
  EXPECT_EQ(orthonormalized({{1, 0, 0}, {0, nan, 0}, {0, 0, 1}}).error().code, ErrorCode::non_finite);
}

TEST(Matrix, GoesThereAndBackInBothOrders) {
  Rng rng(702);
  for (const MatrixOrder order : {MatrixOrder::row_major, MatrixOrder::column_major}) {
    const Transform pose = random_pose(rng, 5);
    EXPECT_EQ(transform_from_matrix(matrix_of(pose, order), order).value(), pose);
  }
  const Transform pose{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {5, 6, 7}};
  EXPECT_EQ(matrix_of(pose, MatrixOrder::row_major),
            (std::array<double, 16>{0, -1, 0, 5, 1, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1}));
  EXPECT_EQ(matrix_of(pose, MatrixOrder::column_major),
            (std::array<double, 16>{0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 6, 7, 1}));
}

TEST(Matrix, ThatIsNoRigidMotionIsRefused) {
  const auto code_of = [](std::size_t entry, double value) {
    std::array<double, 16> matrix = matrix_of({}, MatrixOrder::row_major);
    matrix[entry] = value;
    return transform_from_matrix(matrix, MatrixOrder::row_major).error().code;
  };
  EXPECT_EQ(code_of(0, 1.001), ErrorCode::not_rigid);
  EXPECT_EQ(code_of(12, 1), ErrorCode::not_rigid);
  EXPECT_EQ(code_of(15, 2), ErrorCode::not_rigid);
  EXPECT_EQ(code_of(3, 0x1p201), ErrorCode::too_large);
  EXPECT_EQ(code_of(7, std::numeric_limits<double>::infinity()), ErrorCode::non_finite);
  EXPECT_EQ(code_of(13, std::numeric_limits<double>::quiet_NaN()), ErrorCode::non_finite);
}

}  // namespace
}  // namespace limber::testing

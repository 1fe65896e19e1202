// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
// Poses and positions as matrices, of the library and of Eigen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "geometry/rigid.h"
#include "limber/eigen.h"
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
    ASSERT_LE(largest_difference(transpose(mended) * mended, {}), 1e-14);
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
  for (const double scale : {-1.0, 0.0, 2.0}) {
    EXPECT_EQ(orthonormalized({{1, 0, 0}, {0, 1, 0}, {0, 0, scale}}).error().code, ErrorCode::not_rigid) << scale;
  }
  EXPECT_EQ(orthonormalized({{1, 0, 0}, {0, NAN, 0}, {0, 0, 1}}).error().code, ErrorCode::non_finite);
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

// --- Eigen ---

template <typename Scalar>
using ByRows = Eigen::Matrix<Scalar, Eigen::Dynamic, 3, Eigen::RowMajor>;

TEST(EigenConversion, TransformsMovePointsAlike) {
  Rng rng(710);
  for (int i = 0; i < 100; ++i) {
    const Transform pose{scenes::random_rotation(rng), uniform_point(rng, -5, 5)};
    const Vec3 p = uniform_point(rng, -5, 5);
    const Eigen::Isometry3d isometry = eigen_isometry(pose);
    const Eigen::Vector4d homogeneous = eigen_matrix(pose) * eigen_vector(p).homogeneous();
    ASSERT_LE(max_abs(vec3_from_eigen(isometry * eigen_vector(p)) - pose(p)), 1e-14);
    ASSERT_LE(max_abs(vec3_from_eigen(homogeneous.head<3>()) - pose(p)), 1e-14);
    ASSERT_EQ(transform_from_eigen(isometry).value(), pose);
    ASSERT_EQ(transform_from_eigen(eigen_matrix(pose)).value(), pose);
  }
}

TEST(EigenConversion, TakesAQuarterTurnFromEigen) {
  Eigen::Isometry3d quarter(Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()));
  quarter.pretranslate(Eigen::Vector3d(0, 0, 7));
  EXPECT_LE(max_abs(transform_from_eigen(quarter).value()({1, 0, 0}) - Vec3{0, 1, 7}), 1e-15);
  quarter.linear() *= 2;
  EXPECT_EQ(transform_from_eigen(quarter).error().code, ErrorCode::not_rigid);
}

TEST(EigenConversion, PositionsAreReadWhereTheyAreByRowsOrByColumnsAlsoOfAPart) {
  Eigen::Matrix3Xf columns(3, 4);
  columns << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  ByRows<float> rows = columns.transpose();
  const PositionsView from_columns = positions_from_eigen(columns), from_rows = positions_from_eigen(rows);
  ASSERT_EQ(from_columns.size(), 4U);
  ASSERT_EQ(from_rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(from_columns[i], from_rows[i]);
  EXPECT_EQ(from_columns[3], (Vec3{4, 8, 12}));
  rows(3, 2) = 9;
  EXPECT_EQ(from_rows[3], (Vec3{4, 8, 9}));
  // Three of eight doubles a vertex, the first of four vertices left out.
  Eigen::Matrix<double, 4, 8, Eigen::RowMajor> vertices;
  for (int i = 0; i < vertices.size(); ++i) vertices.data()[i] = i;
  const PositionsView view = positions_from_eigen(vertices.block<3, 3>(1, 4));
  ASSERT_EQ(view.size(), 3U);
  EXPECT_EQ(view[2], (Vec3{28, 29, 30}));
  EXPECT_EQ(positions_from_eigen(Eigen::Matrix3Xd(3, 0)).size(), 0U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/eigen.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/random_geometry.h"

namespace limber::testing {
namespace {

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

TEST(EigenConversion, PositionsAreReadWhereTheyAre) {
  ByRows<double> rows(2, 3);
  rows << 1, 2, 3, 4, 5, 6;
  const PositionsView view = positions_from_eigen(rows);
  ASSERT_EQ(view.size(), 2U);
  EXPECT_EQ(view[1], (Vec3{4, 5, 6}));
  rows(1, 2) = 9;
  EXPECT_EQ(view[1], (Vec3{4, 5, 9}));
}

TEST(EigenConversion, PositionsComeByRowsOrByColumns) {
  Eigen::Matrix3Xf columns(3, 4);
  columns << 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12;
  const ByRows<float> rows = columns.transpose();
  const PositionsView from_columns = positions_from_eigen(columns), from_rows = positions_from_eigen(rows);
  ASSERT_EQ(from_columns.size(), 4U);
  ASSERT_EQ(from_rows.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(from_columns[i], from_rows[i]);
  EXPECT_EQ(from_columns[3], (Vec3{4, 8, 12}));
}

TEST(EigenConversion, PositionsMayBeAPartOfALargerMatrix) {
  // Three of eight floats a vertex, the first of four vertices left out.
  Eigen::Matrix<float, 4, 8, Eigen::RowMajor> vertices;
  for (int i = 0; i < vertices.size(); ++i) vertices.data()[i] = static_cast<float>(i);
  const PositionsView view = positions_from_eigen(vertices.block<3, 3>(1, 4));
  ASSERT_EQ(view.size(), 3U);
  EXPECT_EQ(view[2], (Vec3{28, 29, 30}));
  EXPECT_EQ(positions_from_eigen(Eigen::Matrix3Xd(3, 0)).size(), 0U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <type_traits>

#include "limber/base.h"
#include "limber/math.h"
#include "limber/mesh.h"

/// Conversions from and to Eigen. The library itself does not need Eigen, so limber.h does not include this header.
namespace limber {

inline Vec3 vec3_from_eigen(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }
inline Eigen::Vector3d eigen_vector(const Vec3& v) { return {v.x, v.y, v.z}; }

/// The transform that a homogeneous matrix stands for, or an isometry.
///
/// Errors   As transform_from_matrix(): also isometries may hold what is no rigid motion.
inline Result<Transform> transform_from_eigen(const Eigen::Matrix4d& matrix) {
  return transform_from_matrix(std::span<const double, 16>(matrix.data(), 16), MatrixOrder::column_major);
}
inline Result<Transform> transform_from_eigen(const Eigen::Isometry3d& isometry) {
  return transform_from_eigen(isometry.matrix());
}

/// The homogeneous matrix of a transform.
inline Eigen::Matrix4d eigen_matrix(const Transform& transform) {
  return Eigen::Matrix4d(matrix_of(transform, MatrixOrder::column_major).data());
}
inline Eigen::Isometry3d eigen_isometry(const Transform& transform) {
  return Eigen::Isometry3d(eigen_matrix(transform));
}

/// The positions in a matrix of float or double that keeps the coordinates of a vertex side by side.
///
/// Shape    n x 3 stored by rows, or 3 x n stored by columns, which is Eigen's default; maps and blocks of such
///          matrices too. Others do not compile.
/// Alias    Reads where `matrix` stores its coefficients, and lasts as long as they do.
template <typename Derived>
PositionsView positions_from_eigen(const Eigen::MatrixBase<Derived>& matrix) {
  using Scalar = typename Derived::Scalar;
  constexpr bool by_rows = Derived::IsRowMajor;
  static_assert(std::is_same_v<Scalar, float> || std::is_same_v<Scalar, double>, "coordinates are float or double");
  static_assert((int(Derived::Flags) & int(Eigen::DirectAccessBit)) != 0, "an expression has to be evaluated first");
  static_assert(int(by_rows ? Derived::ColsAtCompileTime : Derived::RowsAtCompileTime) == 3 &&
                    int(Derived::InnerStrideAtCompileTime) == 1,
                "the three coordinates of a vertex must lie side by side: n x 3 by rows, or 3 x n by columns");
  const auto count = static_cast<std::size_t>(by_rows ? matrix.rows() : matrix.cols());
  return PositionsView::strided(matrix.derived().data(), count,
                                static_cast<std::size_t>(matrix.outerStride()) * sizeof(Scalar));
}

}  // namespace limber

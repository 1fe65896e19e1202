// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "limber/base.h"

/// Vectors, matrices and rigid transforms in float64.
namespace limber {

/// Largest magnitude of a coordinate; larger ones are refused.
inline constexpr double max_coordinate = 0x1p200;

struct Vec3 {
  double x = 0, y = 0, z = 0;

  constexpr double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }

  constexpr Vec3& operator+=(const Vec3& v) { return *this = {x + v.x, y + v.y, z + v.z}; }
  constexpr Vec3& operator-=(const Vec3& v) { return *this = {x - v.x, y - v.y, z - v.z}; }
  constexpr Vec3& operator*=(double s) { return *this = {x * s, y * s, z * s}; }
  constexpr bool operator==(const Vec3&) const = default;
};

constexpr Vec3 operator+(Vec3 a, const Vec3& b) { return a += b; }
constexpr Vec3 operator-(Vec3 a, const Vec3& b) { return a -= b; }
constexpr Vec3 operator-(const Vec3& v) { return {-v.x, -v.y, -v.z}; }
constexpr Vec3 operator*(Vec3 v, double s) { return v *= s; }
constexpr Vec3 operator*(double s, Vec3 v) { return v *= s; }

[[nodiscard]] constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
[[nodiscard]] constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
[[nodiscard]] constexpr double length_sq(const Vec3& v) { return dot(v, v); }
[[nodiscard]] inline double length(const Vec3& v) { return std::sqrt(length_sq(v)); }

[[nodiscard]] constexpr Vec3(min)(const Vec3& a, const Vec3& b) {
  return {a.x < b.x ? a.x : b.x, a.y < b.y ? a.y : b.y, a.z < b.z ? a.z : b.z};
}
[[nodiscard]] constexpr Vec3(max)(const Vec3& a, const Vec3& b) {
  return {a.x > b.x ? a.x : b.x, a.y > b.y ? a.y : b.y, a.z > b.z ? a.z : b.z};
}
[[nodiscard]] inline Vec3 abs(const Vec3& v) { return {std::abs(v.x), std::abs(v.y), std::abs(v.z)}; }
[[nodiscard]] inline double max_abs(const Vec3& v) {
  const Vec3 a = abs(v);
  return a.x > a.y ? (a.x > a.z ? a.x : a.z) : (a.y > a.z ? a.y : a.z);
}
[[nodiscard]] inline bool is_finite(const Vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// A 3 x 3 matrix by rows.
struct Mat3 {
  Vec3 row0{1, 0, 0}, row1{0, 1, 0}, row2{0, 0, 1};
  constexpr bool operator==(const Mat3&) const = default;
};

constexpr Vec3 operator*(const Mat3& m, const Vec3& v) { return {dot(m.row0, v), dot(m.row1, v), dot(m.row2, v)}; }
[[nodiscard]] constexpr Mat3 transpose(const Mat3& m) {
  return {{m.row0.x, m.row1.x, m.row2.x}, {m.row0.y, m.row1.y, m.row2.y}, {m.row0.z, m.row1.z, m.row2.z}};
}
constexpr Mat3 operator*(const Mat3& a, const Mat3& b) {
  const Mat3 columns = transpose(b);
  return {columns * a.row0, columns * a.row1, columns * a.row2};
}

/// A rigid motion: p_a = a_from_b(p_b) turns by `rotation`, then shifts by `translation`.
///
/// Unit     The translation is in the mesh's length unit.
/// Throws   Queries throw std::invalid_argument where `is_rigid()` does not hold. Reflections are not rigid motions; a
///          rotation computed in float32 is not orthonormal enough.
struct Transform {
  Mat3 rotation;
  Vec3 translation;

  constexpr Vec3 operator()(const Vec3& p) const { return rotation * p + translation; }
  constexpr bool operator==(const Transform&) const = default;
};

/// (a_from_b * b_from_c)(p_c) is a_from_b(b_from_c(p_c)), up to rounding.
constexpr Transform operator*(const Transform& a_from_b, const Transform& b_from_c) {
  return {a_from_b.rotation * b_from_c.rotation, a_from_b(b_from_c.translation)};
}
[[nodiscard]] constexpr Transform inverse(const Transform& a_from_b) {
  const Mat3 turned_back = transpose(a_from_b.rotation);
  return {turned_back, -(turned_back * a_from_b.translation)};
}

/// True when the translation is finite and not above `max_coordinate`, two rows of the rotation are orthonormal to 1e-9
/// and the third is their cross product to 1e-9: no reflection, nothing that is not a number.
[[nodiscard]] LIMBER_API bool is_rigid(const Transform& transform);

/// The rotation nearest to a matrix that is nearly one, such as a rotation computed in float32: its rows are
/// orthonormal to rounding.
///
/// Errors   `non_finite`; `not_rigid` if the matrix is a reflection, or further than 0.1 from every rotation.
/// Cost     Some 100 ns.
/// Source   The polar decomposition by Newton's iteration [Higham1986].
LIMBER_API Result<Mat3> orthonormalized(const Mat3& matrix);

/// How the 16 numbers of a 4 x 4 matrix are stored.
enum class MatrixOrder {
  row_major,     ///< row by row, as in C, NumPy and ROS
  column_major,  ///< column by column, as in Eigen's default and OpenGL
};

/// The rigid motion that a homogeneous 4 x 4 matrix stands for.
///
/// Errors   `non_finite`, `too_large`; `not_rigid` unless is_rigid() holds and the last row is 0 0 0 1.
LIMBER_API Result<Transform> transform_from_matrix(std::span<const double, 16> matrix, MatrixOrder order);

/// The homogeneous 4 x 4 matrix of a transform.
[[nodiscard]] LIMBER_API std::array<double, 16> matrix_of(const Transform& transform, MatrixOrder order);

/// The transform that turns by the quaternion (qw, qx, qy, qz) and then shifts by `translation`.
///
/// The quaternion is normalised, so any length but zero will do.
/// Errors   `non_finite` when an input is not finite or the quaternion is zero, which has no direction;
///          `too_large` when the translation is above `max_coordinate`.
LIMBER_API Result<Transform> transform_from_quaternion(const Vec3& translation, double qw, double qx, double qy,
                                                       double qz);

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/rigid.h"
#include "limber/math.h"

namespace limber {
namespace {

/// Absolute row sums of R^T R - I; the largest bounds how far R is from orthonormal.
Vec3 orthonormality_errors(const Mat3& rotation) {
  const Mat3 columns = transpose(rotation);
  const Vec3 &x = columns.row0, &y = columns.row1, &z = columns.row2;
  const double xy = std::abs(dot(x, y)), yz = std::abs(dot(y, z)), zx = std::abs(dot(z, x));
  return {std::abs(dot(x, x) - 1) + xy + zx, std::abs(dot(y, y) - 1) + xy + yz, std::abs(dot(z, z) - 1) + yz + zx};
}

/// In six digits.
std::string text_of(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.begin(), text.end(), number, std::chars_format::general, 6);
  return {text.begin(), end};
}

}  // namespace

std::string geometry::why_not_rigid(const Transform& transform) {
  const Mat3& r = transform.rotation;
  const std::string no = "is not rigid: ";
  if (!is_finite(r.row0) || !is_finite(r.row1) || !is_finite(r.row2) || !is_finite(transform.translation)) {
    return no + "an entry is not finite";
  }
  if (!(max_abs(transform.translation) <= max_coordinate)) return no + "its translation is too large";
  constexpr double rounded = 1e-4;  // what float32 leaves of a rotation that was chained a thousand times
  const double error = max_abs(orthonormality_errors(r));
  const bool mirrors = dot(cross(r.row0, r.row1), r.row2) < 0;
  if (error < rounded && !mirrors) {
    return no + "its rotation is off by " + text_of(error) + ", and 1e-9 is allowed; orthonormalized() mends that";
  }
  const Mat3 columns = transpose(r);
  const Vec3 scale{length(columns.row0), length(columns.row1), length(columns.row2)};
  const auto is_uniform = [](const Vec3& s) { return max_abs(s - Vec3{s.x, s.x, s.x}) <= rounded * s.x; };
  std::string what = mirrors ? "it mirrors" : "it shears";
  if (max_abs(scale - Vec3{1, 1, 1}) >= rounded) {
    what = "it scales by " + text_of(scale.x);
    if (!is_uniform(scale)) what += ", " + text_of(scale.y) + " and " + text_of(scale.z) + " along x, y and z";
    if (mirrors) what += ", and mirrors";
  }
  return no + what + "; that belongs into the vertices";
}

void geometry::throw_not_rigid(const Transform& transform, const std::string& name) {
  base::throw_invalid_argument((name + ' ' + why_not_rigid(transform)).c_str());
}

bool is_rigid(const Transform& transform) {
  const base::DefaultFloatEnvironment environment;
  return environment.computed_before_restore(geometry::is_rigid(transform));
}

Result<Mat3> orthonormalized(const Mat3& matrix) {
  const base::DefaultFloatEnvironment environment;
  if (!is_finite(matrix.row0) || !is_finite(matrix.row1) || !is_finite(matrix.row2)) {
    return Error{ErrorCode::non_finite, "an entry of the matrix is not finite", {}};
  }
  // Far from a rotation the iteration would converge as well, but what is meant is a mistake.
  constexpr double tolerance = 0.1;
  const Vec3 errors = orthonormality_errors(matrix);
  if (!(max_abs(errors) <= tolerance) || dot(cross(matrix.row0, matrix.row1), matrix.row2) < 0) {
    return Error{ErrorCode::not_rigid, "the matrix is not near a rotation", {}};
  }
  // Quadratic convergence: from 0.1 five steps reach rounding.
  constexpr int steps = 6;
  Mat3 r = matrix;
  for (int i = 0; i < steps; ++i) {
    // The inverse transposed has the cofactors over the determinant.
    const Vec3 c0 = cross(r.row1, r.row2), c1 = cross(r.row2, r.row0), c2 = cross(r.row0, r.row1);
    const double half_inverse = 0.5 / dot(r.row0, c0);
    r = {0.5 * r.row0 + half_inverse * c0, 0.5 * r.row1 + half_inverse * c1, 0.5 * r.row2 + half_inverse * c2};
  }
  return r;
}

Result<Transform> transform_from_matrix(std::span<const double, 16> matrix, MatrixOrder order) {
  const base::DefaultFloatEnvironment environment;
  const auto at = [&](std::size_t row, std::size_t column) {
    return matrix[order == MatrixOrder::row_major ? 4 * row + column : 4 * column + row];
  };
  const auto row = [&](std::size_t r) { return Vec3{at(r, 0), at(r, 1), at(r, 2)}; };
  const Transform transform{{row(0), row(1), row(2)}, {at(0, 3), at(1, 3), at(2, 3)}};
  for (const double x : matrix) {
    if (!std::isfinite(x)) return Error{ErrorCode::non_finite, "an entry of the matrix is not finite", {}};
  }
  if (max_abs(transform.translation) > max_coordinate) {
    return Error{ErrorCode::too_large, "the translation is too large", {}};
  }
  if (row(3) != Vec3{} || at(3, 3) != 1) {
    return Error{ErrorCode::not_rigid, "the last row of the matrix is not 0 0 0 1", {}};
  }
  if (!geometry::is_rigid(transform)) {
    return Error{ErrorCode::not_rigid, "the matrix " + geometry::why_not_rigid(transform), {}};
  }
  return transform;
}

std::array<double, 16> matrix_of(const Transform& transform, MatrixOrder order) {
  const Mat3 &r = transform.rotation, c = transpose(r);
  const Vec3& t = transform.translation;
  if (order == MatrixOrder::row_major) {
    return {r.row0.x, r.row0.y, r.row0.z, t.x, r.row1.x, r.row1.y, r.row1.z, t.y,
            r.row2.x, r.row2.y, r.row2.z, t.z, 0,        0,        0,        1};
  }
  return {c.row0.x, c.row0.y, c.row0.z, 0, c.row1.x, c.row1.y, c.row1.z, 0,
          c.row2.x, c.row2.y, c.row2.z, 0, t.x,      t.y,      t.z,      1};
}

Result<Transform> transform_from_quaternion(const Vec3& translation, double qw, double qx, double qy, double qz) {
  const base::DefaultFloatEnvironment environment;
  if (!is_finite(translation)) return Error{ErrorCode::non_finite, "the translation is not finite", {}};
  if (max_abs(translation) > max_coordinate) return Error{ErrorCode::too_large, "the translation is too large", {}};
  const double largest = std::max({std::abs(qw), std::abs(qx), std::abs(qy), std::abs(qz)});
  if (!std::isfinite(qw) || !std::isfinite(qx) || !std::isfinite(qy) || !std::isfinite(qz) || largest == 0) {
    return Error{ErrorCode::non_finite, "the quaternion is not finite or is zero", {}};
  }
  // Scaled by its largest entry first, so that neither tiny nor huge quaternions lose their direction.
  double w = qw / largest, x = qx / largest, y = qy / largest, z = qz / largest;
  const double norm = std::sqrt(w * w + x * x + y * y + z * z);
  w /= norm, x /= norm, y /= norm, z /= norm;
  const Mat3 rotation{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                      {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                      {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  LIMBER_ASSERT(geometry::is_rigid({rotation, translation}));
  return Transform{rotation, translation};
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "limber/math.h"

namespace limber {
namespace {

// Entries of R^T R - I, the largest absolute row sum: bounds how far R is from orthonormal.
double orthonormality_error(const Mat3& rotation) {
  const Mat3 gram = transpose(rotation) * rotation;
  const Vec3 row0 = abs(gram.row0 - Vec3{1, 0, 0});
  const Vec3 row1 = abs(gram.row1 - Vec3{0, 1, 0});
  const Vec3 row2 = abs(gram.row2 - Vec3{0, 0, 1});
  return std::max({row0.x + row0.y + row0.z, row1.x + row1.y + row1.z, row2.x + row2.y + row2.z});
}

}  // namespace

double max_stretch(const Mat3& rotation) {
  // |R v|^2 = v.v + v.(R^T R - I) v <= (1 + e) |v|^2; the last term covers the rounding of e itself.
  return std::sqrt(1 + orthonormality_error(rotation)) + 0x1p-48;
}

bool is_rigid(const Transform& transform) {
  const Mat3& r = transform.rotation;
  if (!is_finite(r.row0) || !is_finite(r.row1) || !is_finite(r.row2)) return false;
  if (!is_finite(transform.translation) || max_abs(transform.translation) > max_coordinate) return false;
  constexpr double tolerance = 1e-9;  // a rotation stored as float32 fails, one chained a million times passes
  return orthonormality_error(r) <= tolerance && dot(cross(r.row0, r.row1), r.row2) > 0;
}

Result<Transform> transform_from_quaternion(const Vec3& translation, double qw, double qx, double qy, double qz) {
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
  LIMBER_ASSERT(is_rigid({rotation, translation}));
  return Transform{rotation, translation};
}

}  // namespace limber

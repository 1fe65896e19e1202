// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/float_environment.h"
#include "limber/math.h"
#include "math/rigid.h"

namespace limber {
namespace {

/// Absolute row sums of R^T R - I; the largest bounds how far R is from orthonormal.
Vec3 orthonormality_errors(const Mat3& rotation) {
  const Mat3 columns = transpose(rotation);
  const Vec3 &x = columns.row0, &y = columns.row1, &z = columns.row2;
  const double xy = std::abs(dot(x, y)), yz = std::abs(dot(y, z)), zx = std::abs(dot(z, x));
  return {std::abs(dot(x, x) - 1) + xy + zx, std::abs(dot(y, y) - 1) + xy + yz, std::abs(dot(z, z) - 1) + yz + zx};
}

}  // namespace

double max_stretch(const Mat3& rotation) {
  const core::DefaultFloatEnvironment environment;
  // |R v|^2 = v.v + v.(R^T R - I) v <= (1 + e) |v|^2; the last term covers the rounding of e itself.
  return std::sqrt(1 + max_abs(orthonormality_errors(rotation))) + 0x1p-48;
}

bool is_rigid(const Transform& transform) {
  const core::DefaultFloatEnvironment environment;
  return math::is_rigid(transform);
}

Result<Transform> transform_from_quaternion(const Vec3& translation, double qw, double qx, double qy, double qz) {
  const core::DefaultFloatEnvironment environment;
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
  LIMBER_ASSERT(math::is_rigid({rotation, translation}));
  return Transform{rotation, translation};
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/math.h"

namespace limber::math {

/// limber::is_rigid() for callers that are in the default floating-point environment already.
inline bool is_rigid(const Transform& transform) {
  const Mat3& r = transform.rotation;
  constexpr double tolerance = 1e-9;  // a rotation stored as float32 fails, one chained a million times passes
  // False for NaN.
  const auto is_at_most = [](const Vec3& v, double limit) { return v.x <= limit && v.y <= limit && v.z <= limit; };
  // Two orthonormal rows, of which the third is the cross product: then the third is normal to both, of length 1, and
  // the determinant is positive.
  const Vec3 errors{std::abs(length_sq(r.row0) - 1), std::abs(length_sq(r.row1) - 1), std::abs(dot(r.row0, r.row1))};
  return is_at_most(errors, tolerance) && is_at_most(abs(cross(r.row0, r.row1) - r.row2), tolerance) &&
         is_at_most(abs(transform.translation), max_coordinate);
}

}  // namespace limber::math

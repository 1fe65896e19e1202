// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "limber/math.h"

namespace limber::geometry {

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

/// What keeps a transform from being rigid, as a sentence goes on after its name: "is not rigid: it scales by 1.1".
/// Pre: is_rigid() does not hold.
std::string why_not_rigid(const Transform& transform);

/// Throws std::invalid_argument, which says why a transform, which is called `name`, is not rigid.
[[noreturn]] void throw_not_rigid(const Transform& transform, const std::string& name);
inline void require_rigid(const Transform& transform, const char* name) {
  if (!geometry::is_rigid(transform)) throw_not_rigid(transform, name);
}

/// The inverse of a matrix that is nearly a rotation; unlike the transpose, as exact as float64 allows.
inline Mat3 inverse_of(const Mat3& m) {
  const Vec3 c0 = cross(m.row1, m.row2), c1 = cross(m.row2, m.row0), c2 = cross(m.row0, m.row1);
  const double scale = 1 / dot(m.row0, c0);
  return transpose({c0 * scale, c1 * scale, c2 * scale});
}

}  // namespace limber::geometry

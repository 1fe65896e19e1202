// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <tuple>

#include "geometry/primitives.h"

/// Exact decisions about points on one line.
namespace limber::geometry {

/// Lexicographic order of coordinates. Points on a line are in this order along the line, in one of its two directions.
inline bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// A coordinate axis along which the projection of three points has a non-zero area; none if and only if the points are
/// collinear. The projection along that axis maps their plane one to one, so it shows areas of other points of it too.
inline std::optional<std::size_t> faithful_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (geometry::orient2d(a, b, c, axis) != 0) return axis;
  }
  return {};
}

inline bool are_collinear(const Vec3& a, const Vec3& b, const Vec3& c) { return !faithful_axis(a, b, c); }

}  // namespace limber::geometry

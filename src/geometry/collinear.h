// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <tuple>

#include "geometry/primitives.h"

/// What exact decisions about points on one line need.
namespace limber::geometry {

/// Points on a line are in this order along it, or in the reverse.
inline bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

/// An axis along which the three points keep a non-zero area, if they are not collinear.
inline std::optional<std::size_t> faithful_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (geometry::orient2d(a, b, c, axis) != 0) return axis;
  }
  return {};
}

}  // namespace limber::geometry

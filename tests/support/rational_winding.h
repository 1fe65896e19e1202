// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <vector>

#include "support/rational_distance.h"

/// Winding numbers of closed surfaces in rational arithmetic, by another route than the library's: a ray in a direction
/// of no axis, and another one where that meets an edge.
namespace limber::testing {

inline Rational volume(const RationalVec& a, const RationalVec& b, const RationalVec& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/// Along one ray; nothing where the ray meets an edge, or the line it lies on does.
inline std::optional<int> winding_along_ray(const std::vector<Triangle>& triangles, const Vec3& point,
                                            const Vec3& direction) {
  const RationalVec p = rational(point), d = rational(direction);
  int winding_number = 0;
  for (const Triangle& t : triangles) {
    const RationalVec a = minus(rational(t.v0), p), b = minus(rational(t.v1), p), c = minus(rational(t.v2), p);
    const int ab = sgn(volume(d, a, b)), bc = sgn(volume(d, b, c)), ca = sgn(volume(d, c, a));
    if (ab * bc < 0 || bc * ca < 0 || ca * ab < 0) continue;
    if (ab == 0 || bc == 0 || ca == 0) return std::nullopt;
    // d passes through the triangle where the origin sees its back, and -d where it sees its front.
    const int back = sgn(volume(a, b, c));
    if (back == ab) winding_number += ab;
  }
  return winding_number;
}

/// Pre: the point is not on the surface.
inline int rational_winding(const std::vector<Triangle>& triangles, const Vec3& point) {
  for (double x = 1;; x += 1) {
    const std::optional<int> found = winding_along_ray(triangles, point, {x, 1 / (x + 0.37), 0.71 / x});
    if (found) return *found;
  }
}

}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "limber/geometry.h"

/// Exact decisions about a point and a surface of triangles. Pre: as geometry/primitives.h.
namespace limber::geometry {

/// Whether a closed triangle, which may be degenerate, contains a point.
bool lies_on(const Vec3& point, const Triangle& triangle);

/// What a triangle adds to the winding number of a closed surface around a point, counted along the ray from the point
/// in the direction of an axis: +1 where the ray leaves, on the side that the normal points to, -1 where it enters, 0
/// where it misses.
///
/// Based on  Simulation of simplicity [EdelsbrunnerMuecke1990]: the ray is moved aside by an infinitesimal amount, the
///           same for all triangles, so it never meets an edge or a corner.
///
/// Pre      The point does not lie on the triangle.
int winding_along(const Vec3& point, const Triangle& triangle, std::size_t axis, bool is_upward);

/// half_solid_angle(), given the corners as seen from the point, where squares of lengths may vanish. Only directions
/// count, so each is scaled on its own.
double half_solid_angle_next_to_a_corner(const Vec3& a, const Vec3& b, const Vec3& c);

/// Half of the solid angle under which a point sees a triangle, positive where it sees the back: from -pi to pi, at any
/// scale. 0 where the triangle is degenerate or has the point as a corner.
///
/// Source   [VanOosteromStrackee1983].
inline double half_solid_angle(const Vec3& point, const Triangle& t) {
  const Vec3 a = t.v0 - point, b = t.v1 - point, c = t.v2 - point;
  const double aa = length_sq(a), bb = length_sq(b), cc = length_sq(c);
  if (std::min({aa, bb, cc}) < 0x1p-600) return half_solid_angle_next_to_a_corner(a, b, c);
  const double la = std::sqrt(aa), lb = std::sqrt(bb), lc = std::sqrt(cc);
  const double along = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
  return std::atan2(dot(a, cross(b, c)), along);
}

}  // namespace limber::geometry

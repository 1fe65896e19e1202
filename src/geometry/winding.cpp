// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "geometry/winding.h"

#include "base/check.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

int sign_of(double x) { return x > 0 ? 1 : x < 0 ? -1 : 0; }

/// On which side of the line from a to b the point lies, seen along `axis`: +1 to the left. The point is moved by an
/// infinitesimal amount along the first axis that is left, and by a much smaller one along the second. 0 only where a
/// and b are one point, seen so.
int side_of(const Vec3& a, const Vec3& b, const Vec3& point, std::size_t axis) {
  const int side = geometry::orient2d(a, b, point, axis);
  if (side != 0) return side;
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  return a[j] != b[j] ? sign_of(a[j] - b[j]) : sign_of(b[i] - a[i]);
}

}  // namespace

bool geometry::lies_on(const Vec3& point, const Triangle& t) {
  const Vec3 low = min(min(t.v0, t.v1), t.v2), high = max(max(t.v0, t.v1), t.v2);
  if (min(low, point) != low || max(high, point) != high) return false;
  return geometry::orient3d(t.v0, t.v1, t.v2, point) == 0 && geometry::intersects(Segment{point, point}, t);
}

int geometry::winding_along(const Vec3& point, const Triangle& t, std::size_t axis, bool is_upward) {
  LIMBER_ASSERT(axis < 3);
  const int turn = side_of(t.v0, t.v1, point, axis);
  if (turn == 0 || side_of(t.v1, t.v2, point, axis) != turn || side_of(t.v2, t.v0, point, axis) != turn) return 0;
  // The normal points up where the corners turn left.
  const bool is_above = geometry::orient3d(t.v0, t.v1, t.v2, point) == turn;
  if (is_above == is_upward) return 0;
  return is_upward ? turn : -turn;
}

double geometry::half_solid_angle_next_to_a_corner(const Vec3& a, const Vec3& b, const Vec3& c) {
  if (max_abs(a) == 0 || max_abs(b) == 0 || max_abs(c) == 0) return 0;
  return half_solid_angle({}, {near_unit(a), near_unit(b), near_unit(c)});
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/check.h"
#include "limber/geometry.h"

// Based on  the clamped closest-point iteration of [Ericson2005], section 5.1.9.
// Differs   The first parameter comes from cross products, not from the 2 x 2 system: its denominator a e - b^2 loses
//           all digits for nearly parallel segments, the squared cross product does not
//           (docs/algorithms/triangle_distance.md). Each parameter is re-optimised for the other at the end, so errors
//           in the first only matter to second order.
namespace limber::geometry {

/// Parameters in [0, 1] of the closest points p0 + s (p1 - p0) of two segments.
struct SegmentParameters {
  double s, t;
};

/// numerator / denominator clamped to [0, 1]; 0 when the denominator is 0 or the quotient is not a number.
inline double clamped_quotient(double numerator, double denominator) {
  if (!(denominator > 0) || !(numerator > 0)) return 0;
  return numerator >= denominator ? 1 : numerator / denominator;
}

/// Pre      Coordinates are at most 2^100 in size, so that fourth powers stay finite.
inline SegmentParameters closest_parameters(const Segment& a, const Segment& b) {
  LIMBER_ASSERT(max_abs(a.p0) <= 0x1p100 && max_abs(a.p1) <= 0x1p100);
  LIMBER_ASSERT(max_abs(b.p0) <= 0x1p100 && max_abs(b.p1) <= 0x1p100);
  const Vec3 d_a = a.p1 - a.p0, d_b = b.p1 - b.p0, w = b.p0 - a.p0;
  const Vec3 n = cross(d_a, d_b);
  const double along = dot(d_a, d_b);
  const double start = clamped_quotient(dot(cross(w, d_b), n), length_sq(n));
  const double t = clamped_quotient(start * along - dot(d_b, w), length_sq(d_b));
  const double s = clamped_quotient(t * along + dot(d_a, w), length_sq(d_a));
  return {s, t};
}

}  // namespace limber::geometry

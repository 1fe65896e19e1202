// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/primitives.h"
#include "limber/geometry.h"
#include "simd/kernels.h"

/// What distances of triangles and of points have in common: closest points of segments, and feet of points on a face.
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
///
/// Based on  the clamped closest-point iteration of [Ericson2005], section 5.1.9.
/// Differs   The first parameter comes from cross products, not from the 2 x 2 system: its denominator a e - b^2 loses
///           all digits for nearly parallel segments, the squared cross product does not
///           (docs/algorithms/triangle_distance.md). Each parameter is re-optimised for the other at the end, so errors
///           in the first only matter to second order.
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

/// A triangle prepared for projecting points on it. The foot of a point is its projection on the triangle's plane. Edge
/// i goes from corner i to the next; inward[i] is perpendicular to it and to the normal, and points to the third
/// corner. The vectors are not normalized.
///
/// Pre      Coordinates are at most 2^100 in size, so that fourth powers stay finite.
struct Face : simd::FaceVectors {
  Vec3 normal;

  explicit Face(const Triangle& t) {
    corner = t;
    edge = {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2};
    normal = cross(edge[0], edge[1]);
    for (std::size_t i = 0; i < 3; ++i) inward[i] = cross(normal, edge[i]);
  }

  /// The numbers that are to each other as the weights of the corners at the foot of p: for each corner twice the area
  /// between the foot and the opposite edge, times the length of the normal. A number is negative if and only if that
  /// edge separates the foot from the triangle.
  Vec3 areas(const Vec3& p) const {
    return {dot(inward[1], p - corner.v1), dot(inward[2], p - corner.v2), dot(inward[0], p - corner.v0)};
  }
  /// Whether the foot of a point is in the triangle, by its areas(). No if the triangle has no area.
  static bool are_inside(const Vec3& areas) {
    return areas.x >= 0 && areas.y >= 0 && areas.z >= 0 && areas.x + areas.y + areas.z > 0;
  }

  /// Sets `weights` to those of the foot of p if it is in the triangle. Returns false if it is not, or if the triangle
  /// has no area.
  bool foot(const Vec3& p, Vec3& weights) const {
    if (!are_inside(areas(p))) return false;
    weights = foot_weights(p);
    return true;
  }

  /// Weights of the foot of p: >= 0, together 1 up to rounding. Pre: the foot is in the triangle.
  ///
  /// The normal of a sliver is off by the roundoff over its smallest angle. So only the weight of v2, which is the
  /// foot's height over the edge from v0 to v1, comes from the normal. The error of that weight moves the foot
  /// perpendicular to the edge by no more than rounding does, but far in the direction of the edge. The place in that
  /// direction is therefore measured afterwards, by inner products with the edge; and once more for what is left of the
  /// vector.
  Vec3 foot_weights(const Vec3& p) const {
    constexpr double smallest = std::numeric_limits<double>::min();  // rounding may leave 0, or less
    const Vec3 to_p = p - corner.v0, to_v1 = edge[0], to_v2 = -edge[2];
    const double per_height = 1 / std::max(dot(inward[0], to_v2), smallest);
    const double per_length_sq = 1 / std::max(length_sq(to_v1), smallest);
    const double w2 = std::min(std::max(0.0, dot(inward[0], to_p) * per_height), 1.0);
    const Vec3 off = to_p - w2 * to_v2;
    const auto clamped = [&](double weight) { return std::min(std::max(0.0, weight), 1 - w2); };
    const double rough = clamped(dot(to_v1, off) * per_length_sq);
    const double w1 = clamped(rough + dot(to_v1, off - rough * to_v1) * per_length_sq);
    return {1 - w2 - w1, w1, w2};
  }
};

}  // namespace limber::geometry

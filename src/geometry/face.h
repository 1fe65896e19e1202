// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>

#include "geometry/primitives.h"
#include "simd/kernels.h"

namespace limber::geometry {

/// A triangle with what feet on it are computed from: projections of points that fall into it.
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

  /// Twice the areas between the foot of p and the edges, by opposite corner, times the length of the normal: negative
  /// where an edge separates the foot from the triangle.
  Vec3 areas(const Vec3& p) const {
    return {dot(inward[1], p - corner.v1), dot(inward[2], p - corner.v2), dot(inward[0], p - corner.v0)};
  }
  /// Whether such areas say that the foot falls into the triangle; no if the triangle has no area.
  static bool are_inside(const Vec3& areas) {
    return areas.x >= 0 && areas.y >= 0 && areas.z >= 0 && areas.x + areas.y + areas.z > 0;
  }

  /// Weights of the foot of p when it falls into the triangle; false when it does not or the triangle has no area.
  bool foot(const Vec3& p, Vec3& weights) const {
    if (!are_inside(areas(p))) return false;
    weights = foot_weights(p);
    return true;
  }

  /// Weights of the foot of p, which falls into the triangle: >= 0, together 1 up to rounding.
  ///
  /// The normal of a sliver is off by the roundoff over its smallest angle. So only the weight of v2, its height over
  /// the edge from v0 to v1, comes from the normal. What that weight is off by moves the foot across the edge by no
  /// more than rounding does, but far along it. The place along the edge is therefore measured afterwards, without the
  /// normal, and once more for what is left.
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

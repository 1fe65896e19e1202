// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Ericson2005], section 5.1.5: the signs of three areas say which edges separate a point from a triangle.
// Differs   An edge whose sign rounding could change counts as separating, and the face as well, so slivers need no
//           other path. The foot is rebuilt from the areas as weights and corrected, so it is on the triangle however
//           inaccurate the normal.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/segment_distance.h"

namespace limber {
namespace {

using geometry::after;

/// The closest point so far, relative to the point, and its weights.
struct Nearest {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vec3 position, weights;

  void consider(const Vec3& candidate, const Vec3& candidate_weights) {
    const double candidate_sq = length_sq(candidate);
    if (!(candidate_sq < distance_sq)) return;  // also when a hopeless sliver gives no number
    distance_sq = candidate_sq, position = candidate, weights = candidate_weights;
  }
};

/// The closest point of an edge to the origin. A corner is met exactly, so all triangles at a corner agree about it.
void consider_edge(const Triangle& corner, std::size_t i, const Vec3& edge, Nearest& nearest) {
  const double t = geometry::clamped_quotient(-dot(edge, corner[i]), length_sq(edge));
  Vec3 weights;
  weights[i] = 1 - t, weights[after[i]] = t;
  nearest.consider(t == 1 ? corner[after[i]] : corner[i] + t * edge, weights);
}

/// The foot of the origin, whose areas with the edges are `area`, by corner. Pre: none is negative, not all are 0.
void consider_foot(const Triangle& corner, const Vec3 (&inward)[3], const Vec3& area, Nearest& nearest) {
  const double per_area = 1 / (area.x + area.y + area.z);
  Vec3 weights = max(area * per_area, Vec3{});  // no -0
  Vec3 foot = geometry::point_at(corner, weights);
  // The normal of a sliver is off by the roundoff over its smallest angle. What that costs the foot is measured and
  // taken back, each time by the same factor.
  constexpr int most_corrections = 30;
  constexpr double enough = 0x1p-52;  // of a weight
  for (int i = 0; i < most_corrections; ++i) {
    const Vec3 change = Vec3{dot(inward[1], foot), dot(inward[2], foot), dot(inward[0], foot)} * per_area;
    if (max_abs(change) <= enough) break;
    const Vec3 better = max(weights - change, Vec3{});
    const Vec3 normalized = better * (1 / (better.x + better.y + better.z));
    const Vec3 better_foot = geometry::point_at(corner, normalized);
    if (!(length_sq(better_foot) < length_sq(foot))) break;
    weights = normalized, foot = better_foot;
  }
  nearest.consider(foot, weights);
}

}  // namespace

geometry::PointOnTriangle geometry::closest_on(const Triangle& triangle, const Vec3& point) {
  LIMBER_ASSERT(is_finite(point) && is_finite(triangle.v0) && is_finite(triangle.v1) && is_finite(triangle.v2));
  const LocalFrame frame(point, {triangle.v0, triangle.v1, triangle.v2});
  const Triangle corner = frame.to_local(triangle);
  const Vec3 edge[3] = {corner.v1 - corner.v0, corner.v2 - corner.v1, corner.v0 - corner.v2};
  const Vec3 normal = cross(edge[0], edge[1]);
  const Vec3 inward[3] = {cross(normal, edge[0]), cross(normal, edge[1]), cross(normal, edge[2])};
  const Vec3 area{-dot(inward[1], corner.v1), -dot(inward[2], corner.v2), -dot(inward[0], corner.v0)};
  // Each is off by less than 80 u times the cube of the longest edge and the extent; or underflows.
  const double longest = max_abs(max(max(abs(edge[0]), abs(edge[1])), abs(edge[2])));
  const double error = 0x1p-46 * longest * longest * longest * frame.extent() + 0x1p-960;
  Nearest nearest;
  if (area.x >= 0 && area.y >= 0 && area.z >= 0 && area.x + area.y + area.z > 0) {
    consider_foot(corner, inward, area, nearest);
  }
  // The closest point is on an edge that separates the foot from the triangle.
  if (!(area.z > error)) consider_edge(corner, 0, edge[0], nearest);
  if (!(area.x > error)) consider_edge(corner, 1, edge[1], nearest);
  if (!(area.y > error)) consider_edge(corner, 2, edge[2], nearest);
  return {frame.length_from_local(safe_length(nearest.position)), nearest.weights};
}

ClosestPoints geometry::closest_points(const Vec3& point, const Triangle& triangle) {
  const PointOnTriangle closest = closest_on(triangle, point);
  return {closest.distance, point, point_at(triangle, closest.weights)};
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Ericson2005], section 5.1.5: the signs of three areas say which edges separate a point from a triangle.
// Differs   An edge whose sign rounding could change counts as separating, and the face as well, so slivers need no
//           other path. The foot is given by weights that are >= 0, so it is on the triangle however inaccurate the
//           normal.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/features.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

using geometry::next_corner;

/// The closest point so far, relative to the point, and its weights.
struct Nearest {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vec3 position, weights;

  void consider(const Vec3& candidate, const Vec3& candidate_weights) {
    const double candidate_sq = length_sq(candidate);
    if (candidate_sq >= distance_sq) return;
    distance_sq = candidate_sq, position = candidate, weights = candidate_weights;
  }
};

/// The closest point of an edge to the origin. A corner is met exactly, so all triangles at a corner agree about it.
void consider_edge(const Triangle& corner, std::size_t i, const Vec3& edge, Nearest& nearest) {
  const double t = geometry::clamped_quotient(-dot(edge, corner[i]), length_sq(edge));
  Vec3 weights;
  weights[i] = 1 - t, weights[next_corner[i]] = t;
  nearest.consider(t == 1 ? corner[next_corner[i]] : corner[i] + t * edge, weights);
}

}  // namespace

geometry::PointOnTriangle geometry::closest_on(const Triangle& triangle, const Vec3& point) {
  LIMBER_ASSERT(is_finite(point) && is_finite(triangle.v0) && is_finite(triangle.v1) && is_finite(triangle.v2));
  const LocalFrame frame(point, {triangle.v0, triangle.v1, triangle.v2});
  const Face face(frame.to_local(triangle));
  const Triangle& corner = face.corner;
  const auto& edge = face.edge;
  const Vec3 area = face.areas({});
  // Each is off by less than 80 u times the cube of the longest edge and the extent; or underflows.
  const double longest = max_abs(max(max(abs(edge[0]), abs(edge[1])), abs(edge[2])));
  const double error = 0x1p-46 * longest * longest * longest * frame.extent() + 0x1p-960;
  Nearest nearest;
  if (Face::are_inside(area)) {
    const Vec3 weights = face.foot_weights({});
    nearest.consider(point_at(corner, weights), weights);
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

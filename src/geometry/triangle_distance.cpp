// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Distances of two triangles, and of two segments. The functions are closest_points(), closest_features(), closest_on()
// and shared_point() of geometry/primitives.h, and features_and_direction() of geometry/triangle_contact.h.
//
// Based on  [Larsen1999]: the closest points of disjoint triangles lie on a pair of edges or on a corner and a face.
// Differs   All fifteen feature pairs are compared, most of it in simd::CompareTriangles; none is dropped by a
//           threshold, so slivers and tiny triangles take the same path. The direction between the closest points must
//           then prove the triangles apart by projection; if it cannot, the exact predicate geometry::intersects()
//           decides. So the distance is 0 if and only if they intersect. Distances are computed in a LocalFrame:
//           relative to corner v0 of a and, at extreme scales, divided by a power of two.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/features.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/triangle_contact.h"
#include "simd/kernels.h"

namespace limber {
namespace {

using geometry::Face;
using geometry::is_point;
using geometry::LocalFrame;
using geometry::next_corner;
using geometry::point_at;
using geometry::safe_length;

// Errors, as parts of the extent, the largest coordinate in the LocalFrame; u = 2^-53. What is promised to users:
// docs/algorithms/numerics.md, "Distances".
//
// The height of a corner along a direction d is off by 9 u max|d|, for three products with three roundings each, and by
// 3 u max|d| for the rounded corner: 24 u for two heights. The rest of 32 u is room.
constexpr double separation_error = 0x1p-48;
// Closest points touch if they are within 128 u: far above all errors. Only the choice of features depends on it.
constexpr double touching_distance = 0x1p-46;

// Points of a triangle are given by the weights of its corners: barycentric coordinates.
Vec3 corner_weights(std::size_t corner) {
  Vec3 w{};
  w[corner] = 1;
  return w;
}

Vec3 edge_weights(std::size_t edge, double parameter) {
  Vec3 w{};
  w[edge] = 1 - parameter;
  w[next_corner[edge]] = parameter;
  return w;
}

/// The closest pair of points found so far.
struct Best {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vec3 a_to_b;  ///< from the point on a to the point on b, in the LocalFrame
  Vec3 weights_a, weights_b;

  void improve(const Vec3& candidate, const Vec3& w_a, const Vec3& w_b) {
    if (length_sq(candidate) < distance_sq) *this = {length_sq(candidate), candidate, w_a, w_b};
  }
};

/// The closest points of a face and a point, to the bit those that closest_pair() would find with its kernel. The point
/// counts as corner v0 of b.
Best closest_to_point(const Face& a, const Vec3& b) {
  Best best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 to_b = b - a.corner[i];
    const double parameter = geometry::clamped_quotient(dot(a.edge[i], to_b), length_sq(a.edge[i]));
    best.improve(to_b - parameter * a.edge[i], edge_weights(i, parameter), corner_weights(0));
  }
  Vec3 weights;
  if (a.foot(b, weights)) best.improve(b - point_at(a.corner, weights), weights, corner_weights(0));
  return best;
}

/// Finds the closest points of an edge of each, or of a corner and the other face. The kernel finds the closest of the
/// nine edge pairs, and the corners whose foot, their projection on the other plane, is inside the other triangle.
Best closest_pair(const Face& a, const Face& b) {
  if (is_point(b.corner)) return closest_to_point(a, b.corner.v0);
  if (is_point(a.corner)) {
    const Best found = closest_to_point(b, a.corner.v0);
    return {found.distance_sq, Vec3{} - found.a_to_b, found.weights_b, found.weights_a};
  }
  simd::TriangleFeatures found;
  simd::kernels().compare_triangles(a, b, found);
  Best best;
  const std::size_t i = found.edge_a, j = found.edge_b;
  const Vec3 between_edges = (b.corner[j] - a.corner[i]) + (found.at_b * b.edge[j] - found.at_a * a.edge[i]);
  best.improve(between_edges, edge_weights(i, found.at_a), edge_weights(j, found.at_b));
  for (std::size_t k = 0; k < 3; ++k) {
    if ((found.feet_of_a >> k & 1) != 0) {
      const Vec3 weights = b.foot_weights(a.corner[k]);
      best.improve(point_at(b.corner, weights) - a.corner[k], corner_weights(k), weights);
    }
    if ((found.feet_of_b >> k & 1) != 0) {
      const Vec3 weights = a.foot_weights(b.corner[k]);
      best.improve(b.corner[k] - point_at(a.corner, weights), weights, corner_weights(k));
    }
  }
  return best;
}

/// Whether a plane perpendicular to `direction`, which leads from a to b and has any length, separates the triangles by
/// more than rounding.
bool is_separated(const Triangle& a, const Triangle& b, const Vec3& direction, double extent) {
  const double end_of_a = std::max({dot(direction, a.v0), dot(direction, a.v1), dot(direction, a.v2)});
  const double start_of_b = std::min({dot(direction, b.v0), dot(direction, b.v1), dot(direction, b.v2)});
  return start_of_b - end_of_a > separation_error * max_abs(direction) * extent;
}

/// The point of a triangle that is closest to some point.
struct NearestOnFace {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vec3 weights{};

  double distance() const { return std::sqrt(distance_sq); }
};

NearestOnFace nearest_on(const Face& face, const Vec3& p) {
  NearestOnFace nearest;
  if (face.foot(p, nearest.weights)) nearest.distance_sq = length_sq(point_at(face.corner, nearest.weights) - p);
  for (std::size_t i = 0; i < 3; ++i) {  // edges in any case, as the foot on a sliver may be inaccurate
    // Where the edge is closest to p, from 0 to 1; 0 on an edge without length.
    const double t = geometry::clamped_quotient(dot(face.edge[i], p - face.corner[i]), length_sq(face.edge[i]));
    const double distance_sq = length_sq(face.corner[i] + t * face.edge[i] - p);
    if (distance_sq < nearest.distance_sq) nearest = {distance_sq, edge_weights(i, t)};
  }
  return nearest;
}

/// The point of an edge of one triangle, the owner, that is nearest to where the edge's line crosses the plane of the
/// other triangle, the target. It is an end of the edge if both ends are on one side of the plane, or seem to be.
struct Crossing {
  NearestOnFace nearest;  ///< the point of the target that is nearest to `point`
  Vec3 point;
  Vec3 weights;       ///< of `point` in the owner
  bool is_edge_of_a;  ///< the owner is a
};

/// Signed distances of the corners of `owner` from the plane of `target`, times the length of its normal.
std::array<double, 3> scaled_heights(const Face& owner, const Face& target) {
  std::array<double, 3> heights;
  for (std::size_t i = 0; i < 3; ++i) heights[i] = dot(owner.corner[i] - target.corner.v0, target.normal);
  return heights;
}

/// The crossings of two triangles, edges of a first. An edge that does not reach the other's plane has one too, at its
/// nearer end, because rounding may have put that end on the wrong side. Only parallel edges have none.
class Crossings {
 public:
  Crossings(const Face& a, const Face& b) {
    for (const bool of_a : {true, false}) {
      const Face &owner = of_a ? a : b, &target = of_a ? b : a;
      const std::array<double, 3> heights = scaled_heights(owner, target);
      for (std::size_t i = 0; i < 3; ++i) {
        const double start = heights[i], end = heights[next_corner[i]];
        if (start == end) continue;
        const double parameter = std::clamp(start / (start - end), 0.0, 1.0);
        const Vec3 point = owner.corner[i] + parameter * owner.edge[i];
        crossings_[count_++] = {nearest_on(target, point), point, edge_weights(i, parameter), of_a};
      }
    }
  }
  const Crossing* begin() const { return crossings_.data(); }
  const Crossing* end() const { return crossings_.data() + count_; }

 private:
  std::array<Crossing, 6> crossings_;
  std::size_t count_ = 0;
};

/// A point of two triangles that intersect, and its weights in each.
struct SharedPoint {
  Vec3 point;
  Vec3 weights_a, weights_b;
};

/// A point that is on both triangles as nearly as rounding allows. Pre: they intersect.
///
/// Candidates are the closest point of a (Best) and all crossings. The one with the least misfit, the distance from the
/// farther triangle, is taken, so no case distinction can pick a bad one.
SharedPoint shared_point_robust(const Face& a, const Face& b, const Best& best, [[maybe_unused]] double extent) {
  SharedPoint shared{point_at(a.corner, best.weights_a), best.weights_a, best.weights_b};
  double misfit = nearest_on(b, shared.point).distance();  // its distance from a is 0
  for (const Crossing& c : Crossings(a, b)) {
    if (!(c.nearest.distance() < misfit)) continue;
    const double candidate = std::max(c.nearest.distance(), nearest_on(c.is_edge_of_a ? a : b, c.point).distance());
    if (!(candidate < misfit)) continue;
    misfit = candidate;
    shared = c.is_edge_of_a ? SharedPoint{c.point, c.weights, c.nearest.weights}
                            : SharedPoint{c.point, c.nearest.weights, c.weights};
  }
  // Why the misfit is small. Some edge E of one triangle meets the other one, S. Let h be the smallest height of S.
  // 1. The misfit is at most about m = u * extent^2 / h. The normal of S is off by rounding, so the crossing of E with
  //    the plane of S is computed to be up to m above or below S. If the crossing is computed to be outside of S, then
  //    E passes within m of an edge of S, or ends within m of S, and the closest points are that near.
  // 2. The misfit is at most h / 2: every point of S is that near to an edge of S, and E has been compared with all
  //    edges of S.
  // The worst case is where both bounds are equal: h = 2^-26 * extent, and the misfit is 2^-27 * extent. The assertion
  // allows twice that.
  LIMBER_ASSERT(misfit <= 0x1p-26 * extent);
  return shared;
}

/// Finds a point where an edge of `owner` crosses `target`, and that lies on `target` within `tolerance`, and its
/// weights. It may miss it, because it tries only edges whose ends seem to be on different sides. If it does, what it
/// has set means nothing.
bool find_crossing(const Face& owner, const Face& target, double tolerance, Vec3& point, Vec3& weights_in_owner,
                   Vec3& weights_in_target) {
  const std::array<double, 3> heights = scaled_heights(owner, target);
  for (std::size_t i = 0; i < 3; ++i) {
    const double start = heights[i], end = heights[next_corner[i]];
    if ((start < 0) == (end < 0)) continue;
    const double parameter = start / (start - end);
    point = owner.corner[i] + parameter * owner.edge[i];
    if (!target.foot(point, weights_in_target)) continue;
    weights_in_owner = edge_weights(i, parameter);
    if (length_sq(point - point_at(target.corner, weights_in_target)) <= tolerance * tolerance) return true;
  }
  return false;
}

/// Finds a point of both triangles the fast way. If it finds none, shared_point_robust() does.
bool find_shared_point_fast(const Face& a, const Face& b, double extent, SharedPoint& shared) {
  const double tolerance = simd::shared_point_tolerance * extent;
  return find_crossing(a, b, tolerance, shared.point, shared.weights_a, shared.weights_b) ||
         find_crossing(b, a, tolerance, shared.point, shared.weights_b, shared.weights_a);
}

/// Two triangles compared once, for all answers about them. It refers to its arguments, which must outlive it.
///
/// Pre      The extent of the frame is not 0: not all corners are one point.
class Comparison {
 public:
  Comparison(const LocalFrame& frame, const Triangle& a, const Triangle& b, const Face& local_a, const Face& local_b)
      : frame_(frame), a_(a), b_(b), local_a_(local_a), local_b_(local_b) {
    // A local variable: a member would be written to memory before is_separated() and intersects() are called.
    const Best best = closest_pair(local_a_, local_b_);
    are_proven_apart_ = is_separated(local_a_.corner, local_b_.corner, best.a_to_b, frame.extent());
    intersect_ = !are_proven_apart_ && geometry::intersects(a, b);
    best_ = best;
  }

  bool are_proven_apart() const { return are_proven_apart_; }
  bool intersect() const { return intersect_; }
  const Best& best() const { return best_; }

  /// Pre: the triangles intersect.
  SharedPoint shared_point() const {
    LIMBER_ASSERT(intersect_);
    SharedPoint shared;
    if (find_shared_point_fast(local_a_, local_b_, frame_.extent(), shared)) return shared;
    return shared_point_robust(local_a_, local_b_, best_, frame_.extent());
  }
  ClosestPoints points_that_are(const SharedPoint& shared) const {
    const Vec3 point = frame_.from_local(shared.point);
    return {0, point, point};
  }
  /// Pre: the triangles do not intersect.
  ClosestPoints points_apart() const {
    LIMBER_ASSERT(!intersect_);
    const double distance = frame_.length_from_local(safe_length(best_.a_to_b));
    // 0 would say that they intersect.
    return {std::max(distance, std::numeric_limits<double>::min()), point_at(a_, best_.weights_a),
            point_at(b_, best_.weights_b)};
  }
  /// Whether the closest points touch, there where a point of both triangles is.
  bool best_touches_at(const Vec3& point) const {
    const double touching = touching_distance * frame_.extent();
    return max_abs(best_.a_to_b) <= touching && max_abs(point_at(local_a_.corner, best_.weights_a) - point) <= touching;
  }

 private:
  const LocalFrame& frame_;
  const Triangle& a_;
  const Triangle& b_;
  const Face &local_a_, &local_b_;
  Best best_;
  bool are_proven_apart_ = false, intersect_ = false;
};

LocalFrame frame_of(const Triangle& a, const Triangle& b) {
  LIMBER_ASSERT(is_finite(a.v0) && is_finite(b.v0));
  return {a.v0, {a.v1, a.v2, b.v0, b.v1, b.v2}};
}

}  // namespace

ClosestPoints geometry::closest_points(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  if (frame.extent() == 0) return {0, a.v0, a.v0};
  const Face local_a(frame.to_local(a)), local_b(frame.to_local(b));
  const Comparison c(frame, a, b, local_a, local_b);
  return c.intersect() ? c.points_that_are(c.shared_point()) : c.points_apart();
}

Vec3 geometry::shared_point(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  if (frame.extent() == 0) return a.v0;
  SharedPoint shared;
  const Face local_a(frame.to_local(a)), local_b(frame.to_local(b));
  if (!find_shared_point_fast(local_a, local_b, frame.extent(), shared)) {
    shared = shared_point_robust(local_a, local_b, closest_pair(local_a, local_b), frame.extent());
  }
  return frame.from_local(shared.point);
}

// The closest pair is a pair of features as small as can be. So it gives the weights of triangles that intersect too,
// if it touches where the shared point is. Otherwise they cross there, an edge of one and the other triangle.
geometry::FeaturesAndDirection geometry::features_and_direction(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  const Vec3 v0{1, 0, 0};  // the weights of corner v0
  if (frame.extent() == 0) {
    return {{0, a.v0, a.v0, feature_of(v0), feature_of(v0), v0, v0}, Vec3{}, false};
  }
  const Face local_a(frame.to_local(a)), local_b(frame.to_local(b));
  const Comparison c(frame, a, b, local_a, local_b);
  Vec3 weights_a = c.best().weights_a, weights_b = c.best().weights_b;
  ClosestPoints points;
  if (c.intersect()) {
    const SharedPoint shared = c.shared_point();
    points = c.points_that_are(shared);
    if (!c.best_touches_at(shared.point)) weights_a = shared.weights_a, weights_b = shared.weights_b;
  } else {
    points = c.points_apart();
  }
  return {{points.distance, points.point_a, points.point_b, feature_of(weights_a), feature_of(weights_b), weights_a,
           weights_b},
          c.best().a_to_b,
          c.are_proven_apart()};
}

ClosestFeatures geometry::closest_features(const Triangle& a, const Triangle& b) {
  return features_and_direction(a, b).closest;
}

geometry::PointsOnSegments geometry::closest_on(const Segment& a, const Segment& b) {
  const auto closest = [](const Segment& local_a, const Segment& local_b) {
    const auto [s, t] = geometry::closest_parameters(local_a, local_b);
    const Vec3 a_to_b = (local_b.p0 - local_a.p0) + (t * (local_b.p1 - local_b.p0) - s * (local_a.p1 - local_a.p0));
    return PointsOnSegments{safe_length(a_to_b), s, t};
  };
  // A LocalFrame is built only where it may scale, which is rare. Otherwise all it does is to subtract a.p0.
  const Segment from_a{{}, a.p1 - a.p0}, from_b{b.p0 - a.p0, b.p1 - a.p0};
  const Vec3 sums = abs(from_a.p1) + abs(from_b.p0) + abs(from_b.p1);
  const double size = sums.x + sums.y + sums.z;  // 1 to 9 times the extent, and both limits allow for that
  if (size > base::smallest_unscaled_size && size < base::largest_unscaled_size) return closest(from_a, from_b);
  const LocalFrame frame(a.p0, {a.p1, b.p0, b.p1});
  PointsOnSegments found = closest(frame.to_local(a), frame.to_local(b));
  found.distance = frame.length_from_local(found.distance);
  return found;
}

ClosestPoints geometry::closest_points(const Segment& a, const Segment& b) {
  const auto [distance, s, t] = closest_on(a, b);
  // A segment is a triangle whose third corner has no weight. point_at() meets the ends exactly.
  return {distance, point_at({a.p0, a.p1, a.p1}, {1 - s, s, 0}), point_at({b.p0, b.p1, b.p1}, {1 - t, t, 0})};
}

}  // namespace limber

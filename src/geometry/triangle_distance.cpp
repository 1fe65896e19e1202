// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Larsen1999]: the closest points of disjoint triangles lie on a pair of edges or on a corner and a face.
// Differs   All fifteen feature pairs are compared; none is dropped by a threshold, so slivers and tiny triangles take
//           the same path. The direction between the best points must then prove the triangles apart by projection; if
//           it cannot, the exact predicate decides, so that distance 0 and intersection are one fact. All arithmetic is
//           relative to a corner and, at extreme scales, divided by a power of two.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/check.h"
#include "geometry/face.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/segment_distance.h"
#include "geometry/triangle_contact.h"
#include "simd/kernels.h"

namespace limber {
namespace {

using geometry::after;
using geometry::Face;
using geometry::feature_of;
using geometry::LocalFrame;
using geometry::point_at;
using geometry::safe_length;

Vec3 corner_weights(std::size_t corner) {
  Vec3 w;
  w[corner] = 1;
  return w;
}

Vec3 edge_weights(std::size_t edge, double parameter) {
  Vec3 w;
  w[edge] = 1 - parameter;
  w[after[edge]] = parameter;
  return w;
}

/// The best pair of points found so far.
struct Best {
  double distance_sq = std::numeric_limits<double>::infinity();
  Vec3 between;  ///< from the point on a to the point on b
  Vec3 weights_a, weights_b;

  bool improves(const Vec3& candidate) const { return length_sq(candidate) < distance_sq; }
  void set(const Vec3& candidate, const Vec3& w_a, const Vec3& w_b) {
    distance_sq = length_sq(candidate);
    between = candidate;
    weights_a = w_a;
    weights_b = w_b;
  }
};

Best closest_pair(const Face& a, const Face& b) {
  simd::TriangleFeatures found;
  simd::kernels().compare_triangles(a, b, found);
  Best best;
  const std::size_t i = found.edge_a, j = found.edge_b;
  const Vec3 of_edges = (b.corner[j] - a.corner[i]) + (found.at_b * b.edge[j] - found.at_a * a.edge[i]);
  if (best.improves(of_edges)) best.set(of_edges, edge_weights(i, found.at_a), edge_weights(j, found.at_b));
  Vec3 weights;
  for (std::size_t k = 0; k < 3; ++k) {
    if ((found.feet_of_a >> k & 1) != 0 && b.foot(a.corner[k], weights)) {
      const Vec3 between = point_at(b.corner, weights) - a.corner[k];
      if (best.improves(between)) best.set(between, corner_weights(k), weights);
    }
    if ((found.feet_of_b >> k & 1) != 0 && a.foot(b.corner[k], weights)) {
      const Vec3 between = b.corner[k] - point_at(a.corner, weights);
      if (best.improves(between)) best.set(between, weights, corner_weights(k));
    }
  }
  return best;
}

/// Whether the planes across the best points' connection leave the triangles on different sides, beyond rounding.
bool is_separated(const Triangle& a, const Triangle& b, const Vec3& direction, double extent) {
  const double end_of_a = std::max({dot(direction, a.v0), dot(direction, a.v1), dot(direction, a.v2)});
  const double start_of_b = std::min({dot(direction, b.v0), dot(direction, b.v1), dot(direction, b.v2)});
  return start_of_b - end_of_a > 0x1p-48 * max_abs(direction) * extent;
}

/// Where an edge is closest to p, from 0 to 1.
double closest_parameter(const Face& face, std::size_t edge, const Vec3& p) {
  return geometry::clamped_quotient(dot(face.edge[edge], p - face.corner[edge]), length_sq(face.edge[edge]));
}

double distance_to(const Face& face, const Vec3& p) {
  double best_sq = std::numeric_limits<double>::infinity();
  Vec3 weights;
  if (face.foot(p, weights)) best_sq = length_sq(point_at(face.corner, weights) - p);
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = closest_parameter(face, i, p);
    best_sq = std::min(best_sq, length_sq(face.corner[i] + t * face.edge[i] - p));
  }
  return std::sqrt(best_sq);
}

/// The point of an edge of one triangle that is nearest to where its line passes through the plane of the other.
struct Crossing {
  double misfit;  ///< distance from the other triangle
  Vec3 point;
  std::size_t edge;
  double parameter;  ///< on the edge, from 0 to 1
  bool is_edge_of_a;
};

/// The crossings of two triangles: those of edges of a, then those of edges of b. Edges parallel to the other's plane
/// have none.
class Crossings {
 public:
  Crossings(const Face& a, const Face& b) {
    for (const bool of_a : {true, false}) {
      const Face &owner = of_a ? a : b, &target = of_a ? b : a;
      for (std::size_t i = 0; i < 3; ++i) {
        const double height0 = dot(owner.corner[i] - target.corner.v0, target.normal);
        const double height1 = dot(owner.corner[after[i]] - target.corner.v0, target.normal);
        if (height0 == height1) continue;
        const double parameter = std::clamp(height0 / (height0 - height1), 0.0, 1.0);
        const Vec3 point = owner.corner[i] + parameter * owner.edge[i];
        crossings_[count_++] = {distance_to(target, point), point, i, parameter, of_a};
      }
    }
  }
  const Crossing* begin() const { return crossings_.data(); }
  const Crossing* end() const { return crossings_.data() + count_; }

 private:
  std::array<Crossing, 6> crossings_;
  std::size_t count_ = 0;
};

/// The point that fits best on both triangles, which are known to intersect.
///
/// Candidates are the closest features (contacts of boundaries, coplanar overlap) and the points where an edge passes
/// through the other's plane. The one nearest to both is taken, so no case distinction can pick a bad one.
Vec3 contact_point(const Face& a, const Face& b, const Best& best, [[maybe_unused]] double extent) {
  Vec3 contact = point_at(a.corner, best.weights_a);
  double misfit = distance_to(b, contact);
  for (const Crossing& c : Crossings(a, b)) {
    if (!(c.misfit < misfit)) continue;
    const double candidate = std::max(c.misfit, distance_to(c.is_edge_of_a ? a : b, c.point));
    if (candidate < misfit) contact = c.point, misfit = candidate;
  }
  // Let h be the smallest height of the triangles. Rounding moves a point on a plane by about u * extent^2 / h, and
  // no point of a triangle is further than h / 2 from an edge. The smaller of the two is largest at h = 2^-26 * extent.
  LIMBER_ASSERT(misfit <= 0x1p-26 * extent);
  return contact;
}

/// A point where an edge of `owner` passes through `target`, if one is found that is on it up to `tolerance`.
bool find_crossing(const Face& owner, const Face& target, double tolerance, Vec3& point) {
  std::array<double, 3> height;
  for (std::size_t i = 0; i < 3; ++i) height[i] = dot(owner.corner[i] - target.corner.v0, target.normal);
  for (std::size_t i = 0; i < 3; ++i) {
    const double height0 = height[i], height1 = height[after[i]];
    if ((height0 < 0) == (height1 < 0)) continue;
    point = owner.corner[i] + height0 / (height0 - height1) * owner.edge[i];
    Vec3 weights;
    if (!target.foot(point, weights)) continue;
    if (length_sq(point - point_at(target.corner, weights)) <= tolerance * tolerance) return true;
  }
  return false;
}

/// A point of both triangles, if one is found without the care of contact_point().
bool find_shared_point(const Face& a, const Face& b, double extent, Vec3& point) {
  const double tolerance = 0x1p-49 * extent;
  return find_crossing(a, b, tolerance, point) || find_crossing(b, a, tolerance, point);
}

/// Two triangles compared once, for everything that is asked about them.
///
/// Pre      The extent of the frame is not 0.
class Comparison {
 public:
  Comparison(const LocalFrame& frame, const Triangle& a, const Triangle& b)
      : frame_(frame), a_(a), b_(b), local_a_(frame.to_local(a)), local_b_(frame.to_local(b)) {
    const Best best = closest_pair(local_a_, local_b_);  // a local variable stays in registers
    are_proven_apart_ = is_separated(local_a_.corner, local_b_.corner, best.between, frame.extent());
    intersect_ = !are_proven_apart_ && geometry::intersects(a, b);
    best_ = best;
  }

  ClosestPoints points() const {
    if (intersect_) {
      Vec3 shared;
      if (!find_shared_point(local_a_, local_b_, frame_.extent(), shared)) {
        shared = contact_point(local_a_, local_b_, best_, frame_.extent());
      }
      shared = frame_.from_local(shared);
      return {0, shared, shared};
    }
    const double distance = frame_.length_from_local(safe_length(best_.between));
    return {std::max(distance, std::numeric_limits<double>::min()), point_at(a_, best_.weights_a),
            point_at(b_, best_.weights_b)};
  }
  const Face& local_a() const { return local_a_; }
  const Face& local_b() const { return local_b_; }
  const Best& best() const { return best_; }
  double extent() const { return frame_.extent(); }
  bool are_proven_apart() const { return are_proven_apart_; }
  bool intersect() const { return intersect_; }

 private:
  const LocalFrame& frame_;
  const Triangle& a_;
  const Triangle& b_;
  Face local_a_, local_b_;
  Best best_;
  bool are_proven_apart_ = false, intersect_ = false;
};

LocalFrame frame_of(const Triangle& a, const Triangle& b) {
  LIMBER_ASSERT(is_finite(a.v0) && is_finite(b.v0));
  return {a.v0, {a.v1, a.v2, b.v0, b.v1, b.v2}};
}

/// The best pair of a point and a triangle, which is the second; the point has no weights.
Best closest_pair(const Vec3& point, const Face& face) {
  Best best;
  Vec3 weights;
  if (face.foot(point, weights)) best.set(point_at(face.corner, weights) - point, {}, weights);
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = closest_parameter(face, i, point);
    const Vec3 between = face.corner[i] + t * face.edge[i] - point;
    if (best.improves(between)) best.set(between, {}, edge_weights(i, t));
  }
  return best;
}

struct FeaturePair {
  Feature a, b;
};

FeaturePair features_of(const Best& best) { return {feature_of(best.weights_a), feature_of(best.weights_b)}; }

/// The features that meet at the contact point of two intersecting triangles, or next to it.
///
/// Those of the best pair do if they are no further apart than rounding. Otherwise the line in which the triangles
/// cross ends where an edge of one passes through the other; the end next to the contact point counts.
FeaturePair features_at(const Vec3& contact, const Comparison& c) {
  const double rounding = 0x1p-46 * c.extent();
  if (max_abs(c.best().between) <= rounding) return features_of(c.best());
  const Crossings crossings(c.local_a(), c.local_b());
  double least_misfit = std::numeric_limits<double>::infinity();
  for (const Crossing& crossing : crossings) least_misfit = std::min(least_misfit, crossing.misfit);
  const Crossing* nearest = nullptr;
  for (const Crossing& crossing : crossings) {
    if (crossing.misfit > least_misfit + rounding) continue;
    if (nearest == nullptr || length_sq(crossing.point - contact) < length_sq(nearest->point - contact)) {
      nearest = &crossing;
    }
  }
  if (nearest == nullptr) return features_of(c.best());  // both are degenerate
  const Feature of_edge = feature_of(edge_weights(nearest->edge, nearest->parameter));
  const Face& other = nearest->is_edge_of_a ? c.local_b() : c.local_a();
  const Feature of_other = feature_of(closest_pair(nearest->point, other).weights_b);
  return nearest->is_edge_of_a ? FeaturePair{of_edge, of_other} : FeaturePair{of_other, of_edge};
}

}  // namespace

ClosestPoints geometry::closest_points(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  if (frame.extent() == 0) return {0, a.v0, a.v0};
  return Comparison(frame, a, b).points();
}

Vec3 geometry::shared_point(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  if (frame.extent() == 0) return a.v0;
  Vec3 point;
  if (find_shared_point(Face(frame.to_local(a)), Face(frame.to_local(b)), frame.extent(), point)) {
    return frame.from_local(point);
  }
  return Comparison(frame, a, b).points().point_a;
}

geometry::DirectedFeatures geometry::directed_features(const Triangle& a, const Triangle& b) {
  const LocalFrame frame = frame_of(a, b);
  const Feature vertex{FeatureKind::vertex, 0};
  if (frame.extent() == 0) return {{0, a.v0, a.v0, vertex, vertex}, {}, false};
  const Comparison c(frame, a, b);
  const ClosestPoints points = c.points();
  const FeaturePair features = c.intersect() ? features_at(frame.to_local(points.point_a), c) : features_of(c.best());
  return {{points.distance, points.point_a, points.point_b, features.a, features.b},
          c.best().between,
          c.are_proven_apart()};
}

ClosestFeatures geometry::closest_features(const Triangle& a, const Triangle& b) {
  return directed_features(a, b).closest;
}

geometry::PointsOnSegments geometry::closest_on(const Segment& a, const Segment& b) {
  const auto closest = [](const Segment& local_a, const Segment& local_b) {
    const auto [s, t] = geometry::closest_parameters(local_a, local_b);
    const Vec3 between = (local_b.p0 - local_a.p0) + (t * (local_b.p1 - local_b.p0) - s * (local_a.p1 - local_a.p0));
    return PointsOnSegments{safe_length(between), s, t};
  };
  // Where the frame would not scale, which is nearly always, it is not worth its time.
  const Segment from_a{{}, a.p1 - a.p0}, from_b{b.p0 - a.p0, b.p1 - a.p0};
  const Vec3 sums = abs(from_a.p1) + abs(from_b.p0) + abs(from_b.p1);
  const double size = sums.x + sums.y + sums.z;  // 1 to 9 times the extent
  if (size > base::smallest_unscaled_size && size < base::largest_unscaled_size) return closest(from_a, from_b);
  const LocalFrame frame(a.p0, {a.p1, b.p0, b.p1});
  PointsOnSegments found = closest(frame.to_local(a), frame.to_local(b));
  found.distance = frame.length_from_local(found.distance);
  return found;
}

ClosestPoints geometry::closest_points(const Segment& a, const Segment& b) {
  const auto [distance, s, t] = closest_on(a, b);
  return {distance, point_at({a.p0, a.p1, a.p1}, {1 - s, s, 0}), point_at({b.p0, b.p1, b.p1}, {1 - t, t, 0})};
}

}  // namespace limber

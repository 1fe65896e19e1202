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

#include "core/check.h"
#include "geometry/primitives.h"
#include "geometry/segment_distance.h"

namespace limber {
namespace {

using geometry::after;

/// Moves coordinates near the origin and, if need be, near unit size: v -> (v - origin) * scale, scale a power of two.
class LocalFrame {
 public:
  LocalFrame(const Vec3& origin, std::initializer_list<Vec3> points) : origin_(origin) {
    for (const Vec3& p : points) extent_ = std::max(extent_, max_abs(p - origin));
    if (extent_ == 0 || (extent_ > 0x1p-100 && extent_ < 0x1p100)) return;
    int exponent = 0;
    std::frexp(extent_, &exponent);
    // Subnormal extents may need more than the largest power of two; what is lost then is below any double.
    scale_ = std::ldexp(1.0, -std::max(exponent, -1000));
    extent_ *= scale_;
  }
  Vec3 to_local(const Vec3& v) const { return (v - origin_) * scale_; }
  Triangle to_local(const Triangle& t) const { return {to_local(t.v0), to_local(t.v1), to_local(t.v2)}; }
  Segment to_local(const Segment& s) const { return {to_local(s.p0), to_local(s.p1)}; }
  Vec3 from_local(const Vec3& v) const { return origin_ + v * (1 / scale_); }
  double length_from_local(double length) const { return length / scale_; }
  double extent() const { return extent_; }  ///< largest local coordinate

 private:
  Vec3 origin_;
  double extent_ = 0;
  double scale_ = 1;
};

/// Length that stays positive where the square underflows.
double safe_length(const Vec3& v) {
  const double v_sq = length_sq(v);
  if (v_sq > 0x1p-900) return std::sqrt(v_sq);
  const double size = max_abs(v);
  return size == 0 ? 0 : size * length(v * (1 / std::max(size, 0x1p-1000)));
}

/// The point of a triangle with the given weights; a corner is met exactly.
Vec3 point_at(const Triangle& t, const Vec3& weights) {
  const std::size_t k = weights.x >= weights.y ? (weights.x >= weights.z ? 0 : 2) : (weights.y >= weights.z ? 1 : 2);
  const std::size_t i = after[k], j = after[i];
  return t[k] + (weights[i] * (t[i] - t[k]) + weights[j] * (t[j] - t[k]));
}

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

/// A triangle with what its face tests need.
struct Face {
  Triangle corner;
  std::array<Vec3, 3> edge;
  Vec3 normal;
  std::array<Vec3, 3> inward;  ///< in the plane, across the edge, towards the third corner

  explicit Face(const Triangle& t) : corner(t), edge{t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2} {
    normal = cross(edge[0], edge[1]);
    for (std::size_t i = 0; i < 3; ++i) inward[i] = cross(normal, edge[i]);
  }

  /// Weights of the foot of p when it falls into the triangle; false when it does not or the triangle has no area.
  bool foot(const Vec3& p, Vec3& weights) const {
    const double w2 = dot(inward[0], p - corner.v0);
    const double w0 = dot(inward[1], p - corner.v1);
    const double w1 = dot(inward[2], p - corner.v2);
    const double sum = w0 + w1 + w2;
    if (!(w0 >= 0 && w1 >= 0 && w2 >= 0 && sum > 0)) return false;
    weights = {w0 / sum, w1 / sum, w2 / sum};
    // The normal of a sliver is off by the roundoff over its smallest angle; what that costs the foot is measured and
    // taken back, each time by the same factor.
    Vec3 off = p - point_at(corner, weights);
    for (int step = 0; step < 3; ++step) {
      const Vec3 change = Vec3{dot(inward[1], off), dot(inward[2], off), dot(inward[0], off)} * (1 / sum);
      const Vec3 better = max(weights + change, Vec3{});
      const Vec3 normalised = better * (1 / (better.x + better.y + better.z));
      const Vec3 better_off = p - point_at(corner, normalised);
      if (!(length_sq(better_off) < length_sq(off))) break;  // also when a hopeless sliver gives no number
      weights = normalised;
      off = better_off;
    }
    return true;
  }
};

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

Best closest_features(const Face& a, const Face& b) {
  Best best;
  for (std::size_t i = 0; i < 3; ++i) {
    const Segment edge_a{a.corner[i], a.corner[after[i]]};
    for (std::size_t j = 0; j < 3; ++j) {
      const Segment edge_b{b.corner[j], b.corner[after[j]]};
      const auto [s, t] = geometry::closest_parameters(edge_a, edge_b);
      const Vec3 between = (edge_b.p0 - edge_a.p0) + (t * b.edge[j] - s * a.edge[i]);
      if (best.improves(between)) best.set(between, edge_weights(i, s), edge_weights(j, t));
    }
  }
  Vec3 weights;
  for (std::size_t i = 0; i < 3; ++i) {
    if (b.foot(a.corner[i], weights)) {
      const Vec3 between = point_at(b.corner, weights) - a.corner[i];
      if (best.improves(between)) best.set(between, corner_weights(i), weights);
    }
    if (a.foot(b.corner[i], weights)) {
      const Vec3 between = b.corner[i] - point_at(a.corner, weights);
      if (best.improves(between)) best.set(between, weights, corner_weights(i));
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

double distance_to(const Face& face, const Vec3& p) {
  double best_sq = std::numeric_limits<double>::infinity();
  Vec3 weights;
  if (face.foot(p, weights)) best_sq = length_sq(point_at(face.corner, weights) - p);
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = geometry::closest_parameters({p, p}, {face.corner[i], face.corner[after[i]]}).t;
    best_sq = std::min(best_sq, length_sq(face.corner[i] + t * face.edge[i] - p));
  }
  return std::sqrt(best_sq);
}

/// The point that fits best on both triangles, which are known to intersect.
///
/// Candidates are the closest features (contacts of boundaries, coplanar overlap) and the points where an edge passes
/// through the other's plane. The one nearest to both is taken, so no case distinction can pick a bad one.
Vec3 contact_point(const Face& a, const Face& b, const Best& best, [[maybe_unused]] double extent) {
  Vec3 contact = point_at(a.corner, best.weights_a);
  double misfit = distance_to(b, contact);
  const auto consider_edges_of = [&](const Face& owner, const Face& target) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double height0 = dot(owner.corner[i] - target.corner.v0, target.normal);
      const double height1 = dot(owner.corner[after[i]] - target.corner.v0, target.normal);
      if (height0 == height1) continue;
      const double parameter = std::clamp(height0 / (height0 - height1), 0.0, 1.0);
      const Vec3 p = owner.corner[i] + parameter * owner.edge[i];
      const double candidate = std::max(distance_to(a, p), distance_to(b, p));
      if (candidate < misfit) contact = p, misfit = candidate;
    }
  };
  if (misfit > 0) consider_edges_of(a, b);
  if (misfit > 0) consider_edges_of(b, a);
  // Let h be the smallest height of the triangles. Rounding moves a point on a plane by about u * extent^2 / h, and
  // no point of a triangle is further than h / 2 from an edge. The smaller of the two is largest at h = 2^-26 * extent.
  LIMBER_ASSERT(misfit <= 0x1p-26 * extent);
  return contact;
}

}  // namespace

ClosestPoints geometry::closest_points(const Triangle& a, const Triangle& b) {
  LIMBER_ASSERT(is_finite(a.v0) && is_finite(b.v0));
  const LocalFrame frame(a.v0, {a.v1, a.v2, b.v0, b.v1, b.v2});
  if (frame.extent() == 0) return {0, a.v0, a.v0};
  const Face local_a(frame.to_local(a)), local_b(frame.to_local(b));
  const Best best = closest_features(local_a, local_b);
  if (!is_separated(local_a.corner, local_b.corner, best.between, frame.extent()) && geometry::intersects(a, b)) {
    const Vec3 shared = frame.from_local(contact_point(local_a, local_b, best, frame.extent()));
    return {0, shared, shared};
  }
  const double distance = frame.length_from_local(safe_length(best.between));
  return {std::max(distance, std::numeric_limits<double>::min()), point_at(a, best.weights_a),
          point_at(b, best.weights_b)};
}

ClosestPoints geometry::closest_points(const Segment& a, const Segment& b) {
  const LocalFrame frame(a.p0, {a.p1, b.p0, b.p1});
  const Segment local_a = frame.to_local(a), local_b = frame.to_local(b);
  const auto [s, t] = geometry::closest_parameters(local_a, local_b);
  const Vec3 between = (local_b.p0 - local_a.p0) + (t * (local_b.p1 - local_b.p0) - s * (local_a.p1 - local_a.p0));
  return {frame.length_from_local(safe_length(between)), point_at({a.p0, a.p1, a.p1}, {1 - s, s, 0}),
          point_at({b.p0, b.p1, b.p1}, {1 - t, t, 0})};
}

ClosestPoints geometry::closest_points(const Vec3& point, const Triangle& triangle) {
  const LocalFrame frame(point, {triangle.v0, triangle.v1, triangle.v2});
  const Face face(frame.to_local(triangle));
  Best best;
  Vec3 weights;
  if (face.foot({}, weights)) best.set(point_at(face.corner, weights), {}, weights);
  for (std::size_t i = 0; i < 3; ++i) {
    const double t = geometry::closest_parameters({}, {face.corner[i], face.corner[after[i]]}).t;
    const Vec3 between = face.corner[i] + t * face.edge[i];
    if (best.improves(between)) best.set(between, {}, edge_weights(i, t));
  }
  return {frame.length_from_local(safe_length(best.between)), point, point_at(triangle, best.weights_b)};
}

}  // namespace limber

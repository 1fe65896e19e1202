// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The points by which b may be moved so that it meets a form a convex polyhedron, the Minkowski difference of both. How
// far b moves along z is where the z axis leaves it. Every plane that has the polyhedron on one side bounds that from
// above, however inexact its normal. The planes of its facets are enough: they are normal to a face, or to an edge of
// each triangle; where all is flat, to an edge and the plane that it spans with z. From below, it is bounded by two
// points that meet.
#include "penetration/last_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "base/check.h"
#include "geometry/primitives.h"

namespace limber::penetration {
namespace {

using geometry::next_corner;

struct Range {
  double low, high;
};

Range range_along(const Vec3& n, const Triangle& t) {
  const double h0 = dot(n, t.v0), h1 = dot(n, t.v1), h2 = dot(n, t.v2);
  return {std::min({h0, h1, h2}), std::max({h0, h1, h2})};
}

// Shorter normals say nothing that rounding does not say as well.
constexpr double shortest_normal = 0x1p-100;

/// Lowers the upper bound of a contact by planes.
class Planes {
 public:
  Planes(const Triangle& a, const Triangle& b, double error, LastContact& contact)
      : a_(a), b_(b), error_(error), contact_(contact) {}

  /// A plane that b crosses on its way. The normal may point to either side.
  void consider_across(const Vec3& either) {
    const Vec3 n = either.z < 0 ? -either : either;
    if (!(n.z > 0) || max_abs(n) < shortest_normal) return;
    const double bound = (overlap_along(n)) / n.z;
    if (bound < contact_.upper) contact_.upper = bound, contact_.normal = n;
  }

  /// Whether a plane parallel to z keeps the triangles apart for ever. Its normal may point to either side.
  bool are_beside(double x, double y) const {
    const double size = std::sqrt(x * x + y * y);
    if (size < shortest_normal) return false;
    const Vec3 n{x / size, y / size, 0};
    return overlap_along(n) < 0 || overlap_along(-n) < 0;
  }

 private:
  /// How far b reaches behind the highest point of a, at most.
  double overlap_along(const Vec3& n) const {
    const double size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    return range_along(n, a_).high - range_along(n, b_).low + error_ * size;
  }

  const Triangle &a_, &b_;
  double error_;
  LastContact& contact_;
};

std::array<Vec3, 3> edges_of(const Triangle& t) { return {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2}; }

double cross_2d(const Vec3& p, const Vec3& q) { return p.x * q.y - p.y * q.x; }
double dot_2d(const Vec3& p, const Vec3& q) { return p.x * q.x + p.y * q.y; }

Vec3 point_of(const Triangle& t, const Vec3& weights) { return weights.x * t.v0 + weights.y * t.v1 + weights.z * t.v2; }

Vec3 corner_weights(std::size_t corner) {
  Vec3 weights;
  weights[corner] = 1;
  return weights;
}

/// The weights of a point of edge i, the part `s` of the way along it.
Vec3 edge_weights(std::size_t i, double s) {
  Vec3 weights;
  weights[i] = 1 - s, weights[next_corner[i]] = s;
  return weights;
}

/// Raises the lower bound of a contact by pairs of points that meet.
class MeetingPoints {
 public:
  MeetingPoints(const Triangle& a, const Triangle& b, double tolerance, LastContact& contact)
      : a_(a), b_(b), tolerance_(tolerance), contact_(contact) {}

  void consider(const Vec3& weights_a, const Vec3& weights_b) {
    const Vec3 apart = point_of(a_, weights_a) - point_of(b_, weights_b);
    if (!(std::abs(apart.x) <= tolerance_ && std::abs(apart.y) <= tolerance_)) return;
    if (apart.z <= contact_.lower) return;
    contact_.lower = apart.z, contact_.weights_a = weights_a, contact_.weights_b = weights_b;
  }

 private:
  const Triangle &a_, &b_;
  double tolerance_;
  LastContact& contact_;
};

/// The weights of the point of a triangle at the place of `p` across z, or near it.
Vec3 weights_at(const Triangle& t, const Vec3& p) {
  const Vec3 q0 = t.v0 - p, q1 = t.v1 - p, q2 = t.v2 - p;
  Vec3 weights{cross_2d(q1, q2), cross_2d(q2, q0), cross_2d(q0, q1)};
  if (weights.x + weights.y + weights.z < 0) weights = -weights;
  weights = max(weights, Vec3{});
  const double sum = weights.x + weights.y + weights.z;
  return sum > 0 ? weights * (1 / sum) : corner_weights(0);
}

/// The part of the way along an edge that is nearest to a point, across z.
double part_nearest(const Vec3& start, const Vec3& edge, const Vec3& p) {
  const double size = dot_2d(edge, edge);
  return size > 0 ? std::clamp(dot_2d(p - start, edge) / size, 0.0, 1.0) : 0;
}

}  // namespace

LastContact bound_last_contact(const Triangle& a, const Triangle& b, double error, double least) {
  LIMBER_ASSERT(error >= 0x1p-46 && is_finite(a.v0) && is_finite(b.v0));
  LastContact contact;
  contact.upper = std::numeric_limits<double>::infinity();
  Planes planes(a, b, error, contact);
  const std::array<Vec3, 3> edges_a = edges_of(a), edges_b = edges_of(b);
  bool are_beside = planes.are_beside(1, 0) || planes.are_beside(0, 1);
  for (const auto& edges : {edges_a, edges_b}) {
    for (const Vec3& e : edges) are_beside = are_beside || planes.are_beside(-e.y, e.x) || planes.are_beside(e.x, e.y);
  }
  if (are_beside) {
    contact.upper = LastContact::never;
    return contact;
  }
  planes.consider_across({0, 0, 1});
  planes.consider_across(cross(edges_a[0], edges_a[1])), planes.consider_across(cross(edges_b[0], edges_b[1]));
  for (const Vec3& e : edges_a) {
    if (contact.upper <= least) return contact;
    for (const Vec3& f : edges_b) planes.consider_across(cross(e, f));
  }
  for (const auto& edges : {edges_a, edges_b}) {
    for (const Vec3& e : edges) planes.consider_across({-e.x * e.z, -e.y * e.z, dot_2d(e, e)});
  }
  LIMBER_ASSERT(contact.upper < std::numeric_limits<double>::infinity());
  return contact;
}

void find_last_contact(const Triangle& a, const Triangle& b, double tolerance, LastContact& contact) {
  MeetingPoints points(a, b, tolerance, contact);
  const std::array<Vec3, 3> edges_a = edges_of(a), edges_b = edges_of(b);
  for (std::size_t i = 0; i < 3; ++i) {
    points.consider(corner_weights(i), weights_at(b, a[i]));
    points.consider(weights_at(a, b[i]), corner_weights(i));
    for (std::size_t j = 0; j < 3; ++j) {
      points.consider(corner_weights(i), corner_weights(j));
      points.consider(corner_weights(i), edge_weights(j, part_nearest(b[j], edges_b[j], a[i])));
      points.consider(edge_weights(j, part_nearest(a[j], edges_a[j], b[i])), corner_weights(i));
      const double across = cross_2d(edges_a[i], edges_b[j]);
      if (across == 0) continue;
      const Vec3 between = b[j] - a[i];
      const double s = cross_2d(between, edges_b[j]) / across, t = cross_2d(between, edges_a[i]) / across;
      points.consider(edge_weights(i, std::clamp(s, 0.0, 1.0)), edge_weights(j, std::clamp(t, 0.0, 1.0)));
    }
  }
}

}  // namespace limber::penetration

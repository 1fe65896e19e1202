// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// 1. Of two triangles: how far b moves along z until it leaves a. The translations with which b meets a, differences
//    p - q of points p of a and q of b, form a convex polyhedron D. How far b moves is where the z axis leaves D.
//      Upper bound  (max n.p - min n.q) / n.z, for any n with n.z > 0, however inexact. Normals of the facets of D are
//                   enough: of a face, or e x f of an edge of each. Where D is flat, its sides take their place: n is
//                   normal to an edge, and lies in the plane that the edge and z span.
//      Lower bound  from two points that meet.
// 2. Of two models: Sweep takes pairs of nodes, those that may meet last first, and asks the above of triangles.
#include "penetration/sweep.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "base/error_bounds.h"
#include "geometry/primitives.h"
#include "penetration/deepest_vertex.h"

namespace limber::penetration {
namespace {

using geometry::next_corner;

double lowest(const Vec3& n, const Triangle& t) { return std::min({dot(n, t.v0), dot(n, t.v1), dot(n, t.v2)}); }
double highest(const Vec3& n, const Triangle& t) { return std::max({dot(n, t.v0), dot(n, t.v1), dot(n, t.v2)}); }

// Shorter normals say nothing that rounding does not say as well.
constexpr double shortest_normal = 0x1p-100;

/// Lowers the upper bound of a contact by planes.
class Planes {
 public:
  Planes(const Triangle& a, const Triangle& b, double error, LastContact& contact)
      : a_(a), b_(b), error_(error), contact_(contact) {}

  /// Of a plane that b crosses on its way. The normal may point to either side.
  void consider_across(const Vec3& either) {
    const Vec3 n = either.z < 0 ? -either : either;
    if (!(n.z > 0) || max_abs(n) < shortest_normal) return;
    const double bound = overlap_along(n) / n.z;
    if (bound < contact_.upper) contact_.upper = bound, contact_.normal = n;
  }

  /// Whether a plane parallel to z, with this normal or its opposite, keeps the triangles apart for ever.
  bool keeps_apart(double x, double y) const {
    const double size = std::sqrt(x * x + y * y);
    if (size < shortest_normal) return false;
    const Vec3 n{x / size, y / size, 0};
    return overlap_along(n) < 0 || overlap_along(-n) < 0;
  }

 private:
  /// How far b reaches behind the highest point of a, at most. Roundings, in u = 2^-53 of the sum `size`: 2 * 3 u for
  /// the heights, 6 u for differences, the error and bounds / n.z. These 12 u < 2^-49 are at most 1/8 of the error,
  /// which is 2^-46 or more. The other 7/8 are for corners: those of a and of b may move by a third each, 2/3 together.
  double overlap_along(const Vec3& n) const {
    const double size = std::abs(n.x) + std::abs(n.y) + std::abs(n.z);
    return highest(n, a_) - lowest(n, b_) + error_ * size;
  }

  const Triangle &a_, &b_;
  double error_;
  LastContact& contact_;
};

std::array<Vec3, 3> edges_of(const Triangle& t) { return {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2}; }

double cross_2d(const Vec3& p, const Vec3& q) { return p.x * q.y - p.y * q.x; }
double dot_2d(const Vec3& p, const Vec3& q) { return p.x * q.x + p.y * q.y; }

Vec3 point_of(const Triangle& t, const Vec3& weights) { return weights.x * t.v0 + weights.y * t.v1 + weights.z * t.v2; }

/// The weights of a point of edge i, the part `s` of the way along it: with 0, of corner i.
Vec3 edge_weights(std::size_t i, double s) {
  Vec3 weights;
  weights[i] = 1 - s, weights[next_corner[i]] = s;
  return weights;
}

/// The weights of the point of a triangle at the place of `p` across z, or near it.
Vec3 weights_at(const Triangle& t, const Vec3& p) {
  const Vec3 q0 = t.v0 - p, q1 = t.v1 - p, q2 = t.v2 - p;
  Vec3 weights{cross_2d(q1, q2), cross_2d(q2, q0), cross_2d(q0, q1)};
  if (weights.x + weights.y + weights.z < 0) weights = -weights;
  weights = max(weights, Vec3{});
  const double sum = weights.x + weights.y + weights.z;
  return sum > 0 ? weights * (1 / sum) : edge_weights(0, 0);
}

/// The part of the way along an edge that is nearest to a point, across z.
double part_nearest(const Vec3& start, const Vec3& edge, const Vec3& p) {
  const double size = dot_2d(edge, edge);
  return size > 0 ? std::clamp(dot_2d(p - start, edge) / size, 0.0, 1.0) : 0;
}

Box box_of(const Triangle& t) { return {min(min(t.v0, t.v1), t.v2), max(max(t.v0, t.v1), t.v2)}; }

}  // namespace

LastContact bound_last_contact(const Triangle& a, const Triangle& b, double error, double least) {
  LIMBER_ASSERT(error >= 0x1p-46 && is_finite(a.v0) && is_finite(b.v0));  // see Planes::overlap_along()
  LastContact contact;
  contact.upper = std::numeric_limits<double>::infinity();
  Planes planes(a, b, error, contact);
  const std::array<Vec3, 3> edges_a = edges_of(a), edges_b = edges_of(b);
  bool are_beside = planes.keeps_apart(1, 0) || planes.keeps_apart(0, 1);
  for (const auto& edges : {edges_a, edges_b}) {
    for (const Vec3& e : edges) {
      are_beside = are_beside || planes.keeps_apart(-e.y, e.x) || planes.keeps_apart(e.x, e.y);
    }
  }
  if (are_beside) {
    contact.upper = LastContact::never;
    return contact;
  }
  planes.consider_across({0, 0, 1});
  planes.consider_across(cross(edges_a[0], edges_a[1]));
  planes.consider_across(cross(edges_b[0], edges_b[1]));
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
  const auto consider = [&](const Vec3& weights_a, const Vec3& weights_b) {
    const Vec3 apart = point_of(a, weights_a) - point_of(b, weights_b);
    if (!(std::abs(apart.x) <= tolerance && std::abs(apart.y) <= tolerance) || apart.z <= contact.lower) return;
    contact.lower = apart.z, contact.weights_a = weights_a, contact.weights_b = weights_b;
  };
  const std::array<Vec3, 3> edges_a = edges_of(a), edges_b = edges_of(b);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 corner = edge_weights(i, 0);
    consider(corner, weights_at(b, a[i]));
    consider(weights_at(a, b[i]), corner);
    for (std::size_t j = 0; j < 3; ++j) {
      consider(corner, edge_weights(j, 0));
      consider(corner, edge_weights(j, part_nearest(b[j], edges_b[j], a[i])));
      consider(edge_weights(j, part_nearest(a[j], edges_a[j], b[i])), corner);
      const double across = cross_2d(edges_a[i], edges_b[j]);
      if (across == 0) continue;
      const Vec3 between = b[j] - a[i];
      const double s = cross_2d(between, edges_b[j]) / across, t = cross_2d(between, edges_a[i]) / across;
      consider(edge_weights(i, std::clamp(s, 0.0, 1.0)), edge_weights(j, std::clamp(t, 0.0, 1.0)));
    }
  }
}

Sweep::Sweep(const point::PlacedModel& a, const point::PlacedModel& b) : a_{&a, {}, {}, {}}, b_{&b, {}, {}, {}} {
  const double magnitude = a.magnitude() + b.magnitude();
  // So coordinates of a and b together are less than 1 in size. The least magnitude keeps the scale finite.
  scale_ = std::ldexp(1.0, -std::ilogb(std::max(magnitude, 0x1p-1000)) - 1);
  error_ = base::placement_error;
  LIMBER_ASSERT(magnitude * scale_ <= 1);
}

void Sweep::set_direction(const Vec3& direction) {
  z_ = direction, x_ = perpendicular_to(direction), y_ = cross(z_, x_);
  for (Side* side : {&a_, &b_}) {
    // R^T z . p = z . R p, also for an R that is not quite orthonormal: so heights are those of placed points.
    const Mat3 to_model = transpose(side->model->pose().rotation);
    side->x = to_model * x_, side->y = to_model * y_, side->z = to_model * z_;
  }
}

SweepResult Sweep::along(const Vec3& direction, pair::Meter& meter, double enough) {
  LIMBER_ASSERT(std::abs(length_sq(direction) - 1) < 1e-12);
  set_direction(direction);
  best_ = {}, enough_ = enough * scale_, meter_ = &meter;
  waiting_.clear();
  const double bound = bound_of(project(a_, bvh::root_slot), project(b_, bvh::root_slot));
  if (bound > best_.upper) waiting_.push({bound, bvh::root_slot, bvh::root_slot});
  pair::NoObserver none;
  pair::PairWalk<pair::HeapOrder<Pair>, Sweep, Sweep>(waiting_, *this, *this, none).run();
  SweepResult found = best_;
  found.is_over = best_.lower >= enough_;
  found.lower /= scale_, found.upper /= scale_;
  LIMBER_ASSERT(found.lower >= 0 && (found.is_over || found.lower <= found.upper));
  return found;
}

Sweep::Projection Sweep::project(const Side& side, bvh::SlotId slot) const {
  const bvh::Tree& tree = side.model->tree();
  const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
  const std::uint32_t k = bvh::slot_of(slot);
  const double to_scaled = tree.unit * scale_ * base::outward, radius = n.radius[k];
  const Vec3 half{n.half_x[k], n.half_y[k], n.half_z[k]}, normal{n.normal_x[k], n.normal_y[k], n.normal_z[k]};
  // The slab bounds the part of a height along its normal, the sphere the rest.
  const double along = dot(normal, side.z), low = n.low[k], high = n.high[k];
  const double rest = length(side.z - along * normal) * radius;
  const double reach = std::min(radius * length(side.z), dot(abs(side.z), half));
  const double more = tree.slack * scale_ * base::outward + error_;
  // A height over the center may be below 0. Then its size has to become smaller, though to_scaled has made it larger
  // by the factor `outward`: two errors are taken off, one for the pose, and one that pays for `outward`.
  static_assert(base::outward * (1 - 2 * base::rigidity_error) < 1 - base::rigidity_error);
  const auto bounded = [&](double units) {
    return units * to_scaled * (1 + (units < 0 ? -2 : 1) * base::rigidity_error) + more;
  };
  return {scaled(side.model->pose()(bvh::slot_center(tree, slot))),
          bounded(radius),
          bounded(std::min(radius, dot(abs(side.x), half))),
          bounded(std::min(radius, dot(abs(side.y), half))),
          bounded(std::min(reach, std::max(along * low, along * high) + rest)),
          bounded(std::min(reach, std::max(-along * low, -along * high) + rest))};
}

/// How far b moves at most while two volumes may meet; below 0 if they never do.
double Sweep::bound_of(const Projection& a, const Projection& b) const {
  const Vec3 apart = a.center - b.center;
  const double radii = a.radius + b.radius, left = radii * radii - apart.x * apart.x - apart.y * apart.y;
  if (!(left >= 0)) return LastContact::never;
  if (std::abs(apart.x) > a.half_x + b.half_x || std::abs(apart.y) > a.half_y + b.half_y) return LastContact::never;
  return apart.z + std::min(a.up + b.down, std::sqrt(left) * base::outward) + error_;
}

template <bool raises>
pair::Next Sweep::open(Expansion& e, double&) const {
  const Projection of_a = project(a_, e.pair.a), of_b = project(b_, e.pair.b);
  e.opens_a = is_leaf(b_, e.pair.b) || (!is_leaf(a_, e.pair.a) && of_a.radius >= of_b.radius);
  e.node = e.opens_a ? bvh::child_of(a_.model->tree(), e.pair.a) : bvh::child_of(b_.model->tree(), e.pair.b);
  e.other = e.opens_a ? of_b : of_a;
  return pair::Next::opened;
}

void Sweep::bound_children(Expansion& e, float*) const {
  const std::uint32_t count = (e.opens_a ? a_ : b_).model->tree().nodes[e.node].child_count;
  meter_->stats.node_tests += count;
  e.kept.all = 0;
  for (std::uint32_t k = 0; k < count; ++k) {
    const bvh::SlotId child = e.node * bvh::width + k;
    const double bound = e.opens_a ? bound_of(project(a_, child), e.other) : bound_of(e.other, project(b_, child));
    e.bounds[k] = std::min(e.pair.bound, bound);
    e.kept.all |= (e.bounds[k] > best_.upper ? 1U : 0U) << k;
  }
}

bool Sweep::compare(const Pair& pair, bool, double&) {
  const bvh::Leaf& leaf_a = bvh::first_leaf(a_.model->tree(), pair.a).leaf;
  const bvh::Leaf& leaf_b = bvh::first_leaf(b_.model->tree(), pair.b).leaf;
  const auto triangles_of = [&](const Side& side, const bvh::Leaf& leaf) {
    std::array<Triangle, bvh::width> triangles;
    for (std::size_t k = 0; k < bvh::width; ++k) {
      const Triangle t = side.model->triangle(leaf.vertices[k]);
      triangles[k] = {scaled(t.v0), scaled(t.v1), scaled(t.v2)};
    }
    return triangles;
  };
  // Slots without a triangle repeat the last one: comparing it again changes nothing.
  const auto triangles_a = triangles_of(a_, leaf_a), triangles_b = triangles_of(b_, leaf_b);
  for (std::size_t i = 0; i < bvh::width; ++i) {
    const Box of_a = box_of(triangles_a[i]);
    for (std::size_t k = 0; k < bvh::width; ++k) {
      const Box of_b = box_of(triangles_b[k]);
      if (of_a.high.z - of_b.low.z + error_ <= best_.upper) continue;
      if (of_a.low.x - of_b.high.x > error_ || of_b.low.x - of_a.high.x > error_) continue;
      if (of_a.low.y - of_b.high.y > error_ || of_b.low.y - of_a.high.y > error_) continue;
      ++meter_->stats.primitive_tests;
      compare(leaf_a, i, triangles_a[i], leaf_b, k, triangles_b[k]);
    }
  }
  return true;
}

void Sweep::compare(const bvh::Leaf& leaf_a, std::size_t i, const Triangle& a, const bvh::Leaf& leaf_b, std::size_t k,
                    const Triangle& b) {
  LastContact contact = bound_last_contact(a, b, error_, best_.upper);
  if (!(contact.upper > best_.upper)) return;
  best_.upper = contact.upper;
  best_.normal = unit(contact.normal.x * x_ + contact.normal.y * y_ + contact.normal.z * z_);
  // Triangles that miss each other by error_ across z count as meeting; as much again is for the rounding of weights.
  find_last_contact(a, b, 2 * error_, contact);
  if (!(contact.lower > best_.lower)) return;
  best_.lower = std::min(contact.lower, best_.upper);
  best_.witness = Witness{point_of(a_.model->triangle(leaf_a.vertices[i]), contact.weights_a),
                          point_of(b_.model->triangle(leaf_b.vertices[k]), contact.weights_b), leaf_a.triangle[i],
                          leaf_b.triangle[k]};
}

}  // namespace limber::penetration

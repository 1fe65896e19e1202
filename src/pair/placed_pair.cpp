// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/placed_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/access.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "bvh/tree.h"
#include "geometry/local_frame.h"
#include "geometry/rigid.h"
#include "model/model_impl.h"

namespace limber::pair {
namespace {

// Vertices that are outside of the bounds by at most this part of the magnitude cannot make it much too large.
constexpr double small_slack = 1. / 16;

}  // namespace

PlacedPair::PlacedPair(const Placed& a, const Placed& b)
    : sides_{{&require_ready(a, "limber", "model a of a query").tree, Access::impl(a.model()).mesh, a.pose},
             {&require_ready(b, "limber", "model b of a query").tree, Access::impl(b.model()).mesh, b.pose}},
      is_placed_exactly_(a.pose == Transform{} && b.pose == Transform{}) {
  const double size = bvh::magnitude(tree(Side::a), a.pose) + bvh::magnitude(tree(Side::b), b.pose);
  error_ = base::placement_error * size;
  is_error_tight_ = !is_placed_exactly_ && slack() <= small_slack * size;
}

Triangle PlacedPair::placed(Side s, const Triangle& local) const {
  if (is_placed_exactly_) return local;
  const Transform& pose = at(s).pose;
  return {pose(local.v0), pose(local.v1), pose(local.v2)};
}

double PlacedPair::root_bound(double enough) const {
  const PlacedTree &a = at(Side::a), &b = at(Side::b);
  const Vec3 between =
      b.pose(bvh::slot_center(*b.tree, bvh::root_slot)) - a.pose(bvh::slot_center(*a.tree, bvh::root_slot));
  const double radius_a = bvh::root_radius(*a.tree), radius_b = bvh::root_radius(*b.tree);
  const double rounding = (bvh::sum_of_coordinates(between) + radius_a + radius_b) * base::root_error + error_;
  double best = geometry::safe_length(between) - radius_a - radius_b;
  if (best - rounding >= enough) return best - rounding;
  // The sphere of one next to the box and the slab of the other.
  best = std::max(best, bvh::root_gap(*a.tree, transpose(a.pose.rotation) * between) - radius_b);
  best = std::max(best, bvh::root_gap(*b.tree, transpose(b.pose.rotation) * -between) - radius_a);
  return std::max(0.0, best - rounding);
}

double PlacedPair::max_displacement(const Transform& before, double error_before, const Transform& after) const {
  const bvh::Tree &a = tree(Side::a), &b = tree(Side::b);
  const Vec3 center = bvh::slot_center(b, bvh::root_slot), center_a = bvh::slot_center(a, bvh::root_slot);
  const Mat3 &from = before.rotation, &to = after.rotation;
  const Vec3 center_before = before(center), center_after = after(center);
  // The difference of two rotations stretches a vector by at most its Frobenius norm over the root of 2.
  const double turned = std::sqrt(
      0.5 * (length_sq(to.row0 - from.row0) + length_sq(to.row1 - from.row1) + length_sq(to.row2 - from.row2)));
  const double size = geometry::safe_length(center_before - center_a) + geometry::safe_length(center_after - center_a) +
                      bvh::sum_of_coordinates(center) + bvh::root_radius(a) + bvh::root_radius(b);
  return base::distance_up(center_before, center_after) + turned * bvh::root_radius(b) + base::rigidity_error * size +
         2 * (error_before + error_);
}

namespace {

Transform relative(const Transform& own, const Transform& other) {
  const Mat3 back = geometry::inverse_of(own.rotation);
  return {back * other.rotation, back * (other.translation - own.translation)};
}

}  // namespace

void Frames::compute(Side s) {
  is_known_[index(s)] = true;
  simd::FrameTransform& t = transforms_[index(s)];
  const Transform from_other = relative(placed_.pose(s), placed_.pose(other(s)));
  const Mat3 columns = transpose(from_other.rotation);
  const Vec3 all[4] = {columns.row0, columns.row1, columns.row2, from_other.translation};
  for (std::size_t c = 0; c < 4; ++c) {
    for (std::size_t k = 0; k < 4; ++k) t.from_other[c][k] = k < 3 ? all[c][k] : 0;
  }
  for (std::size_t c = 0; c < 3; ++c) {
    for (std::size_t k = 0; k < 4; ++k) {
      t.rotation[c][k] = static_cast<float>(t.from_other[c][k]);
      t.rotation_abs[c][k] = std::abs(t.rotation[c][k]);
    }
  }
  t.unit = placed_.tree(s).unit;
  t.per_unit = 1 / t.unit;
  t.other_unit = placed_.tree(other(s)).unit;
  t.ratio = static_cast<float>(base::or_infinite(t.other_unit * t.per_unit));
  t.error = placed_.error() + placed_.slack();
  t.error_units = base::float_up(base::or_infinite(t.error * t.per_unit)) + base::smallest_error_units;
}

Transform Frames::a_from_b() {
  const auto& columns = of(Side::a).from_other;
  const auto column = [&](std::size_t c) { return Vec3{columns[c][0], columns[c][1], columns[c][2]}; };
  return {transpose(Mat3{column(0), column(1), column(2)}), column(3)};
}

namespace {

using Vertices = std::array<VertexId, 3>;

bool has(const Vertices& vertices, VertexId v) { return vertices[0] == v || vertices[1] == v || vertices[2] == v; }

/// The vertices that triangles have in common.
class CommonVertices {
 public:
  explicit CommonVertices(const Vertices& first) : ids_(first), count_(3) {}

  void keep_those_of(const Vertices& vertices) {
    std::uint32_t kept = 0;
    for (std::uint32_t i = 0; i < count_; ++i) {
      if (has(vertices, ids_[i])) ids_[kept++] = ids_[i];
    }
    count_ = kept;
  }
  std::uint32_t count() const { return count_; }
  VertexId operator[](std::uint32_t i) const { return ids_[i]; }
  bool contains(VertexId v) const { return std::find(ids_.begin(), ids_.begin() + count_, v) != ids_.begin() + count_; }

 private:
  Vertices ids_;
  std::uint32_t count_;
};

/// Visits the vertices of every triangle below a slot, until `visit` returns false.
template <typename Visit>
bool visit_triangles(const bvh::Tree& tree, const bvh::Subtree& subtree, const Visit& visit) {
  for (std::uint32_t i = subtree.first_leaf; i < subtree.end_leaf; ++i) {
    for (const Vertices& vertices : tree.leaves[i].vertices) {
      if (!visit(vertices)) return false;
    }
  }
  return true;
}

/// Where the other vertices of some triangles are along a direction, relative to a common vertex.
struct Range {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  Vec3 lowest, highest;
  VertexId lowest_id = no_id, highest_id = no_id;
  double longest = 0;  // the largest coordinate
};

/// Looks for a plane through the common vertices that has the triangles of either subtree on its own side.
class PlaneBetween {
 public:
  PlaneBetween(const PlacedPair& placed, const CommonVertices& common, const bvh::Subtree& a, const bvh::Subtree& b)
      : placed_(placed), common_(common), origin_(placed.local_position(Side::a, common[0])), subtrees_{a, b} {
    if (common.count() == 2) edge_ = placed.local_position(Side::a, common[1]) - origin_;
    edge_direction_ = unit(edge_);
  }

  /// Whether such a plane is found by the perceptron rule: its normal is turned towards the vertices that are farthest
  /// on the wrong side.
  bool exists(Apart what, double margin) const {
    constexpr int most_turns = 12;
    if (edge_ != Vec3{} && edge_direction_ == Vec3{}) return false;  // too short for a direction
    Vec3 normal = unit(beside_edge(mean(0) - mean(1)));
    for (int turn = 0; turn < most_turns && normal != Vec3{}; ++turn) {
      const Range a = range(0, normal), b = range(1, normal);
      if (separates(normal, a, b, what, margin)) return true;
      if (a.lowest_id == b.highest_id) return false;  // some triangles share that vertex, too
      normal = unit(beside_edge(normal + unit(a.lowest) - unit(b.highest)));
    }
    return false;
  }

 private:
  // Products of coordinates between these neither underflow nor overflow.
  static constexpr double smallest = 0x1p-400, largest = 0x1p400;

  /// 0 if the vector is too short.
  static Vec3 unit(const Vec3& v) { return max_abs(v) < smallest ? Vec3{} : v * (1 / geometry::safe_length(v)); }
  /// Without its part along the common edge, if there is one.
  Vec3 beside_edge(const Vec3& v) const { return v - dot(edge_direction_, v) * edge_direction_; }

  template <typename Visit>
  void visit_others(std::size_t side, const Visit& visit) const {
    visit_triangles(placed_.tree(Side::a), subtrees_[side], [&](const Vertices& vertices) {
      for (const VertexId v : vertices) {
        if (!common_.contains(v)) visit(v, placed_.local_position(Side::a, v) - origin_);
      }
      return true;
    });
  }
  Vec3 mean(std::size_t side) const {
    Vec3 sum;
    visit_others(side, [&](VertexId, const Vec3& p) { sum += p; });
    return unit(sum);
  }
  Range range(std::size_t side, const Vec3& normal) const {
    Range r;
    visit_others(side, [&](VertexId v, const Vec3& p) {
      const double height = dot(normal, p);
      r.longest = std::max(r.longest, max_abs(p));
      if (height < r.low) r.low = height, r.lowest = p, r.lowest_id = v;
      if (height > r.high) r.high = height, r.highest = p, r.highest_id = v;
    });
    return r;
  }

  /// Whether the plane is certainly between the two, also if its normal is not quite perpendicular to the common edge:
  /// what lies along the edge is then at most `tilt` times its length beside the plane.
  bool separates(const Vec3& normal, const Range& a, const Range& b, Apart what, double margin) const {
    const double longest = std::max({a.longest, b.longest, max_abs(edge_)});
    if (longest < smallest || longest > largest) return false;
    const double tilt = std::abs(dot(normal, edge_direction_)) + base::fan_error;
    const double error = (2 * tilt + base::fan_error) * longest;
    const double above = a.low - error, below = -b.high - error;
    if (above <= 0 || below <= 0) return false;
    if (what == Apart::triangles) return true;
    const double reach = margin * base::outward;
    if (above <= reach || below <= reach) return false;
    if (edge_ == Vec3{}) return common_.count() == 1;
    // Edges from one end of the common edge to a, and from its other end to b, can be that close only this near to it.
    const double near_ends = 4 * longest * (1 / above + 1 / below) * (reach + error);
    return geometry::safe_length(edge_) > (reach + near_ends) * base::outward;
  }

  const PlacedPair& placed_;
  const CommonVertices& common_;
  Vec3 origin_, edge_, edge_direction_;
  bvh::Subtree subtrees_[2];
};

}  // namespace

bool share_and_are_apart(const PlacedPair& placed, bvh::SlotId a, bvh::SlotId b, Apart what, double margin) {
  const bvh::Tree& tree = placed.tree(Side::a);
  LIMBER_ASSERT(&tree == &placed.tree(Side::b) && placed.is_placed_exactly() && margin >= 0);
  const bvh::Subtree subtrees[2] = {bvh::subtree_of(tree, a), bvh::subtree_of(tree, b)};
  CommonVertices common(tree.leaves[subtrees[0].first_leaf].vertices[0]);
  // Nearly always the last triangles share nothing with the first.
  for (const bvh::Subtree& subtree : subtrees) common.keep_those_of(tree.leaves[subtree.end_leaf - 1].vertices[0]);
  for (const bvh::Subtree& subtree : subtrees) {
    const bool goes_on = visit_triangles(tree, subtree, [&](const Vertices& v) {
      common.keep_those_of(v);
      return common.count() > 0 && v[0] != v[1] && v[1] != v[2] && v[2] != v[0];
    });
    if (!goes_on) return false;
  }
  return common.count() == 3 || PlaneBetween(placed, common, subtrees[0], subtrees[1]).exists(what, margin);
}

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/flat_seed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "bvh/tree.h"
#include "limber/distance.h"
#include "simd/kernels.h"

namespace limber::pair {
namespace {

// A slot is flat if its slab is thinner than the other model's radius times this (docs/algorithms/traversal.md, "Flat
// parts").
constexpr double flat_thickness = 1. / 64;
// Of vertices whose heights differ by less than the radius times this, any will do: float32 bounds, with errors of some
// 2^-19 of the radius, cannot tell which is higher.
constexpr float negligible_height = 0x1p-18F;
// Nodes and leaves that a search takes at most. It goes straight down first, so it always finds something.
constexpr int most_visits = 32;
constexpr float infinite = std::numeric_limits<float>::infinity();

double radius_of(const bvh::Tree& tree, bvh::SlotId slot) {
  return tree.unit * static_cast<double>(tree.nodes[bvh::node_of(slot)].bounds.radius[bvh::slot_of(slot)]);
}
double thickness_of(const bvh::Tree& tree, bvh::SlotId slot) {
  const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
  return tree.unit * static_cast<double>(n.high[bvh::slot_of(slot)] - n.low[bvh::slot_of(slot)]);
}
Vec3 normal_of(const bvh::Tree& tree, bvh::SlotId slot) {
  const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
  const std::uint32_t k = bvh::slot_of(slot);
  return {n.normal_x[k], n.normal_y[k], n.normal_z[k]};
}

/// An upper bound of how far a model reaches from the center of its root slot along a direction of its frame, by sphere
/// and box: its slab is rarely turned that way.
double most_reach(const bvh::Tree& tree, const Vec3& direction) {
  const bvh::ChildBounds& n = tree.nodes[0].bounds;
  const Vec3 half{n.half_x[0], n.half_y[0], n.half_z[0]};
  return tree.unit * std::min(static_cast<double>(n.radius[0]), dot(abs(direction), half));
}

/// The highest of a slot and its ancestors whose slabs, from the slot up, are all at most that thick.
std::optional<bvh::SlotId> largest_flat(const bvh::Tree& tree, bvh::SlotId slot, double thickness) {
  std::optional<bvh::SlotId> flat;
  while (thickness_of(tree, slot) <= thickness) {
    flat = slot;
    if (slot == bvh::root_slot) break;
    slot = tree.nodes[bvh::node_of(slot)].parent;
  }
  return flat;
}

/// Searches for the vertex of a model that is farthest along a direction of its frame.
class FarthestVertex {
 public:
  FarthestVertex(const PlacedPair& placed, Side s, const Vec3& direction)
      : placed_(placed), direction_(direction), side_(s) {
    const bvh::Tree& tree = placed.tree(s);
    const Vec3 base = bvh::slot_center(tree, bvh::root_slot);
    // As a point infinitely far away in that direction: the kernel then bounds children by their heights along it.
    along_.unit = tree.unit, along_.per_unit = 1 / tree.unit;
    along_.is_far = true;
    for (std::size_t k = 0; k < 3; ++k) {
      along_.direction[k] = direction[k], along_.base[k] = base[k];
      along_.direction32[k] = static_cast<float>(direction[k]);
    }
    base_height_ = dot(direction, base);
    tolerance_ = negligible_height * tree.nodes[0].bounds.radius[0];
  }

  /// Children whose bound is above this are pruned. Bounds are heights here, in units, with the sign turned round, so
  /// that the highest child comes first.
  float limit() const { return limit_; }
  TriangleId triangle() const { return triangle_; }
  const Vec3& position() const { return position_; }

  void bound(const bvh::Node& node, simd::ChildrenInOrder& found) const {
    simd::kernels().bound_children_along(node, along_, limit_, found);
  }
  void compare(const bvh::LeafInNode& at) {
    for (std::uint32_t k = 0; k < bvh::width; ++k) {
      for (const VertexId v : at.leaf.vertices[k]) {
        const Vec3& p = placed_.local_position(side_, v);
        const double height = dot(direction_, p) - base_height_;
        if (height > height_) height_ = height, position_ = p, triangle_ = at.leaf.triangle[k];
      }
    }
    limit_ = static_cast<float>(-height_ * along_.per_unit) - tolerance_;
  }

 private:
  simd::QueryPoint along_{};
  const PlacedPair& placed_;
  Vec3 direction_, position_;
  double base_height_, height_ = -std::numeric_limits<double>::infinity();
  Side side_;
  TriangleId triangle_ = 0;
  float limit_ = std::numeric_limits<float>::max(), tolerance_;
};

/// Searches for a triangle of a model near a point of its frame: the one of least lower bound.
class NearTriangle {
 public:
  NearTriangle(const bvh::Tree& tree, const Vec3& point) {
    for (std::size_t k = 0; k < 3; ++k) point_.position[k] = point[k];
    point_.unit = tree.unit, point_.per_unit = 1 / tree.unit;
  }

  /// Children whose bound is above this are pruned. Bounds are squared distances here, in squared units.
  float limit() const { return limit_; }
  TriangleId triangle() const { return triangle_; }

  void bound(const bvh::Node& node, simd::ChildrenInOrder& found) {
    simd::kernels().bound_children_to_point(node, point_, limit_, found);
    limit_ = std::min(limit_, found.upper * found.upper);
  }
  void compare(const bvh::LeafInNode& at) {
    simd::TriangleIntervals found;
    const double length = std::sqrt(static_cast<double>(limit_)) * point_.unit;
    simd::kernels().bound_triangles_to_point(at.node, at.slot, at.leaf.corners, point_, length, found);
    for (; found.kept != 0; found.kept &= found.kept - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(found.kept));
      const double lower = static_cast<double>(found.lower[k]) * found.step;
      if (lower < least_) least_ = lower, triangle_ = at.leaf.triangle[k];
    }
    const auto upper = static_cast<float>(static_cast<double>(found.upper) * found.step * point_.per_unit);
    limit_ = std::min(limit_, upper * upper);
  }

 private:
  simd::QueryPoint point_{};
  double least_ = std::numeric_limits<double>::infinity();
  TriangleId triangle_ = 0;
  float limit_ = std::numeric_limits<float>::max();
};

/// Whether a search does not go below a slot: it has a leaf, or all its triangles coincided at the last refit. If they
/// have moved since, the guess is a little worse.
bool is_searched_as_leaf(const bvh::Tree& tree, bvh::SlotId slot) {
  return bvh::has_leaf(tree, slot) || bvh::is_coincident(tree, slot);
}

/// Visits leaves of a tree, the best first, until none is left that may be better, or the visits are used up. `goal`
/// says what is looked for: it bounds children and compares leaves.
template <typename Goal>
void search_tree(const bvh::Tree& tree, Goal& goal, QueryStats& stats) {
  bvh::SlotStack waiting;
  waiting.start(-infinite);
  bvh::SlotStack::Entry next;
  for (int visits = 0; visits < most_visits && waiting.take(goal.limit(), next); ++visits) {
    if (is_searched_as_leaf(tree, next.slot)) {
      goal.compare(bvh::first_leaf(tree, next.slot));
      continue;
    }
    const std::uint32_t n = bvh::child_of(tree, next.slot);
    const bvh::Node& node = tree.nodes[n];
    stats.node_tests += node.child_count;
    simd::ChildrenInOrder found;
    goal.bound(node, found);
    waiting.add(n, found);
  }
}

}  // namespace

std::optional<FlatPart> flat_part(const PlacedPair& placed, bvh::SlotId near_a, bvh::SlotId near_b) {
  const double radius_a = radius_of(placed.tree(Side::a), bvh::root_slot);
  const double radius_b = radius_of(placed.tree(Side::b), bvh::root_slot);
  const Side ground = radius_a >= radius_b ? Side::a : Side::b, above = other(ground);
  const double radius = std::min(radius_a, radius_b);
  const bvh::Tree &tree = placed.tree(ground), &tree_above = placed.tree(above);
  const auto slot = largest_flat(tree, ground == Side::a ? near_a : near_b, flat_thickness * radius);
  if (!slot || radius_of(tree, *slot) < radius) return std::nullopt;
  FlatPart part;
  part.side = ground;
  part.center = placed.pose(ground)(bvh::slot_center(tree, *slot));
  part.normal = placed.pose(ground).rotation * normal_of(tree, *slot);
  part.radius = radius;
  const Transform& pose = placed.pose(above);
  const double height = dot(part.normal, pose(bvh::slot_center(tree_above, bvh::root_slot)) - part.center);
  if (height < 0) part.normal = -part.normal;
  part.room = std::abs(height) - most_reach(tree_above, transpose(pose.rotation) * part.normal);
  return part;
}

std::optional<TrianglePair> likely_pair(const PlacedPair& placed, const FlatPart& part, QueryStats& stats) {
  const Side ground = part.side, above = other(ground);
  const Transform &pose = placed.pose(ground), &pose_above = placed.pose(above);
  FarthestVertex lowest(placed, above, transpose(pose_above.rotation) * -part.normal);
  search_tree(placed.tree(above), lowest, stats);
  const Vec3 vertex = pose_above(lowest.position());
  const double height = dot(part.normal, vertex - part.center);
  if (height <= 0) return std::nullopt;
  const Vec3 foot = vertex - height * part.normal;
  NearTriangle nearest(placed.tree(ground), transpose(pose.rotation) * (foot - pose.translation));
  search_tree(placed.tree(ground), nearest, stats);
  return ground == Side::a ? TrianglePair{nearest.triangle(), lowest.triangle()}
                           : TrianglePair{lowest.triangle(), nearest.triangle()};
}

}  // namespace limber::pair

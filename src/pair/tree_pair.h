// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "bvh/tree.h"
#include "pair/bucket_queue.h"
#include "pair/common_vertices.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

/// The trees of two placed models, and what a traversal asks about a pair of their child slots.
///
/// `tells_coincident_apart` is for traversals that need every pair: triangles that coincide are pairs of their own.
template <bool tells_coincident_apart>
class TreePair {
 public:
  explicit TreePair(const PlacedPair& placed) : placed_(placed) {}

  const bvh::Tree& tree(Side s) const { return placed_.tree(s); }

  /// Whether a slot is not expanded: it has a leaf, or all triangles below it coincide, so that any leaf below stands
  /// for it and no bound could tell them apart. With a motion margin, vertices may have moved since they coincided.
  [[gnu::always_inline]] bool is_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    const bvh::Tree& tree = placed_.tree(s);
    if constexpr (tells_coincident_apart) {
      return bvh::has_leaf(tree, slot);
    } else {
      return bvh::has_leaf(tree, slot) || (bvh::is_coincident(tree, slot) && tree.slack == 0);
    }
  }
  bool are_leaves(const NodePair& pair) const { return is_leaf(Side::a, pair) && is_leaf(Side::b, pair); }

  /// The slot of the leaf that such a slot has or stands for. Pre: is_leaf().
  bvh::SlotId leaf_slot(Side s, const NodePair& pair) const {
    LIMBER_ASSERT(is_leaf(s, pair));
    return bvh::first_leaf_slot(placed_.tree(s), pair.slot[index(s)]);
  }
  const bvh::Leaf& leaf(Side s, const NodePair& pair) const {
    return bvh::leaf_of(placed_.tree(s), leaf_slot(s, pair));
  }

  /// A slot as the kernels take it, without triangles and with those of its leaf.
  simd::SlotRef as_node(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    return {&placed_.tree(s).nodes[bvh::node_of(slot)], bvh::slot_of(slot), nullptr};
  }
  [[gnu::always_inline]] simd::SlotRef as_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = placed_.tree(s);
    const bvh::Leaf& leaf = bvh::leaf_of(tree, slot);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &leaf.corners, triangle_count(s, leaf)};
  }
  /// With the triangles of its leaf if the slot is not expanded; then their number does not matter.
  simd::SlotRef as_other(Side s, const NodePair& pair) const {
    if (!is_leaf(s, pair)) return as_node(s, pair);
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = placed_.tree(s);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &bvh::leaf_of(tree, slot).corners};
  }

  /// How much the bound of a slot leaves open: half the thickness of its slab, and a little of its radius. Of two nodes
  /// the one of higher priority is expanded.
  double split_priority(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    const bvh::Tree& tree = placed_.tree(s);
    const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
    const std::uint32_t k = bvh::slot_of(slot);
    return tree.unit * static_cast<double>((n.high[k] - n.low[k]) * 0.5F + share_of_radius * n.radius[k]);
  }

  struct Choice {
    Side side;             ///< whose node is expanded
    bool triangles_first;  ///< whether the other node would be, by its priority, but is a leaf, and the bound is loose
  };
  /// Chooses the node of higher split priority, if it can be expanded. If it is a leaf, and the bound of the pair is
  /// small next to that priority, its triangles, one by one, tell more than the children of the other node do.
  /// Pre: are_leaves() is false.
  [[gnu::always_inline]] Choice choose(const NodePair& pair) const {
    const double priority_a = split_priority(Side::a, pair), priority_b = split_priority(Side::b, pair);
    const bool is_a_first = priority_a >= priority_b;
    // Bitwise: branches here would be mispredicted.
    const bool is_leaf_a = is_leaf(Side::a, pair), is_leaf_b = is_leaf(Side::b, pair);
    const bool is_a = (static_cast<int>(is_a_first) | static_cast<int>(is_leaf_b)) > static_cast<int>(is_leaf_a);
    const double loose = loose_priorities * std::max(priority_a, priority_b) / tree(Side::a).unit;
    const bool is_loose = static_cast<double>(pair.bound_sq) < loose * loose;
    return {is_a ? Side::a : Side::b, is_a != is_a_first && is_loose};
  }

  /// For one model: whether all triangles below two slots share a vertex or an edge, as those of a fan or a book do,
  /// and have nothing else in common, so that they need not be compared. Leaves are too small for this test to pay.
  /// Under a pose nothing is said: the test does not know by how much placing rounds.
  bool share_and_are_apart(const NodePair& pair, Apart what, double margin) const {
    if (!placed_.is_placed_exactly()) return false;
    const bvh::Tree& tree = placed_.tree(Side::a);
    if (bvh::has_leaf(tree, pair.slot[0]) || bvh::has_leaf(tree, pair.slot[1])) return false;
    return pair::share_and_are_apart(placed_, pair.slot[0], pair.slot[1], what, margin);
  }

 private:
  static constexpr float share_of_radius = 0.01F;  // (docs/algorithms/traversal.md)
  // A bound below that many times the priority of a leaf is loose. With 1, distances in a room and a maze take twice as
  // long; without a limit, those of a ball far over a square take 1.17 times as long.
  static constexpr double loose_priorities = 2;

  /// All leaves but the last are full (I2).
  std::uint32_t triangle_count(Side s, const bvh::Leaf& leaf) const {
    const auto& leaves = placed_.tree(s).leaves;
    if (&leaf != &leaves.back()) return bvh::width;
    const std::size_t count = placed_.mesh(s).triangles.size() - bvh::width * (leaves.size() - 1);
    LIMBER_ASSERT(count > 0 && count <= bvh::width && leaf.triangle[count - 1] == leaf.triangle[bvh::width - 1]);
    return static_cast<std::uint32_t>(count);
  }

  const PlacedPair& placed_;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

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
  explicit TreePair(const PlacedPair& placed)
      : placed_(placed), is_single_{is_single(placed.tree(Side::a)), is_single(placed.tree(Side::b))} {}

  const bvh::Tree& tree(Side s) const { return placed_.tree(s); }

  /// Whether a slot is not expanded: it has a leaf, or all triangles below it coincide, so that any leaf below stands
  /// for it and no bound could tell them apart. With a motion margin, vertices may have moved since they coincided.
  bool is_leaf(Side s, const NodePair& pair) const {
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
  simd::SlotRef as_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = placed_.tree(s);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &bvh::leaf_of(tree, slot).corners,
            is_single_[index(s)]};
  }
  /// With the triangles of its leaf if the slot is not expanded.
  simd::SlotRef as_other(Side s, const NodePair& pair) const {
    return is_leaf(s, pair) ? as_leaf(s, pair) : as_node(s, pair);
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
  Choice choose(const NodePair& pair) const {
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

  /// Whether a tree has one triangle alone, as the core of a sphere has, which fills all slots of its leaf.
  static bool is_single(const bvh::Tree& tree) {
    const auto& triangles = tree.leaves[0].triangle;
    return tree.nodes.size() == 1 && tree.leaves.size() == 1 && triangles[0] == triangles[bvh::width - 1];
  }

  const PlacedPair& placed_;
  bool is_single_[2];
};

}  // namespace limber::pair

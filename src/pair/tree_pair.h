// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "bvh/tree.h"
#include "pair/node_pair.h"
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
  [[gnu::always_inline]] bvh::SlotId leaf_slot(Side s, const NodePair& pair) const {
    LIMBER_ASSERT(is_leaf(s, pair));
    return bvh::first_leaf_slot(placed_.tree(s), pair.slot[index(s)]);
  }
  [[gnu::always_inline]] const bvh::Leaf& leaf(Side s, const NodePair& pair) const {
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

 private:
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

#include "base/check.h"
#include "bvh/tree.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

/// Squared bounds of pairs are below the second, so that they are below a limit that prunes nothing.
inline constexpr float no_limit_sq = 3e38F, largest_bound_sq = 2e38F;

/// Two slots whose subtrees are still to be compared, or all that a record of a front has not expanded.
struct NodePair {
  static constexpr std::uint16_t no_record = 0xffff;
  static constexpr std::uint8_t whole_record = 0xff;

  float bound_sq;  ///< squared lower bound of their distance, in squared units of a's tree; 0 when nothing is proven
  bvh::SlotId slot[2];
  std::uint16_t record;  ///< the Front::Record of the expansion it comes from
  std::uint8_t child;    ///< of that expansion, or whole_record; then `slot` is not used
  bool is_bounded : 1;   ///< by the triangles of a leaf, see NodeBounds::open()
  bool is_a_larger : 1;  ///< whether the node of a has the higher split priority, see NodeBounds::open()

  static NodePair of(bvh::SlotId a, bvh::SlotId b, float bound_sq) {
    return {bound_sq, {a, b}, no_record, 0, false, true};
  }
  /// A slot of one model with itself.
  static NodePair itself(bvh::SlotId slot) { return of(slot, slot, 0); }
  /// All that a record has not expanded.
  static NodePair of_record(std::uint16_t record, float bound_sq) {
    return {bound_sq, {bvh::root_slot, bvh::root_slot}, record, whole_record, false, true};
  }
};

/// The expansion of one node of a pair: its children are compared with the other node.
struct Expansion {
  Side side;  ///< of the slot of `pair` that is expanded
  NodePair pair;
  std::uint32_t node;    ///< the child of that slot: its children are compared with the other slot
  std::uint16_t record;  ///< of the front: this expansion's, or that of `pair` where the front is full
  bool has_record;       ///< whether this expansion has a record of its own
  unsigned children;     ///< to be compared, a bit mask
  simd::KeptSlots kept;  ///< not pruned
  /// Squared bounds in units of the tree of `side`; negative where volumes overlap.
  alignas(32) float order[bvh::width];

  /// Begins the expansion of one slot of a pair: all its children are to be compared, and the front has no record of it
  /// yet. `tree` is that of side `s`. Pre: the slot has no leaf.
  void start(const bvh::Tree& tree, const NodePair& expanded, Side s) {
    pair = expanded;
    side = s;
    node = bvh::child_of(tree, pair.slot[index(side)]);
    children = (1U << tree.nodes[node].child_count) - 1;
    record = NodePair::no_record;
    has_record = false;
  }

  /// For one model: pairs a slot with each later child slot of the same node, which has `count` children. `node` is
  /// that node.
  void start_siblings(bvh::SlotId slot, std::uint32_t count) {
    pair = NodePair::of(slot, bvh::root_slot, 0);
    side = Side::b, node = bvh::node_of(slot);
    children = (1U << count) - (2U << bvh::slot_of(slot));
    record = NodePair::no_record, has_record = false;
  }

  /// The child of least order in a mask. Pre: the mask is not empty.
  std::uint32_t first_of(unsigned mask) const {
    LIMBER_ASSERT(mask != 0);
    auto first = static_cast<std::uint32_t>(std::countr_zero(mask));
    for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (order[child] < order[first]) first = child;
    }
    return first;
  }
  /// The child of greatest order in a mask; the last of equal ones. Pre: the mask is not empty.
  std::uint32_t last_of(unsigned mask) const {
    LIMBER_ASSERT(mask != 0);
    auto last = static_cast<std::uint32_t>(std::countr_zero(mask));
    for (unsigned rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (order[child] >= order[last]) last = child;
    }
    return last;
  }
  /// The deepest overlap, or the nearest child if none overlaps. Pre: a child is kept.
  std::uint32_t first_child() const { return first_of(kept.overlapping != 0 ? kept.overlapping : kept.all); }

  /// The pair of a child and the other node, with a squared lower bound of their distance.
  NodePair child_pair(std::uint32_t child, float bound_sq) const {
    const bvh::SlotId slot = node * bvh::width + child;
    const bool of_a = side == Side::a;
    const auto child_of_record = static_cast<std::uint8_t>(has_record ? child : pair.child);
    return {bound_sq, {of_a ? slot : pair.slot[0], of_a ? pair.slot[1] : slot}, record, child_of_record, false, true};
  }
};

}  // namespace limber::pair

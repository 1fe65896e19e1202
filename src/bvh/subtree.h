// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "base/check.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// A subtree and its leaves, those from `first_leaf` up to `end_leaf`.
struct Subtree {
  SlotId slot;
  std::uint32_t first_leaf, end_leaf;
};

inline Subtree subtree_of(const Tree& tree, SlotId slot) {
  LIMBER_ASSERT(slot_of(slot) < tree.nodes[node_of(slot)].child_count);
  SlotId first = slot, last = slot;
  while (node_of(first) < tree.first_lowest_node()) {
    first = (tree.nodes[node_of(first)].first_child + slot_of(first)) * width;
    const std::uint32_t node = tree.nodes[node_of(last)].first_child + slot_of(last);
    last = node * width + tree.nodes[node].child_count - 1;
  }
  return {slot, tree.nodes[node_of(first)].first_child + slot_of(first),
          tree.nodes[node_of(last)].first_child + slot_of(last) + 1};
}

}  // namespace limber::bvh

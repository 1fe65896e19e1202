// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "bvh/tree.h"

namespace limber::pair {

/// Two slots whose subtrees are still to be compared, or all that a record of a front has not expanded.
struct NodePair {
  static constexpr std::uint16_t no_record = 0xffff;
  static constexpr std::uint8_t whole_record = 0xff;

  float bound_sq;  ///< squared lower bound of their distance, in squared units of a's tree; 0 when nothing is proven
  bvh::SlotId slot[2];
  std::uint16_t record;  ///< the Front::Record of the expansion it comes from
  std::uint8_t child;    ///< of that expansion, or whole_record; then `slot` is not used
  bool is_bounded;       ///< by the triangles of a leaf, see NodeBounds::open()

  static NodePair of(bvh::SlotId a, bvh::SlotId b, float bound_sq) { return {bound_sq, {a, b}, no_record, 0, false}; }
  static NodePair roots(float bound_sq) { return of(bvh::root_slot, bvh::root_slot, bound_sq); }
  /// A slot of one model with itself.
  static NodePair itself(bvh::SlotId slot) { return of(slot, slot, 0); }
  /// All that a record has not expanded.
  static NodePair of_record(std::uint16_t record, float bound_sq) {
    return {bound_sq, {bvh::root_slot, bvh::root_slot}, record, whole_record, false};
  }
};

}  // namespace limber::pair

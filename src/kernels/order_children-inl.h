// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Lines up the children of a node by their bounds, without a branch that nobody could predict.

#if defined(LIMBER_SIMD_ORDER_CHILDREN_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_ORDER_CHILDREN_INL_H
#undef LIMBER_SIMD_ORDER_CHILDREN_INL_H
#else
#define LIMBER_SIMD_ORDER_CHILDREN_INL_H
#endif

#include <cstdint>
#include <limits>

#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Numbers from here to its double are whole, so their last bits count.
inline constexpr float counts_from = 0x1p23F;

/// The number of each child, and infinity for slots from `child_count` on. The slots are `i` and following.
LIMBER_KERNEL Packet infinite_unless_child(Packet x, std::uint32_t i, std::uint32_t child_count) {
  alignas(64) static constexpr float number[width] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Mask is_child = Packet::load(number + i) < Packet::set(static_cast<float>(child_count));
  return select(is_child, x, Packet::set(std::numeric_limits<float>::infinity()));
}

/// Finds which children have a bound of at most `limit`, and their places. Pre: the limit is finite.
LIMBER_KERNEL void order_children(float limit, ChildrenInOrder& children) {
  alignas(64) float key[width];
  unsigned kept = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet bound = Packet::load(children.bound + i);
    const Mask is_kept = bound <= Packet::set(limit);
    kept |= bits(is_kept) << i;
    numbered(select(is_kept, bound, Packet::set(-far_off)), i).store(key + i);
  }
  children.kept = kept;
  const Packet one = Packet::set(1);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet own = Packet::load(key + i);
    Packet even = Packet::set(counts_from), odd = zero();
    for (std::uint32_t k = 0; k < width; k += 2) {
      even = even + select(Packet::set(key[k]) > own, one, zero());
      odd = odd + select(Packet::set(key[k + 1]) > own, one, zero());
    }
    (even + odd).store(children.place_in_bits + i);
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

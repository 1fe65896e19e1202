// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

#include "base/check.h"
#include "bvh/tree.h"
#include "simd/kernels.h"

namespace limber::bvh {

/// The child slots of one tree that a depth-first search has still to take, the nearest last.
class SlotStack {
 public:
  struct Entry {
    float bound;  // in the measure of the kernel
    SlotId slot;
    std::uint32_t siblings;  // where the entries of its siblings begin
  };

  void start(float bound_of_root) { entries_[0] = {bound_of_root, root_slot, 0}, count_ = 1; }

  /// Takes the next slot whose bound is at most the limit, and drops those before it. False if no slot is left.
  bool take(float limit, Entry& next) {
    while (count_ > 0) {
      next = entries_[count_ - 1];
      if (next.bound <= limit) {
        --count_;
        return true;
      }
      count_ = next.siblings;  // which are no nearer
    }
    return false;
  }

  /// Adds the children of a node that a kernel has kept, the nearest last.
  void add(std::uint32_t node, const simd::ChildrenInOrder& children) {
    LIMBER_ASSERT(count_ + width <= capacity);
    const std::uint32_t first = count_;
    for (std::uint32_t k = 0; k < width; ++k) {
      entries_[first + children.place_of(k)] = {children.bound[k], node * width + k, first};
    }
    count_ += static_cast<std::uint32_t>(std::popcount(children.kept));
  }
  /// Adds children of a node, as a bit mask, whose bounds are 0.
  void add(std::uint32_t node, unsigned slots) {
    LIMBER_ASSERT(count_ + width <= capacity);
    for (const std::uint32_t first = count_; slots != 0; slots &= slots - 1) {
      entries_[count_++] = {0, node * width + static_cast<std::uint32_t>(std::countr_zero(slots)), first};
    }
  }

 private:
  // Every slot taken adds less than `width` more and goes one level down, of at most 11 (2^32 triangles).
  static constexpr std::uint32_t capacity = 96;

  std::uint32_t count_ = 0;
  Entry entries_[capacity];
};

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>

#include "core/check.h"
#include "tree/node.h"

namespace limber::query {

/// Two nodes whose subtrees are still to be compared.
struct NodePair {
  float bound_sq;  ///< squared lower bound of their distance, in squared units of a's tree; 0 when nothing is proven
  tree::NodeId node[2];
  std::uint16_t record;  ///< Front::Record of the opening it is from
  std::uint16_t lane;    ///< of that opening
};

/// The pairs a traversal still has to look at, in a fixed amount of memory.
///
/// Pairs whose bounding volumes meet have to be opened whatever happens, so they are taken first, last in first out,
/// which leads to contacts soonest. The others are taken nearest first, to within one of 64 equal steps between the
/// least bound and the one that matters no more: a queue that orders them exactly costs more than it saves. When there
/// are too many of those, more of them are taken last in first out too, which needs no more room than the depth of both
/// trees.
class Pending {
 public:
  bool empty() const { return stack_size_ == 0 && filled_ == 0; }

  /// Whether pairs should be taken before more are added that are not their children.
  bool is_crowded() const { return stack_size_ > width || (capacity - used_ < width && !empty()); }

  /// Adds a pair that is taken before all others.
  void push_first(const NodePair& pair) {
    LIMBER_ASSERT(stack_size_ < stack_capacity);
    stack_[stack_size_++] = pair;
  }

  void push(const NodePair& pair) {
    // A free slot if there is one, a new one otherwise, without a branch that nobody could predict.
    const bool reuse = free_ != none;
    const std::uint32_t slot = reuse ? free_ : used_;
    if (slot == capacity) return push_first(pair);
    used_ += reuse ? 0 : 1;
    free_ = reuse ? next_[slot] : none;
    pairs_[slot] = pair;
    link(static_cast<std::uint16_t>(slot));
  }

  /// Pre: not empty().
  NodePair pop() {
    LIMBER_ASSERT(!empty());
    if (stack_size_ > 0) return stack_[--stack_size_];
    const int step = std::countr_zero(filled_);
    const std::uint16_t slot = first_[step];
    const std::uint16_t after = next_[slot];
    first_[step] = after;
    filled_ ^= std::uint64_t{after == none} << step;
    next_[slot] = free_;
    free_ = slot;
    return pairs_[slot];
  }

  /// Whether no pair that is left has a bound below `limit_sq`, as far as can be told at once.
  bool all_beyond(float limit_sq) const {
    return stack_size_ == 0 && step_of(limit_sq) < static_cast<std::uint32_t>(std::countr_zero(filled_));
  }

  /// Says which bounds matter: those from `least` to `most`. To be repeated when they have become much fewer.
  void focus(float least, float most) {
    least_ = least;
    steps_ = most > least ? static_cast<float>(step_count) / (most - least) : 0;
    std::uint64_t old = filled_;
    std::uint16_t chain = none;  // all slots in use, the pairs to be taken first at the end
    for (; old != 0; old &= ~std::bit_floor(old)) {
      for (std::uint16_t slot = first_[std::bit_width(old) - 1]; slot != none;) {
        const std::uint16_t after = next_[slot];
        next_[slot] = chain;
        chain = slot;
        slot = after;
      }
    }
    forget_steps();
    while (chain != none) {
      const std::uint16_t after = next_[chain];
      link(chain);
      chain = after;
    }
  }

  /// To be called before pairs are added.
  void clear() {
    stack_size_ = used_ = 0;
    forget_steps();
    free_ = none;
    steps_ = 0;
  }

  static constexpr float no_bound = 3e38F, largest_bound = 2e38F;

 private:
  void forget_steps() {
    std::fill(std::begin(first_), std::end(first_), none);
    filled_ = 0;
  }
  std::uint32_t step_of(float bound_sq) const {
    const float at = (bound_sq - least_) * steps_;
    // In this order a product of 0 and infinity counts as 0. Signed, since that is what processors convert.
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::min(std::max(0.0F, at), step_count - 1.0F)));
  }
  void link(std::uint16_t slot) {
    const std::uint32_t step = step_of(pairs_[slot].bound_sq);
    next_[slot] = first_[step];
    first_[step] = slot;
    filled_ |= std::uint64_t{1} << step;
  }

  // Every pair taken from the stack adds less than `width` more and goes one level down one of two trees, each of at
  // most 11 levels: 2^32 triangles. Twice `width` may have been there before.
  static constexpr std::uint32_t stack_capacity = 208, capacity = 2048, step_count = 64;
  static constexpr std::uint32_t width = tree::width;
  static constexpr std::uint16_t none = 0xffff;

  NodePair stack_[stack_capacity], pairs_[capacity];
  std::uint16_t next_[capacity];     // of the same step, or of the free slots
  std::uint16_t first_[step_count];  // last pushed
  std::uint64_t filled_ = 0;         // steps that have pairs
  std::uint32_t stack_size_ = 0, used_ = 0;
  std::uint16_t free_ = none;
  float least_ = 0, steps_ = 0;
};

}  // namespace limber::query

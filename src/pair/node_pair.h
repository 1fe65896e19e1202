// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>

#include "base/check.h"
#include "bvh/tree.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

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
    pair = {0, {slot, bvh::root_slot}, NodePair::no_record, 0, false};
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
    return {bound_sq,
            {of_a ? slot : pair.slot[0], of_a ? pair.slot[1] : slot},
            record,
            static_cast<std::uint8_t>(has_record ? child : pair.child),
            false};
  }
};

/// The pairs that a traversal has not taken yet, in a fixed amount of memory.
///
/// Pairs whose bounding volumes overlap have to be expanded whatever happens, so they are taken first, from a stack,
/// which leads to contacts soonest. The others are taken nearest first, to within one of 64 equal buckets between the
/// least bound and the one from which on pairs are pruned: a queue that orders them exactly costs more than it saves.
/// When the buckets are full, more pairs go to the stack. It is taken last in, first out, so its size is at most about
/// `width` times the depth of both trees.
class BucketQueue {
 public:
  bool empty() const { return stack_size_ == 0 && filled_ == 0; }

  /// Whether there are pairs, and none that is taken before all others.
  bool has_only_ordered() const { return stack_size_ == 0 && filled_ != 0; }

  /// Adds a pair that is taken before all others.
  void push_first(const NodePair& pair) {
    LIMBER_ASSERT(stack_size_ < stack_capacity);
    stack_[stack_size_++] = pair;
  }

  void push(const NodePair& pair) {
    // A free entry if there is one, a new one otherwise, without a branch that nobody could predict.
    const bool reuse = free_ != none;
    const std::uint32_t entry = reuse ? free_ : used_;
    if (entry == capacity) return push_first(pair);
    used_ += reuse ? 0 : 1;
    free_ = reuse ? next_[entry] : none;
    pairs_[entry] = pair;
    link(static_cast<std::uint16_t>(entry));
  }

  /// Takes the next pair. Pre: not empty().
  NodePair pop() {
    LIMBER_ASSERT(!empty());
    if (stack_size_ > 0) return stack_[--stack_size_];
    const int bucket = std::countr_zero(filled_);
    const std::uint16_t entry = first_[bucket];
    const std::uint16_t after = next_[entry];
    first_[bucket] = after;
    filled_ ^= std::uint64_t{after == none} << bucket;
    next_[entry] = free_;
    free_ = entry;
    return pairs_[entry];
  }

  /// The least bound of all pairs. Pre: not empty().
  float least_bound_sq() const {
    LIMBER_ASSERT(!empty());
    float least = largest_bound;
    for (std::uint32_t i = 0; i < stack_size_; ++i) least = std::min(least, stack_[i].bound_sq);
    if (filled_ == 0) return least;
    for (std::uint16_t entry = first_[std::countr_zero(filled_)]; entry != none; entry = next_[entry]) {
      least = std::min(least, pairs_[entry].bound_sq);
    }
    return least;
  }

  /// Whether no pair that is left has a bound below `limit_sq`, as far as can be told at once.
  bool all_beyond(float limit_sq) const {
    return stack_size_ == 0 && bucket_of(limit_sq) < static_cast<std::uint32_t>(std::countr_zero(filled_));
  }

  /// Spreads the buckets over the bounds from `least` to `most`. To be repeated when that range has become much
  /// smaller.
  void focus(float least, float most) {
    least_ = least;
    buckets_per_bound_ = most > least ? static_cast<float>(bucket_count) / (most - least) : 0;
    std::uint64_t old = filled_;
    std::uint16_t chain = none;  // all pairs, those to be taken first at the end
    for (; old != 0; old &= old - 1) {
      for (std::uint16_t entry = first_[std::countr_zero(old)]; entry != none;) {
        const std::uint16_t after = next_[entry];
        next_[entry] = chain;
        chain = entry;
        entry = after;
      }
    }
    clear_buckets();
    while (chain != none) {
      const std::uint16_t after = next_[chain];
      link(chain);
      chain = after;
    }
  }

  /// To be called before pairs are added.
  void clear() {
    stack_size_ = used_ = 0;
    clear_buckets();
    free_ = none;
    buckets_per_bound_ = 0;
  }

  static constexpr float no_limit_sq = 3e38F, largest_bound = 2e38F;

 private:
  void clear_buckets() {
    std::fill(std::begin(first_), std::end(first_), none);
    filled_ = 0;
  }
  std::uint32_t bucket_of(float bound_sq) const {
    const float at = (bound_sq - least_) * buckets_per_bound_;
    // `at` is NaN for 0 * infinity; std::max(0, NaN) is 0, std::max(NaN, 0) is not. Signed: float to unsigned is slow.
    return static_cast<std::uint32_t>(static_cast<std::int32_t>(std::min(std::max(0.0F, at), bucket_count - 1.0F)));
  }
  void link(std::uint16_t entry) {
    const std::uint32_t bucket = bucket_of(pairs_[entry].bound_sq);
    next_[entry] = first_[bucket];
    first_[bucket] = entry;
    filled_ |= std::uint64_t{1} << bucket;
  }

  // Every pair taken from the stack adds less than `width` more and goes one level down one of two trees, each of at
  // most 11 levels (2^32 triangles). Two expansions may have added `width` each before.
  static constexpr std::uint32_t stack_capacity = 208, capacity = 2048, bucket_count = 64;
  static constexpr std::uint32_t width = bvh::width;
  static constexpr std::uint16_t none = 0xffff;

  NodePair stack_[stack_capacity], pairs_[capacity];
  std::uint16_t next_[capacity];       // of the same bucket, or of the free entries
  std::uint16_t first_[bucket_count];  // last pushed
  std::uint64_t filled_ = 0;           // buckets that have pairs
  std::uint32_t stack_size_ = 0, used_ = 0;
  std::uint16_t free_ = none;
  float least_ = 0, buckets_per_bound_ = 0;
};

}  // namespace limber::pair

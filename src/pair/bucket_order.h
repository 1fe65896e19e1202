// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <iterator>

#include "base/check.h"
#include "pair/collectors/collector.h"
#include "pair/node_pair.h"
#include "pair/pruning.h"

namespace limber::pair {

/// The pairs that a traversal has not taken yet, in a fixed amount of memory.
///
/// Pairs whose bounding volumes overlap have to be expanded whatever happens, so they are taken first, from a stack,
/// which leads to contacts soonest. The others are taken nearest first, to within one of 64 equal buckets between the
/// least bound and the one from which on pairs are pruned: a queue that orders them exactly costs more than it saves.
/// When the buckets are full, more pairs go to the stack. It is taken last in, first out, so its size is at most about
/// bvh::width times the depth of both trees.
class BucketQueue {
 public:
  bool empty() const { return stack_size_ == 0 && filled_ == 0; }

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
    float least = largest_bound_sq;
    for (std::uint32_t i = 0; i < stack_size_; ++i) least = std::min(least, stack_[i].bound_sq);
    if (filled_ == 0) return least;
    for (std::uint16_t entry = first_[std::countr_zero(filled_)]; entry != none; entry = next_[entry]) {
      least = std::min(least, pairs_[entry].bound_sq);
    }
    return least;
  }

  /// Whether the buckets tell that no pair that is left has a bound below `limit_sq`. False proves nothing.
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

  // Every pair taken from the stack adds less than bvh::width more and goes one level down one of two trees, each of at
  // most 11 levels (2^32 triangles). Two expansions may have added bvh::width each before. That is 192; some are spare.
  static constexpr std::uint32_t stack_capacity = 208;
  static constexpr std::uint32_t capacity = 2048, bucket_count = 64;  // 36 kB of pairs; the bits of filled_
  static constexpr std::uint16_t none = 0xffff;

  NodePair stack_[stack_capacity], pairs_[capacity];
  std::uint16_t next_[capacity];       // of the same bucket, or of the free entries
  std::uint16_t first_[bucket_count];  // last pushed
  std::uint64_t filled_ = 0;           // buckets that have pairs
  std::uint32_t stack_size_ = 0, used_ = 0;
  std::uint16_t free_ = none;
  float least_ = 0, buckets_per_bound_ = 0;
};

/// What BucketOrder carries from one step to the next.
struct BucketState {
  BucketQueue queue;
  float least_sq = 0, focus_sq = no_limit_sq;  // the bounds between which its buckets lie
  bool is_descending = true;                   // whether no two leaves have been compared yet
};

/// The order of PairWalk that goes best first. Pairs whose volumes overlap are taken first, the deepest overlap on top
/// of a stack; then the nearest, by buckets (BucketQueue). Best first alone comes to leaves late, so that the cutoff
/// stays large for long. So a traversal begins with a descent straight down to two leaves, always to the nearest child.
template <Hits hits>
class BucketOrder {
 public:
  // A collector of any hit gains nothing from a smaller distance that is still above its cutoff.
  static constexpr bool raises = hits != Hits::any;

  /// Refers to all arguments.
  BucketOrder(BucketState& state, SquaredLimits& limits, const Pruning& pruning)
      : state_(state), limits_(limits), pruning_(pruning) {}

  bool empty() const { return state_.queue.empty(); }
  NodePair take() {
    follow_cutoff();
    return state_.queue.pop();
  }

  /// Updates the squared limits. When the range of bounds that matter has halved, spreads the buckets of the queue over
  /// what is left of it: from BucketState::least_sq to focus_sq.
  void follow_cutoff() {
    if (!limits_.update(pruning_.distance())) return;
    const float limit_sq = limits_.of_pairs();
    if (limit_sq - state_.least_sq > worth_refocusing * (state_.focus_sq - state_.least_sq)) return;
    state_.focus_sq = limit_sq;
    state_.queue.focus(state_.least_sq, state_.focus_sq);
  }

  void add_first(const NodePair& pair) { state_.queue.push_first(pair); }
  void add_itself(const NodePair& pair) { state_.queue.push_first(pair); }
  /// Queues a pair whose bound has been raised, but in a descent, which goes on with it.
  bool takes_raised(const NodePair& pair) {
    if (state_.is_descending) return false;
    state_.queue.push(pair);
    return true;
  }
  template <typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    add(e, bounds, state_.is_descending);
  }
  /// Queues the children that were kept: those that overlap on the stack, the deepest on top, the others in the
  /// buckets.
  template <typename Bounds>
  [[gnu::always_inline]] void add(const Expansion& e, const Bounds& bounds, bool descends) {
    if (e.kept.all == 0) return;
    unsigned overlapping = e.kept.overlapping;
    if (overlapping == 0 && descends && raises) return push_nearest_first(e, bounds);
    push(e, bounds, e.kept.all & ~overlapping);
    // The deepest overlap last, so that it is taken first.
    while (overlapping != 0) {
      const std::uint32_t shallowest = e.last_of(overlapping);
      overlapping &= ~(1U << shallowest);
      state_.queue.push_first(bounds.child_pair(e, shallowest));
    }
  }

  /// A pair has been pruned: so will be all others if none is nearer than the limit.
  void drop_pruned() {
    if (!state_.queue.empty() && state_.queue.all_beyond(limits_.of_pairs())) state_.queue.clear();
  }

 private:
  // The queue is sorted anew when the range of bounds that matter has shrunk to this part of what it was when the queue
  // was last sorted.
  static constexpr float worth_refocusing = 0.5F;

  /// Queues the nearest child as the next pair. Not inlined: shorter queries should not pay for it.
  template <typename Bounds>
  [[gnu::noinline]] void push_nearest_first(const Expansion& e, const Bounds& bounds) {
    const std::uint32_t nearest = e.first_of(e.kept.all);
    push(e, bounds, e.kept.all & ~(1U << nearest));
    state_.queue.push_first(bounds.child_pair(e, nearest));
  }

  template <typename Bounds>
  [[gnu::always_inline]] void push(const Expansion& e, const Bounds& bounds, unsigned children) {
    for (; children != 0; children &= children - 1) {
      state_.queue.push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(children))));
    }
  }

  BucketState& state_;
  SquaredLimits& limits_;
  const Pruning& pruning_;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

#include "pair/collectors/collector.h"
#include "pair/node_pair.h"
#include "pair/pruning.h"
#include "pair/squared_limits.h"
#include "pair/traversal_state.h"

namespace limber::pair {

/// The order of PairWalk that goes best first: with the queue of a TraversalState. Pairs whose volumes overlap are
/// taken first, the deepest overlap on top of a stack; then the nearest, by buckets (BucketQueue). In a descent the
/// nearest child comes next.
template <Hits hits>
class BucketOrder {
 public:
  // A collector of any hit gains nothing from a smaller distance that is still above its cutoff.
  static constexpr bool raises = hits != Hits::any;

  /// Refers to all arguments.
  BucketOrder(TraversalState& state, SquaredLimits& limits, const Pruning& pruning)
      : state_(state), limits_(limits), pruning_(pruning) {}

  bool empty() const { return state_.queue.empty(); }
  NodePair take() {
    follow_cutoff();
    return state_.queue.pop();
  }

  /// Updates the squared limits. When the range of bounds that matter has halved, spreads the buckets of the queue over
  /// what is left of it: from TraversalState::least_sq to focus_sq.
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
    if (state_.descents.is_descending()) return false;
    state_.queue.push(pair);
    return true;
  }
  template <typename Bounds>
  void add(const Expansion& e, const Bounds& bounds) {
    add(e, bounds, state_.descents.is_descending());
  }
  /// Queues the children that were kept: those that overlap on the stack, the deepest on top, the others in the
  /// buckets.
  template <typename Bounds>
  void add(const Expansion& e, const Bounds& bounds, bool descends) {
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
  void push(const Expansion& e, const Bounds& bounds, unsigned children) {
    for (; children != 0; children &= children - 1) {
      state_.queue.push(bounds.child_pair(e, static_cast<std::uint32_t>(std::countr_zero(children))));
    }
  }

  TraversalState& state_;
  SquaredLimits& limits_;
  const Pruning& pruning_;
};

}  // namespace limber::pair

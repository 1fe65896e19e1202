// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

#include "pair/collectors/collector.h"
#include "pair/expansion.h"
#include "pair/squared_limits.h"
#include "pair/traversal_state.h"

namespace limber::pair {

/// What BestFirst still has to take: the queue of a TraversalState, and the order in which pairs come into it.
template <Hits hits>
class OpenPairs {
 public:
  /// Refers to both arguments.
  OpenPairs(TraversalState& state, SquaredLimits& limits) : state_(state), limits_(limits) {}

  /// Updates the squared limits. When the range of bounds that matter has halved, spreads the buckets of the queue over
  /// what is left of it: from TraversalState::least_sq to focus_sq.
  void update_limits(double distance) {
    if (!limits_.update(distance)) return;
    const float limit_sq = limits_.of(Side::a);
    if (limit_sq - state_.least_sq > worth_refocusing * (state_.focus_sq - state_.least_sq)) return;
    state_.focus_sq = limit_sq;
    state_.queue.focus(state_.least_sq, state_.focus_sq);
  }

  /// Queues the children that are not pruned: those that overlap on the stack, the deepest on top, the others in the
  /// buckets.
  void keep(const Expansion& e, bool descends) {
    if (e.kept.all == 0) return;
    unsigned overlapping = e.kept.overlapping;
    // A collector of any hit gains nothing from a smaller distance that is still above its cutoff.
    if (overlapping == 0 && descends && hits != Hits::any) return push_nearest_first(e);
    push(e, e.kept.all & ~overlapping);
    // The deepest overlap last, so that it is taken first.
    while (overlapping != 0) {
      const std::uint32_t shallowest = e.last_of(overlapping);
      overlapping &= ~(1U << shallowest);
      state_.queue.push_first(child_pair(e, shallowest));
    }
  }

  NodePair child_pair(const Expansion& e, std::uint32_t child) const {
    return e.child_pair(child, limits_.bound_of_child(e.side, e.order[child], e.pair.bound_sq));
  }

 private:
  // The queue is sorted anew when the range of bounds that matter has shrunk to this part of what it was when the queue
  // was last sorted.
  static constexpr float worth_refocusing = 0.5F;

  /// Queues the nearest child as the next pair. Not inlined: shorter queries should not pay for it.
  [[gnu::noinline]] void push_nearest_first(const Expansion& e) {
    const std::uint32_t nearest = e.first_of(e.kept.all);
    push(e, e.kept.all & ~(1U << nearest));
    state_.queue.push_first(child_pair(e, nearest));
  }

  void push(const Expansion& e, unsigned children) {
    for (; children != 0; children &= children - 1) {
      state_.queue.push(child_pair(e, static_cast<std::uint32_t>(std::countr_zero(children))));
    }
  }

  TraversalState& state_;
  SquaredLimits& limits_;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <type_traits>

#include "base/check.h"
#include "pair/best_of_leaves.h"
#include "pair/bucket_order.h"
#include "pair/front_recorder.h"
#include "pair/node_bounds.h"
#include "pair/pair_walk.h"
#include "pair/search_context.h"
#include "pair/traversal_state.h"

namespace limber::pair {

/// The walk of queries that look for the closest pairs, or for any pair within a cutoff: best first.
///
/// Everything that is left out is at least Pruning::cutoff() apart; float64 bounds, those of the front, are compared
/// with it. Float32 bounds are compared with Pruning::distance(), which differs for tiny models only: it is never too
/// small for float32.
///
/// With a FrontRecorder as observer, a front records what the walk prunes and compares; the front also owns the walk's
/// state, so that the next query can go on with it. While a walk runs, nobody else changes Pruning: collectors return
/// updates, and placed models are constant.
template <typename Collector, typename Observer = NoObserver>
class BestFirst {
 public:
  /// The state is one that has been cleared, or that of a walk that was interrupted. Pre: the collector is not done.
  BestFirst(const Search& search, Collector& collector,
            TraversalState& state) requires std::is_same_v<Observer, NoObserver>
      : BestFirst(search, collector, state, [](const SquaredLimits&) { return NoObserver(); }) {}
  BestFirst(const Search& search, Collector& collector, Front& front)
      : BestFirst(search, collector, front.state(),
                  [&](const SquaredLimits& limits) { return FrontRecorder(front, search.pruning, limits); }) {}

  /// Begins with the pair of roots; for one model, with its nodes, the last one first.
  void start(double root_bound) {
    if (observer_.is_recording() || search_.pruning.has_direction()) state_.whole_leaves.allow_some();
    if constexpr (Collector::is_self) {
      nodes_.end = static_cast<std::uint32_t>(search_.placed.tree(Side::a).nodes.size());
      return;
    }
    leaves_.prepare_seed();
    const NodePair roots = NodePair::roots(state_.least_sq = bounds_.limits().bound_of(root_bound));
    // The first descent is one long step, so it is not made where a budget may end the query after any step.
    if (may_descend_at_once && !search_.meter.is_limited()) {
      order_.follow_cutoff();
      if (leaves_.compares_seed(roots)) order_.follow_cutoff();
      if (state_.descents.is_descending()) return walk_.descend(roots);
    }
    order_.add_first(roots);
  }
  /// Begins with the records of the front that the observer records. False if a new walk is cheaper.
  bool start_with_records() {
    state_.whole_leaves.allow_some();
    leaves_.prepare_seed();
    return observer_.add_records(state_);
  }

  /// Goes on until no pair that matters is left, or the budget is spent. The meter knows that in the end, also where it
  /// was spent with the last pair: then there is nothing left for what the query does next.
  void run() {
    if constexpr (Collector::is_self) {
      walk_.run_siblings(nodes_);
    } else {
      walk_.run();
    }
    static_cast<void>(leaves_.has_to_end());
  }

  /// A lower bound of the distance of all that is left, infinite if nothing is.
  double least_open() const {
    if (nodes_.end > 0) return 0;  // siblings overlap
    if (state_.queue.empty()) return std::numeric_limits<double>::infinity();
    return bounds_.limits().length_of_pair(state_.queue.least_bound_sq());
  }

  Observer& observer() { return observer_; }

 private:
  static constexpr bool may_descend_at_once =
      std::is_same_v<Observer, NoObserver> && Collector::hits != Hits::k_closest;

  template <typename MakeObserver>
  BestFirst(const Search& search, Collector& collector, TraversalState& state, const MakeObserver& make_observer)
      : search_(search),
        state_(state),
        bounds_(search, state.work),
        order_(state, bounds_.limits(), search.pruning),
        leaves_(search, bounds_, collector, state),
        observer_(make_observer(bounds_.limits())) {
    static_assert(Collector::hits != Hits::all);
  }

  Search search_;
  TraversalState& state_;
  NodeRange nodes_;  // of one model, that are still to be visited
  NodeBounds<Collector> bounds_;
  BucketOrder<Collector::hits> order_;
  BestOfLeaves<Collector> leaves_;
  Observer observer_;
  PairWalk<BucketOrder<Collector::hits>, NodeBounds<Collector>, BestOfLeaves<Collector>, Observer> walk_{
      order_, bounds_, leaves_, observer_};
};

}  // namespace limber::pair

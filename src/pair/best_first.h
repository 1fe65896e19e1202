// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "base/check.h"
#include "geometry/primitives.h"
#include "pair/collectors/collector.h"
#include "pair/front.h"
#include "pair/node_bounds.h"
#include "pair/pair_walk.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "pair/traversal_state.h"

namespace limber::pair {

/// The index of the candidate with the least bound. Pre: there are candidates.
inline std::uint32_t nearest_of(const simd::Candidates& found) {
  LIMBER_ASSERT(found.count > 0);
  std::uint32_t nearest = 0;
  for (std::uint32_t i = 1; i < found.count; ++i) {
    if (found.pairs[i].bound_sq < found.pairs[nearest].bound_sq) nearest = i;
  }
  return nearest;
}

/// The visitor of PairWalk that looks for the best pairs, or for any. Pruning defines cutoff, best distance and search
/// direction. Two leaves are compared in these steps:
///   1. The search direction may prune them as a whole: tested while that often succeeds (WholeLeaves).
///   2. Where the first descent has ended, one contact is looked for.
///   3. A kernel lists the candidates: the pairs of triangles that it cannot prune.
///   4. The candidates are compared, the one of least bound first. Each may lower the cutoff, and prune others.
///
/// The cutoff is lowered early by two guesses, whose state is in TraversalState: the descent straight down to two
/// leaves (BucketOrder), and the seed, a likely closest pair of triangles over a flat part (FlatSeed).
template <typename Collector>
class BestOfLeaves {
 public:
  /// The budget counts steps from here on: those that the state has already are of earlier calls.
  BestOfLeaves(const Search& search, const NodeBounds<Collector>& bounds, Collector& collector, TraversalState& state)
      : search_(search),
        bounds_(bounds),
        collector_(collector),
        state_(state),
        kernels_(simd::kernels()),
        first_step_(state.steps),
        a_(search.placed, Side::a),
        b_(search.placed, Side::b) {}

  bool is_done() const { return collector_.is_done(); }
  bool has_to_end() { return is_done() || search_.meter.is_spent(steps()); }
  /// Has the meter note whether the last step has spent the budget.
  void update_meter() { has_to_end(); }
  void count_step() { ++state_.steps; }

  /// Makes the seed due if it is likely to help. With a finite `max_distance` the models may be farther apart than
  /// that, and a seed would be in vain. So it is due if the pair of a cache is within that distance; else compare() may
  /// ask for one later, once it has found such a pair.
  void prepare_seed() {
    if constexpr (looks_for_closest) {
      const double distance = search_.pruning.distance();
      if (std::isinf(distance) || distance < collector_.initial_cutoff()) state_.seed.make_due();
    }
  }
  /// Before `pair` is visited: compares the seed if it is due. Returns whether the cutoff may have changed.
  bool prepare_visit(const NodePair& pair) { return compare_seed_if_due(pair); }
  /// Compares the seed if it is due. Returns whether it did. Not where `next`, which is visited next, will be pruned:
  /// as that is among the nearest pairs, the query is nearly over, and a seed would come too late.
  bool compare_seed_if_due(const NodePair& next) {
    return looks_for_closest && state_.seed.is_due() && next.bound_sq < bounds_.limits().of_pairs() && compare_seed();
  }

  /// Compares two leaves. False if the query has ended: the collector is done, or the budget is spent. Else all pairs
  /// of their triangles, but for the best pair so far, are at least max(apart, cutoff) from each other.
  ///
  /// apart   In: 0. Out, for a front to record:
  ///           - if the leaves were pruned as a whole: the lower bound of their distance that has told so;
  ///           - if the kernel has kept no candidate, and with `needs_bound`: the kernel's lower bound;
  ///           - else 0.
  bool compare(const NodePair& pair, bool needs_bound, double& apart) {
    const simd::SlotRef leaf_a = bounds_.as_leaf(Side::a, pair), leaf_b = bounds_.as_leaf(Side::b, pair);
    const simd::SelfPair leaves{bounds_.leaf(Side::a, pair), bounds_.leaf(Side::b, pair)};
    a_.take(leaves.a);
    b_.take(leaves.b);
    const bool may_be_in_contact = std::exchange(state_.is_descending, false) && pair.bound_sq == 0;
    simd::Candidates found;
    if constexpr (looks_for_closest) {
      if (state_.whole_leaves.are_tested()) {
        const bool is_pruned = search_.pruning.prunes(a_, b_, apart);
        state_.whole_leaves.note(is_pruned);
        if (is_pruned) return true;
      }
      if (may_be_in_contact && find_contact(leaf_a, leaf_b, found)) return false;
    }
    kernels_.find_candidates(leaf_a, leaf_b, search_.frames.of(Side::a), search_.pruning.of(Side::a),
                             Collector::is_self ? &leaves : nullptr, needs_bound, found);
    ++state_.work;
    if (found.count == 0) {
      if (needs_bound) apart = static_cast<double>(found.pruned_bound) / found.scale;
      return true;
    }
    if (!compare_candidates(found)) return false;
    if constexpr (looks_for_closest) {
      // Once a pair within the first cutoff is known, the surroundings of these leaves may give a closer one.
      const bool has_found_any =
          search_.pruning.has_direction() && search_.pruning.distance() < collector_.initial_cutoff();
      if (has_found_any && state_.seed.may_look_near()) {
        state_.seed.look_near(bounds_.leaf_slot(Side::a, pair), bounds_.leaf_slot(Side::b, pair));
      }
    }
    return !collector_.is_done();
  }

 private:
  static constexpr bool looks_for_closest = Collector::hits == Hits::closest;

  std::uint64_t steps() const { return state_.steps - first_step_; }

  /// Compares the seed. False if there is none. Not inlined: it is rare.
  [[gnu::noinline]] bool compare_seed() {
    const std::optional<TrianglePair> likely = state_.seed.find(search_.placed, search_.stats);
    if (!likely) return false;
    state_.is_descending = false;
    ++search_.stats.primitive_tests;
    const PlacedTriangle a = placed_triangle(search_.placed, Side::a, likely->a);
    const PlacedTriangle b = placed_triangle(search_.placed, Side::b, likely->b);
    if (const auto update = collector_.compare(a, b)) {
      search_.pruning.update(*update);
      state_.whole_leaves.allow_many();
    }
    return true;
  }

  // Candidates, from which on another call of a kernel should cost less than the comparisons that its better bounds
  // save. No answer depends on it.
  static constexpr std::uint32_t worth_refining = 3;

  /// Compares all candidates that may still improve the answer, the nearest first. The first of them may prune many
  /// others. Those that are left get better bounds, if they are several. False if the query has ended.
  bool compare_candidates(simd::Candidates& found) {
    if (!compare_nearest(found)) return false;
    drop_pruned(found);
    if (found.count >= worth_refining) {
      kernels_.refine_candidates(found);
      drop_pruned(found);
    }
    while (found.count > 0) {
      if (!compare_nearest(found)) return false;
    }
    return true;
  }

  /// Takes out the candidate of least bound, and compares it unless the search direction prunes it. If its bound prunes
  /// it by now, so do those of all others, and all are taken out. False if the query has ended; BudgetMeter lets the
  /// first step of a call be finished, whatever the budget. Pre: there are candidates.
  bool compare_nearest(simd::Candidates& found) {
    simd::Candidate& nearest = found.pairs[nearest_of(found)];
    const std::uint32_t slot_a = nearest.slot_a, slot_b = nearest.slot_b;
    if (static_cast<double>(nearest.bound_sq) >= limit_sq_of(found, search_.pruning.distance())) {
      found.count = 0;
      return true;
    }
    nearest = found.pairs[--found.count];
    if (search_.pruning.prunes(a_, slot_a, b_, slot_b)) return true;
    ++search_.stats.primitive_tests;
    if (const auto update = collector_.compare(a_.at(slot_a), b_.at(slot_b))) search_.pruning.update(*update);
    return !collector_.is_done() && !search_.meter.cuts_short(steps());
  }

  /// Takes out the candidates that their bounds prune by now.
  void drop_pruned(simd::Candidates& found) const {
    simd::Candidate* const end = found.pairs + found.count;
    const double limit = limit_sq_of(found, search_.pruning.distance());
    found.count = static_cast<std::uint32_t>(
        std::remove_if(found.pairs, end,
                       [&](const simd::Candidate& c) { return static_cast<double>(c.bound_sq) >= limit; }) -
        found.pairs);
  }

  /// Whether any triangles of two leaves intersect; the first such pair found is given to the collector, which ends the
  /// query. For the first leaves, if their volumes overlap: the test is much cheaper than one for distance.
  bool find_contact(const simd::SlotRef& leaf_a, const simd::SlotRef& leaf_b, simd::Candidates& found) {
    static_assert(!Collector::is_self);
    simd::PruneLimits contact{};
    contact.distance = simd::smallest_prune_distance;
    kernels_.find_candidates(leaf_a, leaf_b, search_.frames.of(Side::a), contact, nullptr, false, found);
    for (std::uint32_t i = 0; i < found.count; ++i) {
      const PlacedTriangle &a = a_.at(found.pairs[i].slot_a), &b = b_.at(found.pairs[i].slot_b);
      ++search_.stats.primitive_tests;
      if (!geometry::intersects(a.corners, b.corners)) continue;
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      if (const auto update = collector_.take(0, {shared, shared, a.id, b.id})) search_.pruning.update(*update);
      LIMBER_ASSERT(collector_.is_done());
      return true;
    }
    return false;
  }

  Search search_;
  const NodeBounds<Collector>& bounds_;
  Collector& collector_;
  TraversalState& state_;
  const simd::Kernels& kernels_;
  const std::uint64_t first_step_;
  PlacedLeaf a_, b_;  // of the leaves that were compared last
};

/// The walk of queries that look for the closest pairs, or for any pair within a cutoff: best first. Everything that it
/// leaves out is at least Pruning::cutoff() apart.
///   1. start() or start_with_records() gives it the pairs to begin with; a walk that was interrupted has its own.
///   2. run() walks (PairWalk) until no pair that matters is left, or the budget is spent.
///   3. least_open() tells how far apart what is left is at least.
/// With a FrontRecorder as observer, a front records what the walk prunes and compares, and owns the walk's state, so
/// that the next query can go on with it.
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
  BestFirst(const BestFirst&) = delete;  // its parts refer to each other
  BestFirst& operator=(const BestFirst&) = delete;

  /// Begins with the pair of roots; for one model, with its nodes, the last one first.
  void start(double root_bound) {
    if (observer_.is_recording() || search_.pruning.has_direction()) state_.whole_leaves.allow_some();
    if constexpr (Collector::is_self) {
      nodes_.end = static_cast<std::uint32_t>(search_.placed.tree(Side::a).nodes.size());
      return;
    }
    leaves_.prepare_seed();
    state_.least_sq = bounds_.limits().bound_of(root_bound);
    const NodePair roots = bounds_.roots(state_.least_sq);
    // The first descent is one long step, so it is not made where a budget may end the query after any step.
    if (may_descend_at_once && !search_.meter.is_limited()) {
      order_.follow_cutoff();  // sets the limits, which tell whether to compare a seed
      if (leaves_.compare_seed_if_due(roots)) order_.follow_cutoff();
      if (state_.is_descending) return walk_.descend(roots);
    }
    order_.add_first(roots);
  }
  /// Begins with the records of the front that the observer has. False if a walk from the roots is cheaper: then the
  /// caller clears state and records, and calls start().
  bool start_with_records() {
    state_.whole_leaves.allow_some();
    leaves_.prepare_seed();
    return observer_.add_records(state_);
  }

  /// Goes on until no pair that matters is left, or the budget is spent. The meter knows that in the end, also where it
  /// was spent with the last pair: then nothing is left for what the query does next.
  void run() {
    if constexpr (Collector::is_self) {
      walk_.run_siblings(nodes_);
    } else {
      walk_.run();
    }
    leaves_.update_meter();
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

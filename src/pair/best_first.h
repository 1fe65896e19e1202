// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>

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

/// The visitor of PairWalk that looks for the best pairs, or for any. Two leaves are compared in this order: they may
/// be pruned as a whole; where a descent has ended, one contact or one near pair is looked for, to lower the upper
/// bound; then a kernel lists the candidates, pairs of triangles that it cannot prune, and these are compared, the one
/// of least bound first.
///
/// Three heuristics, parts of TraversalState, lower the upper bound early or save work:
///   Descents     Best first comes late to leaves. So the walk begins by going straight down to two leaves, and does so
///                again when it has met none for some steps.
///   FlatSeed     Where one model has a flat part, a pair of triangles that is likely to be the closest is guessed and
///                compared first: the seed.
///   WholeLeaves  The search direction may prune two leaves as a whole; tested as long as that often succeeds.
template <typename Collector>
class BestOfLeaves {
 public:
  /// The steps that the state has now do not count for the budget.
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
  bool has_to_end() { return is_done() || search_.meter.is_spent(state_.steps - first_step_); }
  void count_step() { ++state_.steps; }

  /// Decides whether to look for a seed now. With a finite `max_distance` the models may be farther apart than that,
  /// and a seed would be in vain. So it is looked for if the pair of a cache is within that distance; else compare()
  /// may ask for one later, once it has found such a pair.
  void prepare_seed() {
    if constexpr (looks_for_closest) {
      const double distance = search_.pruning.distance();
      if (std::isinf(distance) || distance < collector_.initial_cutoff()) state_.seed.make_due();
    }
  }
  /// What is done before a pair is visited: compares a seed that is due, and begins a descent that is due. Returns
  /// whether the cutoff may be lower now. Not for a pair that is pruned: as it is among the nearest, the query is
  /// nearly over, and a seed would come too late.
  bool lowers_cutoff(const NodePair& pair, bool follows_front) {
    if constexpr (looks_for_closest) {
      const bool has_compared = compares_seed(pair);
      // While a pair that overlaps is queued, it is followed down to its leaves anyway.
      if (state_.descents.is_due(state_.steps) && state_.queue.has_only_ordered()) descend_or_postpone(follows_front);
      return has_compared;
    }
    return false;
  }
  /// Compares a seed, if it is due and the pair that is next is not pruned.
  bool compares_seed(const NodePair& next) {
    if constexpr (looks_for_closest) {
      return state_.seed.is_due() && next.bound_sq < bounds_.limits().of_pairs() && compare_seed();
    }
    return false;
  }

  /// Whether the query goes on: false if the collector is done, or the budget is spent. If it goes on, all pairs of
  /// triangles of the two leaves, but for the best pair so far, are at least max(apart, cutoff) from each other.
  ///
  /// apart   In: 0. Out, for a front to record: the lower bound by which the leaves were pruned as a whole; if only the
  ///         kernel has compared them and kept no candidate, its bound, with `needs_bound`; else 0.
  ///
  /// The first comparison since the query began is finished, whatever the budget.
  bool compare(const NodePair& pair, bool needs_bound, double& apart) {
    const std::uint64_t steps = state_.steps - first_step_;
    const simd::SlotRef leaf_a = bounds_.as_leaf(Side::a, pair), leaf_b = bounds_.as_leaf(Side::b, pair);
    const simd::SelfPair self{bounds_.leaf(Side::a, pair), bounds_.leaf(Side::b, pair)};
    a_.take(self.a), b_.take(self.b);
    const bool are_first_leaves = !state_.descents.has_reached_leaves();  // end_at_leaves() changes that
    const bool has_descended = state_.descents.end_at_leaves(state_.steps);
    const bool may_be_in_contact = are_first_leaves && has_descended && pair.bound_sq == 0;
    simd::Candidates found;
    if constexpr (looks_for_closest) {
      if (state_.whole_leaves.are_tested() && prunes_whole_leaves(apart)) return true;
      if (may_be_in_contact && find_contact(leaf_a, leaf_b, found)) return false;
      if (has_descended && search_.pruning.has_error()) {
        look_nearer(leaf_a, leaf_b, found);
        if (collector_.is_done()) return false;
      }
    }
    kernels_.find_candidates(leaf_a, leaf_b, search_.frames.of(Side::a), search_.pruning.of(Side::a),
                             Collector::is_self ? &self : nullptr, needs_bound, found);
    ++state_.work;
    if (found.count == 0) {
      if (needs_bound) apart = static_cast<double>(found.pruned_bound) / found.scale;
      return true;
    }
    if (!compare_candidates(found, steps)) return false;
    if constexpr (looks_for_closest) {
      // Once a pair within the limit is known, the surroundings of these leaves may give a closer one.
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

  /// Begins a descent where it may find a closer pair. Where a close pair is known already, from a front or a seed,
  /// postpones it by some steps. Not inlined: it is rare.
  [[gnu::noinline]] void descend_or_postpone(bool follows_front) {
    if (follows_front || state_.seed.was_close()) {
      state_.descents.postpone(state_.steps);
    } else {
      state_.descents.start(state_.steps);
    }
  }

  /// Compares two triangles that are likely to be the closest, where one model has a flat part. False if none are.
  [[gnu::noinline]] bool compare_seed() {
    const std::optional<TrianglePair> likely = state_.seed.find(search_.placed, search_.stats);
    if (!likely) return false;
    state_.descents.stop();
    ++search_.stats.primitive_tests;
    const PlacedTriangle a = placed_triangle(search_.placed, Side::a, likely->a);
    const PlacedTriangle b = placed_triangle(search_.placed, Side::b, likely->b);
    if (const auto update = collector_.compare(a, b)) {
      search_.pruning.update(*update);
      state_.seed.note_close();
      state_.whole_leaves.allow_many();
    }
    return true;
  }

  // From that many candidates on, better bounds cost less than the comparisons that they save.
  static constexpr std::uint32_t worth_refining = 3;

  /// Compares all candidates that may still improve the answer, the nearest first. The first of them may prune many
  /// others. Those that are left get better bounds, if they are several. False if the query has ended.
  bool compare_candidates(simd::Candidates& found, std::uint64_t steps) {
    if (!compare_nearest(found, steps)) return false;
    drop_pruned(found);
    if (found.count >= worth_refining) {
      kernels_.refine_candidates(found);
      drop_pruned(found);
    }
    while (found.count > 0) {
      if (!compare_nearest(found, steps)) return false;
    }
    return true;
  }

  /// Takes out the candidate of least bound and compares it; if it is pruned by now, so are all others, and all are
  /// taken out. False if the query has ended. Pre: there are candidates.
  bool compare_nearest(simd::Candidates& found, std::uint64_t steps) {
    simd::Candidate& nearest = found.pairs[nearest_of(found)];
    const std::uint32_t slot_a = nearest.slot_a, slot_b = nearest.slot_b;
    if (static_cast<double>(nearest.bound_sq) >= limit_sq(found)) {
      found.count = 0;
      return true;
    }
    nearest = found.pairs[--found.count];
    if (search_.pruning.prunes(a_, slot_a, b_, slot_b)) return true;
    ++search_.stats.primitive_tests;
    if (const auto update = collector_.compare(a_.at(slot_a), b_.at(slot_b))) search_.pruning.update(*update);
    return !collector_.is_done() && !search_.meter.cuts_short(steps);
  }

  /// Takes out the candidates that are beyond the upper bound by now.
  void drop_pruned(simd::Candidates& found) const {
    simd::Candidate* const end = found.pairs + found.count;
    const double limit = limit_sq(found);
    found.count = static_cast<std::uint32_t>(
        std::remove_if(found.pairs, end,
                       [&](const simd::Candidate& c) { return static_cast<double>(c.bound_sq) >= limit; }) -
        found.pairs);
  }

  /// Candidates with a bound of at least this are pruned.
  double limit_sq(const simd::Candidates& found) const { return limit_sq_of(found, search_.pruning.distance()); }

  /// Whether the search direction prunes the two leaves as a whole.
  bool prunes_whole_leaves(double& apart) {
    const bool is_pruned = search_.pruning.prunes(a_, b_, apart);
    state_.whole_leaves.note(is_pruned);
    return is_pruned;
  }

  /// Looks for triangles that intersect in the first two leaves, whose volumes overlap. A test for intersection is much
  /// cheaper than one for distance, and a contact ends the query. Returns whether there is one.
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

  /// Where an error is allowed, the cutoff is smaller than the best distance, and pairs between the two are pruned.
  /// Here, where a descent has ended, the nearest of them is compared all the same: it lowers the cutoff further.
  [[gnu::noinline]] void look_nearer(const simd::SlotRef& leaf_a, const simd::SlotRef& leaf_b,
                                     simd::Candidates& found) {
    simd::PruneLimits nearer = search_.pruning.of(Side::a);
    nearer.distance = search_.pruning.best_distance();
    kernels_.find_candidates(leaf_a, leaf_b, search_.frames.of(Side::a), nearer, nullptr, false, found);
    if (found.count == 0) return;
    const std::uint32_t i = nearest_of(found);
    ++search_.stats.primitive_tests;
    const auto update = collector_.compare(a_.at(found.pairs[i].slot_a), b_.at(found.pairs[i].slot_b));
    if (update) search_.pruning.update(*update);
  }

  Search search_;
  const NodeBounds<Collector>& bounds_;
  Collector& collector_;
  TraversalState& state_;
  const simd::Kernels& kernels_;
  const std::uint64_t first_step_;
  PlacedLeaf a_, b_;  // of the leaves that were compared last
};

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

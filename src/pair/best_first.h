// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <type_traits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "pair/collectors/collector.h"
#include "pair/expansion.h"
#include "pair/front.h"
#include "pair/front_recorder.h"
#include "pair/leaf_comparison.h"
#include "pair/open_pairs.h"
#include "pair/search_context.h"
#include "pair/squared_limits.h"
#include "pair/traversal_state.h"
#include "pair/tree_pair.h"

namespace limber::pair {

/// The loop of queries that look for the closest pairs, or for any pair within a cutoff. A queue holds pairs of nodes.
/// Pairs whose volumes overlap are taken first, then the nearest (BucketQueue). A pair that is taken is pruned if its
/// lower bound is not below the cutoff (Pruning, SquaredLimits). Two leaves are compared (LeafComparison). Any other
/// pair is expanded: the children of one of its nodes are compared with the other node (Expansion), and those that
/// remain are queued.
///
/// Based on  [Quinlan1994]: pairs of nodes are compared; those that cannot improve the answer are pruned, the others
///           expanded.
/// Differs   One node of a pair is expanded at a time, the one whose volume leaves more open
///           (TreePair::split_priority(): the thicker slab). Its eight children are compared with the other node at
///           once. Bounds also use the search direction, in which the closest pair so far is apart.
///
/// Three heuristics, parts of TraversalState, lower the upper bound early or save work:
///   Descents     Best first comes late to leaves. So the traversal begins by going straight down to two leaves, and
///                does so again when it has met none for some steps.
///   FlatSeed     Where one model has a flat part, a pair of triangles that is likely to be the closest is guessed and
///                compared first: the seed.
///   WholeLeaves  The search direction may prune two leaves as a whole; tested as long as that often succeeds.
///
/// Begin a traversal with one of:
///   start()               from the roots, or for one model from its nodes, the last one first;
///   start_with_records()  from the front of the last query, after the models have moved, or for another cutoff;
///   go_on()               where the budget has interrupted the last query;
///   start_with()          without a front, from the state of a traversal whose front is full.
/// Then call step() until it returns false, and finish(). search.h decides between them.
///
/// Everything that is left out is at least Pruning::cutoff() apart; float64 bounds, those of the front, are compared
/// with it. Float32 bounds are compared with Pruning::distance(), which differs for tiny models only: it is never too
/// small for float32.
///
/// With `has_front`, a front records what the traversal prunes and compares; the front also owns the traversal's state,
/// so that the next query can go on with it. While a traversal runs, nobody else changes Pruning: collectors return
/// updates, and placed models are constant.
template <typename Collector, bool has_front>
class BestFirst {
 public:
  /// `front` is null unless `has_front`.
  BestFirst(const Search& search, Collector& collector, Front* front)
      : search_(search),
        collector_(collector),
        state_(state_of(front)),
        front_(front, search.pruning),
        kernels_(simd::kernels()),
        trees_(search.placed),
        limits_(search.placed),
        open_(state_, limits_),
        leaves_(search, trees_, collector, state_) {
    static_assert(Collector::hits != Hits::all && !(has_front && Collector::hits == Hits::k_closest));
  }

  /// Begins with the pair of roots. For one model, queues nothing: step() then visits the nodes one after the other.
  /// Pre: the collector is not done.
  void start(double root_bound) {
    state_.clear();
    if (has_front || search_.pruning.has_direction()) state_.whole_leaves.allow_some();
    if constexpr (Collector::is_self) {
      static_assert(!has_front);
      next_node_ = static_cast<std::uint32_t>(trees_.tree(Side::a).nodes.size());
      return;
    }
    if constexpr (looks_for_closest) prepare_seed();
    state_.least_sq = limits_.bound_of(root_bound);
    const NodePair roots{state_.least_sq, {bvh::root_slot, bvh::root_slot}, NodePair::no_record, 0, false};
    if constexpr (!has_front && !needs_several) {
      // The first descent is one long step, so it is not made where a budget may end the query after any step.
      if (!search_.meter.is_limited()) return descend_first(roots);
    }
    state_.queue.push_first(roots);
  }

  /// Begins with the records of the front whose bounds are below the cutoff. False if these are so many that a new
  /// traversal is cheaper, or if the front has no records; then call start(), which drops what has been queued.
  /// Pre: the collector is not done.
  bool start_with_records() requires has_front {
    state_.clear();
    state_.whole_leaves.allow_some();
    if constexpr (looks_for_closest) prepare_seed();
    return push_records();
  }
  /// Begins with a copy of the state, queue included, of a traversal that has recorded a front until it was full.
  /// Pre: that traversal began with start(), so that no pair of the queue stands for a whole record.
  void start_with(const TraversalState& state) requires(!has_front) { state_ = state; }
  /// Continues the traversal of the front that was interrupted. Pre: the collector is not done, and
  /// Front::can_continue().
  void go_on() requires has_front {
    search_.pruning.restore_direction(front_.get().go_on());
    first_step_ = state_.steps;
  }

  /// Processes one pair of the queue. False when no pair that matters is left, or the budget is spent.
  bool step() {
    if (search_.meter.is_spent(state_.steps - first_step_) || collector_.is_done()) return false;
    if (state_.queue.empty()) {
      if (!Collector::is_self || next_node_ == 0) return false;
      compare_siblings();
      return true;
    }
    open_.update_limits(search_.pruning.distance());
    Expansion e;
    e.pair = state_.queue.pop();
    if constexpr (looks_for_closest) {
      // This pair is among the nearest. If it is pruned, the query is nearly over, and a seed would come too late.
      if (state_.seed.is_due() && e.pair.bound_sq < limits_.of(Side::a)) compare_seed();
      // While a pair that overlaps is queued, it is followed down to its leaves anyway.
      if (state_.descents.is_due(state_.steps) && state_.queue.has_only_ordered()) descend_or_postpone();
    }
    if (process(e)) {
      compare_children(e);
      open_.keep(e, state_.descents.is_descending());
    }
    return true;
  }

  /// Ends the traversal, wherever it is. Returns a lower bound of the distance of all that is left, infinite if nothing
  /// is. With a front, what is left stays in the queue for the next traversal, unless the collector is done.
  double finish() {
    double least = state_.queue.empty() ? std::numeric_limits<double>::infinity()
                                        : limits_.length_of(Side::a, state_.queue.least_bound_sq());
    if constexpr (has_front) {
      if (state_.queue.empty() || collector_.is_done()) {
        front_.get().finish(trees_.tree(Side::a).unit);
      } else {
        front_.get().suspend(search_.pruning.cutoff(), search_.pruning.direction());
      }
    }
    if (Collector::is_self && next_node_ > 0) least = 0;  // siblings overlap
    return least;
  }

  /// Pairs of nodes and of leaves that kernels have compared so far, not those that were pruned before.
  std::uint64_t work() const { return state_.work; }

 private:
  static constexpr bool needs_several = Collector::hits == Hits::k_closest;
  static constexpr bool looks_for_closest = Collector::hits == Hits::closest;

  // Expansions of two trees of at most 11 levels each, and the pair of leaves.
  static constexpr std::uint32_t longest_descent = 23;
  // A front is resumed if less than this part of its records has to be compared again, open ones not counted.
  static constexpr double worth_resuming = 0.5;

  static decltype(auto) state_of(Front* front) {
    if constexpr (has_front) {
      return (front->state());  // in parentheses: a reference
    } else {
      return TraversalState();
    }
  }

  // --- order ---

  /// Begins a descent where it may find a closer pair. Where a close pair is known already, from a front or a seed,
  /// postpones it by some steps. Not inlined: it is rare.
  [[gnu::noinline]] void descend_or_postpone() {
    if (has_front || state_.seed.was_close()) {
      state_.descents.postpone(state_.steps);
    } else {
      state_.descents.start(state_.steps);
    }
  }

  /// Goes straight down from the roots to two leaves and compares them. Only if that does not end the query, as it
  /// often does where models intersect, are the other children of the nodes on the way queued.
  void descend_first(const NodePair& roots) {
    open_.update_limits(search_.pruning.distance());
    if constexpr (looks_for_closest) {
      if (state_.seed.is_due() && roots.bound_sq < limits_.of(Side::a)) compare_seed();
    }
    if (!state_.descents.is_descending()) return state_.queue.push_first(roots);
    NodePair pair = roots;
    Expansion way[longest_descent];
    std::uint32_t length = 0;
    for (;; ++length) {
      LIMBER_ASSERT(length < longest_descent);
      Expansion& e = way[length];
      e.pair = pair;
      if (!process_pair(e)) break;
      compare_children(e);
      if (e.kept.all == 0) break;
      const std::uint32_t child = e.first_child();
      pair = open_.child_pair(e, child);
      e.kept.all &= ~(1U << child), e.kept.overlapping &= ~(1U << child);
    }
    if (collector_.is_done()) return;
    for (std::uint32_t i = 0; i < length; ++i) open_.keep(way[i], false);  // the lowest level ends on top of the stack
  }

  // --- pairs of nodes ---

  /// Processes a pair from the queue: prunes it, compares it if it is two leaves, or starts its expansion. True if it
  /// has started one: the children are to be compared.
  bool process(Expansion& e) {
    return has_front && e.pair.child == NodePair::whole_record ? process_record(e) : process_pair(e);
  }
  /// As process(), for a pair of slots.
  bool process_pair(Expansion& e) {
    const NodePair& pair = e.pair;
    const float limit_sq = limits_.of(Side::a);
    if (pair.bound_sq >= limit_sq) {
      front_.settle(pair, limits_.length_of(Side::a, pair.bound_sq));
      // With a front, each remaining pair has to be put into its record on its own.
      if (!has_front && !state_.queue.empty() && state_.queue.all_beyond(limit_sq)) state_.queue.clear();
      return false;
    }
    if constexpr (Collector::is_self) {
      if (trees_.share_and_are_apart(pair, Apart::triangles, search_.pruning.distance())) return false;
    }
    ++state_.steps;
    if (trees_.are_leaves(pair)) {
      double apart = 0;
      if (leaves_.compare(pair, state_.steps - first_step_, has_front, apart)) {
        front_.settle(pair, apart);
      } else {
        state_.queue.push_first(pair);  // the query has ended before all its triangles were compared
      }
      return false;
    }
    const auto [side, triangles_first] = trees_.choose(pair);
    if (triangles_first && !pair.is_bounded && prunes_by_leaf(e, other(side))) return false;
    e.start(trees_.tree(side), pair, side);
    e.record = front_.add(pair, side);
    e.has_record = e.record != NodePair::no_record;
    if (!e.has_record) e.record = pair.record;  // the parent's record: there `pair` stands for all below it
    return true;
  }

  /// Compares the triangles of a leaf one by one with the other volume. Where that gives the pair a better bound, it is
  /// pruned by that, or waits in the queue for its turn: then the result is true. A descent goes on with it.
  bool prunes_by_leaf(Expansion& e, Side of_leaf) {
    ++state_.work;
    ++search_.stats.node_tests;
    const float bound_sq = kernels_.bound_leaf(trees_.as_leaf(of_leaf, e.pair), trees_.as_node(other(of_leaf), e.pair),
                                               search_.frames.of(of_leaf));
    if (bound_sq >= limits_.of(of_leaf)) {
      front_.settle(e.pair, limits_.length_of(of_leaf, bound_sq));
      return true;
    }
    const float raised_sq = limits_.bound_of_child(of_leaf, bound_sq, e.pair.bound_sq);
    if (Collector::hits == Hits::any || raised_sq == e.pair.bound_sq) return false;
    e.pair.bound_sq = raised_sq;
    e.pair.is_bounded = true;
    if (state_.descents.is_descending()) return false;
    state_.queue.push(e.pair);
    return true;
  }

  /// Compares the children of the expanded node with the other node.
  void compare_children(Expansion& e) {
    LIMBER_ASSERT(e.children != 0);
    ++state_.work;
    const bvh::Node& node = trees_.tree(e.side).nodes[e.node];
    search_.stats.node_tests += node.child_count;
    alignas(32) float bound_sq[bvh::width];
    const simd::KeptSlots kept = kernels_.bound_children(node, trees_.as_other(other(e.side), e.pair),
                                                         search_.frames.of(e.side), search_.pruning.of(e.side),
                                                         limits_.of(e.side), e.order, has_front ? bound_sq : nullptr);
    // Local variables, because GCC would combine the masks in memory.
    const unsigned all = kept.all & e.children, overlapping = kept.overlapping & e.children;
    e.kept = {all, overlapping};
    const unsigned pruned = e.children & ~e.kept.all;
    if (has_front && pruned != 0) front_.settle_children(e, pruned, bound_sq, limits_);
  }

  /// For one model: compares the child slots of the next node with each other, and each of its leaves with itself. Two
  /// triangles of one leaf are compared with that leaf; any two others have one lowest common ancestor. So every pair
  /// is visited once.
  void compare_siblings() {
    LIMBER_ASSERT(next_node_ > 0 && state_.queue.empty());
    open_.update_limits(search_.pruning.distance());
    ++state_.steps;
    const bvh::Tree& tree = trees_.tree(Side::a);
    const std::uint32_t n = --next_node_, count = tree.nodes[n].child_count;
    for (std::uint32_t k = 0; k < count && !collector_.is_done(); ++k) {
      const bvh::SlotId slot = n * bvh::width + k;
      if (bvh::has_leaf(tree, slot)) state_.queue.push_first({0, {slot, slot}, NodePair::no_record, 0, false});
      if (k + 1 == count) break;
      Expansion e;
      e.start_siblings(slot, count);
      compare_children(e);
      open_.keep(e, state_.descents.is_descending());
    }
  }

  // --- seed ---

  /// Decides whether to look for a seed now. With a finite `max_distance` the models may be farther apart than that,
  /// and a seed would be in vain. So it is looked for if the pair of a cache is within that distance; else
  /// LeafComparison may ask for one later, once it has found such a pair.
  void prepare_seed() {
    if (std::isinf(search_.pruning.distance()) || search_.pruning.distance() < collector_.initial_cutoff()) {
      state_.seed.make_due();
    }
  }

  /// Compares two triangles that are likely to be the closest, where one model has a flat part.
  [[gnu::noinline]] void compare_seed() {
    const std::optional<TrianglePair> likely = state_.seed.find(search_.placed, search_.stats);
    if (!likely) return;
    state_.descents.stop();
    ++search_.stats.primitive_tests;
    const PlacedTriangle a = placed_triangle(search_.placed, Side::a, likely->a);
    const PlacedTriangle b = placed_triangle(search_.placed, Side::b, likely->b);
    if (const auto update = collector_.compare(a, b)) {
      search_.pruning.update(*update);
      state_.seed.note_close();
      state_.whole_leaves.allow_many();
    }
    open_.update_limits(search_.pruning.distance());
  }

  // --- front ---

  /// Queues what has to be compared again. False if that is so much that a new traversal is cheaper, or if there are no
  /// records.
  bool push_records() {
    const Front& front = front_.get();
    const std::span<const Front::Record> records = front.records();
    state_.descents.stop();
    std::size_t count = 0;
    state_.least_sq = BucketQueue::largest_bound;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const double bound = front.bound_of(records[i]);
      if (bound >= search_.pruning.cutoff()) continue;
      ++count;
      const float bound_sq = limits_.bound_of(bound);
      state_.least_sq = std::min(state_.least_sq, bound_sq);
      state_.queue.push({bound_sq, {0, 0}, static_cast<std::uint16_t>(i), NodePair::whole_record, false});
    }
    // What the last traversal has left open is new work in any case. Each open pair brings back at most one
    // record, so subtracting all of them can only make the number too small.
    const double compared_again = static_cast<double>(count) - static_cast<double>(front.open_count());
    return !records.empty() && compared_again < worth_resuming * static_cast<double>(records.size());
  }

  /// As process(), for a pair that stands for a record: the children that the record holds are to be compared again,
  /// unless they are beyond the cutoff by now.
  bool process_record(Expansion& e) {
    const std::uint16_t record = e.pair.record;
    const Front::Record& r = front_.get().records()[record];
    if (front_.get().bound_of(r) >= search_.pruning.cutoff()) return false;
    const Side side = r.expands_a ? Side::a : Side::b;
    e.start(trees_.tree(side), {e.pair.bound_sq, {r.slot[0], r.slot[1]}, NodePair::no_record, 0, false}, side);
    e.record = record;
    e.has_record = true;
    e.children = front_.get().take(record, search_.pruning.cutoff());
    return true;
  }

  Search search_;  // a bundle of references
  Collector& collector_;
  std::conditional_t<has_front, TraversalState&, TraversalState> state_;  // the front's, or our own
  FrontRecorder<has_front> front_;
  const simd::Kernels& kernels_;
  TreePair<needs_several> trees_;
  SquaredLimits limits_;
  OpenPairs<Collector::hits> open_;
  LeafComparison<Collector> leaves_;
  std::uint64_t first_step_ = 0;  // the value of state_.steps when this call of the query began
  std::uint32_t next_node_ = 0;   // for one model: one past the node to visit next; counts down to 0
};

}  // namespace limber::pair

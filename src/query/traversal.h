// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "core/check.h"
#include "core/error_bounds.h"
#include "query/budget_meter.h"
#include "query/common_vertices.h"
#include "query/frames.h"
#include "query/front.h"
#include "query/goals/improvement.h"
#include "query/likely_pair.h"
#include "query/placed_leaf.h"
#include "query/placed_models.h"
#include "query/pruning.h"
#include "query/traversal_state.h"

namespace limber::query {

/// The one loop of all queries between two models, and of a model with itself.
///
/// Based on  [Quinlan1994]: pairs of nodes are compared; those that cannot improve the answer are pruned, the others
///           expanded.
/// Differs   One node of a pair is expanded at a time, the looser one; its eight children are compared with the other
///           node at once. Pairs that overlap are taken first, then the nearest. Bounds also use the search direction,
///           in which the closest pair so far is apart.
///
/// `Goal` is described in query/goals/improvement.h. With `has_front` a front is recorded, or resumed, and owns the
/// state of the traversal. The traversal owns what is pruned, and nothing else changes while it runs: goals return
/// improvements, placed models are constant.
template <typename Goal, bool has_front>
class Traversal {
 public:
  Traversal(const PlacedModels& placed, Frames& frames, Pruning& pruning, Goal& goal, BudgetMeter& meter, Front* front,
            QueryStats& stats)
      : frames_(frames),
        placed_(placed),
        pruning_(pruning),
        goal_(goal),
        meter_(meter),
        state_(state_of(front)),
        front_(front),
        stats_(stats),
        kernels_(simd::kernels()),
        placed_leaf_{{placed, Side::a}, {placed, Side::b}} {
    const double ratio = placed.tree(Side::b).unit / placed.tree(Side::a).unit;
    to_a_sq_[1] = static_cast<float>(std::min(ratio * ratio, largest_unit_ratio_sq));
  }

  /// Begins with the two roots. Pre: the goal is not done.
  void start(double root_bound) {
    state_.clear();
    if (has_front || pruning_.has_direction()) state_.leaf_credit = first_leaf_credit;
    if constexpr (Goal::is_self) {
      static_assert(!has_front && Goal::needs_all);
      next_node_ = static_cast<std::uint32_t>(placed_.tree(Side::a).nodes.size());
      return;
    }
    if constexpr (can_guess) prepare_guess();
    const double units = root_bound / placed_.tree(Side::a).unit;
    state_.least_sq =
        static_cast<float>(std::min(units * units * double{core::squares_down}, double{BucketQueue::largest_bound}));
    const NodePair roots{state_.least_sq, {bvh::root, bvh::root}, Front::none, 0};
    if constexpr (!has_front && !Goal::needs_all) {
      if (!meter_.is_limited()) return descend_first(roots);
    }
    state_.queue.push_first(roots);
  }

  /// Begins with what the front has to have compared again. False if that is so much that a new traversal is cheaper,
  /// or if the front has no records. Pre: as above.
  bool start_with_records() {
    state_.clear();
    state_.leaf_credit = first_leaf_credit;
    if constexpr (can_guess) prepare_guess();
    return push_records();
  }
  /// Goes on with a state that a traversal with a front has left.
  void take_over(const TraversalState& state) requires(!has_front) { state_ = state; }
  /// Goes on where the traversal of the front was interrupted. Pre: as above, and the front says that it can.
  void go_on() {
    pruning_.restore_direction(front_->go_on());
    first_step_ = state_.steps;
  }

  /// Takes one more pair, or two. False when none that matters is left, or the budget is spent.
  bool step() {
    if (meter_.is_spent(state_.steps - first_step_) || goal_.is_done()) return false;
    if (state_.queue.empty()) return Goal::is_self && next_node_ > 0 && compare_siblings();
    update_limits();
    Expansion e;
    e.pair = state_.queue.pop();
    if constexpr (can_guess) {
      if (state_.guess == Guess::due && e.pair.bound_sq < limit_sq_[0]) guess(), update_limits();
      if (state_.steps >= state_.next_descent && state_.queue.has_only_ordered()) descend_again();
    }
    if (!begin(e)) return true;
    if (takes_two()) {
      Expansion second;
      second.pair = state_.queue.pop();
      const bool is_expanded = begin(second);
      update_limits();  // leaves may have been compared
      compare_children(e);
      if (is_expanded) {
        compare_children(second);
        keep(second);
      }
      keep(e);
      return true;
    }
    compare_children(e);
    keep(e);
    return true;
  }

  /// Ends the traversal, wherever it is. Returns a lower bound of the distance of all that is left, infinite if nothing
  /// is. With a front, what is left stays in the queue for the next traversal, unless the goal is done.
  double finish() {
    double least = state_.queue.empty() ? std::numeric_limits<double>::infinity()
                                        : length_of(Side::a, state_.queue.least_bound_sq());
    if constexpr (has_front) {
      if (state_.queue.empty() || goal_.is_done()) {
        front_->finish(placed_.tree(Side::a).unit);
      } else {
        front_->suspend(pruning_.cutoff(), pruning_.direction());
      }
    }
    if (Goal::is_self && next_node_ > 0) least = 0;  // siblings overlap
    return least;
  }

  /// Pairs of nodes and of leaves that were compared so far.
  std::uint64_t work() const { return state_.work; }
  /// Steps that tight bounds would have made unnecessary, as far as can be told; a fraction stands for a chance.
  double margin_cost() const { return margin_cost_; }

 private:
  using Guess = TraversalState::Guess;

  static decltype(auto) state_of(Front* front) {
    if constexpr (has_front) {
      return (front->state());
    } else {
      return TraversalState();
    }
  }

  static constexpr bool can_guess = TakesPoints<Goal>;

  /// The expansion of one node of a pair: its children are compared with the other node.
  struct Expansion {
    Side side;  // of the slot of `pair` that is expanded
    NodePair pair;
    std::uint32_t node;    // the child of that slot: its children are compared with the other slot
    std::uint16_t record;  // in the front: of this expansion, or where there was no room of the one that `pair` is from
    bool has_record;       // whether it is of this expansion
    unsigned children;     // to be compared, a bit mask
    simd::KeptSlots kept;  // not pruned
    alignas(32) float order[bvh::width];
  };

  /// Whether a slot is not expanded: it has a leaf, or all triangles below it coincide, so that any leaf below stands
  /// for it and no bound could tell them apart. With a motion margin vertices may be elsewhere than the mark says, and
  /// a goal that needs all pairs is offered each of the coincident triangles.
  bool is_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    const bvh::Tree& tree = placed_.tree(s);
    const std::uint32_t n = bvh::node_of(slot);
    const bool is_coincident = (tree.nodes[n].coincident_slots >> bvh::slot_of(slot) & 1) != 0;
    return n >= tree.first_lowest_node() || (!Goal::needs_all && is_coincident && tree.drift == 0);
  }
  /// The slot of the leaf that such a slot has or stands for. Pre: is_leaf().
  bvh::SlotId leaf_slot(Side s, const NodePair& pair) const {
    return bvh::first_leaf_slot(placed_.tree(s), pair.slot[index(s)]);
  }
  std::uint32_t child_of(Side s, bvh::SlotId slot) const {
    return placed_.tree(s).nodes[bvh::node_of(slot)].first_child + bvh::slot_of(slot);
  }
  simd::OtherNode as_node(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    return {&placed_.tree(s).nodes[bvh::node_of(slot)], bvh::slot_of(slot), nullptr};
  }
  simd::OtherNode as_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = placed_.tree(s);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &tree.leaves[child_of(s, slot)].corners};
  }
  const bvh::Leaf& leaf(Side s, const NodePair& pair) const {
    return placed_.tree(s).leaves[child_of(s, leaf_slot(s, pair))];
  }

  /// How loose the bound of a slot makes a pair: half the thickness of its slab, and a little of its radius.
  double looseness(Side s, bvh::SlotId slot) const {
    const bvh::Tree& tree = placed_.tree(s);
    const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
    const std::uint32_t k = bvh::slot_of(slot);
    return tree.unit * static_cast<double>((n.high[k] - n.low[k]) * 0.5F + share_of_radius * n.radius[k]);
  }
  /// Whether to expand the node of a: it can be, and the other cannot or is no looser.
  bool expands_a(const NodePair& pair) const {
    const bool is_looser = looseness(Side::a, pair.slot[0]) >= looseness(Side::b, pair.slot[1]);
    // Bitwise: branches here would be mispredicted.
    const bool is_leaf_a = is_leaf(Side::a, pair), is_leaf_b = is_leaf(Side::b, pair);
    return (static_cast<int>(is_looser) | static_cast<int>(is_leaf_b)) > static_cast<int>(is_leaf_a);
  }

  /// Goes straight down from the nearest pair again: best first comes to leaves late, so that the prune distance would
  /// be that of the first leaves for long. Not with a front, nor after a good guess: then a close pair is known. Not
  /// inlined: it is rare. Called where no bounds of queued pairs overlap: the deepest overlap is followed to its leaves
  /// anyway.
  [[gnu::noinline]] void descend_again() {
    state_.descends = !has_front && !state_.has_guessed_well;
    state_.next_descent = descent_factor * state_.steps;
  }

  /// Whether to expand two pairs side by side. The processor then compares the children of one while it waits for those
  /// of the other. Only where it matters little which pair comes first.
  bool takes_two() const { return !state_.descends && state_.queue.has_only_ordered(); }

  /// The chance that a pair would have been pruned without the margin: 1 if the prune distance exceeds the margin.
  /// Otherwise bounds do not tell; the larger the margin is next to the looseness of the bounds, the likelier it is.
  /// Pre: pair.bound_sq >= tight_sq_.
  double chance_of_margin_cost(const NodePair& pair) const {
    if (tight_sq_ > 0) return 1;
    const double loose = looseness(Side::a, pair.slot[0]) + looseness(Side::b, pair.slot[1]);
    return placed_.drift() / (placed_.drift() + loose);
  }

  /// A lower bound as a length.
  double length_of(Side s, float bound_sq) const {
    return std::sqrt(static_cast<double>(bound_sq)) * placed_.tree(s).unit * double{core::squares_down};
  }
  /// Gives a pair that is not expanded to the record that it comes from.
  void put_back(const NodePair& pair, Front::Kind kind, double distance) {
    if (pair.record != Front::none) front_->put(pair.record, 1U << pair.child, kind, distance);
  }
  /// Settles a pair, pruned or compared: what it holds is at least `distance` or the cutoff apart.
  void settle(const NodePair& pair, double distance) {
    if (has_front) put_back(pair, kind_of(distance), std::max(distance, pruning_.cutoff()));
  }
  /// Of what is settled at that distance.
  Front::Kind kind_of(double distance) const {
    constexpr double hardly = 1 + 1. / 64;  // (docs/design/real_time.md)
    return distance < hardly * pruning_.cutoff() ? Front::near : Front::settled;
  }

  /// Queues what has to be compared again. False if that is so much that a new traversal is cheaper, or if there are no
  /// records.
  bool push_records() {
    const std::span<const Front::Record> records = front_->records();
    state_.descends = false;
    const double to_units = 1 / placed_.tree(Side::a).unit;
    std::size_t count = 0;
    state_.least_sq = BucketQueue::largest_bound;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const double bound = front_->bound_of(records[i]);
      if (bound >= pruning_.cutoff()) continue;
      ++count;
      const double units = bound * to_units;
      const double bound_sq = std::min(units * units * double{core::squares_down}, double{BucketQueue::largest_bound});
      state_.least_sq = std::min(state_.least_sq, static_cast<float>(bound_sq));
      state_.queue.push({static_cast<float>(bound_sq), {0, 0}, static_cast<std::uint16_t>(i), NodePair::whole_record});
    }
    // Those that were open have to be expanded in a new traversal too.
    const double of_no_use = static_cast<double>(count) - static_cast<double>(front_->open_count());
    return !records.empty() && of_no_use < worth_resuming * static_cast<double>(records.size());
  }

  /// Brings what is derived from the prune distance up to date.
  void update_limits() {
    if (pruning_.distance() == limits_for_) return;
    limits_for_ = pruning_.distance();
    const double tight = std::max(0.0, limits_for_ - placed_.drift()) / placed_.tree(Side::a).unit;
    tight_sq_ = static_cast<float>(std::min(tight * tight, double{BucketQueue::no_limit_sq}));
    for (const Side s : {Side::a, Side::b}) {
      const double units = limits_for_ / placed_.tree(s).unit;
      const double limit = std::min(units * units * (1 + core::storage_error), double{BucketQueue::no_limit_sq});
      // A positive limit never prunes a pair whose bound is 0.
      limit_sq_[index(s)] = std::max(static_cast<float>(limit), std::numeric_limits<float>::min());
    }
    if (limit_sq_[0] - state_.least_sq > worth_refocusing * (state_.focus_sq - state_.least_sq)) return;
    state_.focus_sq = limit_sq_[0];
    state_.queue.focus(state_.least_sq, state_.focus_sq);
  }

  /// Begins with what was taken from the queue. False if it is pruned, or a pair of leaves, which are compared.
  bool begin(Expansion& e) {
    return has_front && e.pair.child == NodePair::whole_record ? expand_record(e) : expand(e);
  }

  /// The same for a pair.
  bool expand(Expansion& e) {
    const NodePair& pair = e.pair;
    if (pair.bound_sq >= limit_sq_[0]) {
      settle(pair, length_of(Side::a, pair.bound_sq));
      // With a front, each remaining pair has to be settled on its own.
      if (!has_front && !state_.queue.empty() && state_.queue.all_beyond(limit_sq_[0])) state_.queue.clear();
      return false;
    }
    if constexpr (Goal::is_self) {
      if (share_and_are_apart(pair)) return false;
    }
    ++state_.steps;
    if (placed_.drift() > 0 && pair.bound_sq >= tight_sq_) margin_cost_ += chance_of_margin_cost(pair);
    if (is_leaf(Side::a, pair) && is_leaf(Side::b, pair)) {
      double apart = 0;
      if (compare_leaves(pair, apart)) {
        settle(pair, apart);
      } else {
        state_.queue.push_first(pair);
      }
      return false;
    }
    e.side = expands_a(pair) ? Side::a : Side::b;
    e.node = child_of(e.side, pair.slot[index(e.side)]);
    e.children = (1U << placed_.tree(e.side).nodes[e.node].child_count) - 1;
    e.record = has_front ? front_->add(pair.slot, e.side) : Front::none;
    e.has_record = e.record != Front::none;
    if (!e.has_record) e.record = pair.record;
    return true;
  }

  /// Whether the triangles of a model below two slots need not be compared, because they meet only in what all of them
  /// share: those of a fan or a book. Leaves are too small for this test to pay.
  bool share_and_are_apart(const NodePair& pair) const {
    const bvh::Tree& tree = placed_.tree(Side::a);
    const std::uint32_t end = tree.first_lowest_node();
    if (bvh::node_of(pair.slot[0]) >= end || bvh::node_of(pair.slot[1]) >= end) return false;
    const Apart what = ComparesLeaves<Goal> ? Apart::elements : Apart::triangles;
    return query::share_and_are_apart(placed_, pair.slot[0], pair.slot[1], what, pruning_.distance());
  }

  /// Takes the next node of a model that is compared with itself, from the last to the first: its child slots with each
  /// other, and leaves with themselves. All nodes together have every pair of triangles once. Always true.
  bool compare_siblings() {
    LIMBER_ASSERT(next_node_ > 0 && state_.queue.empty());
    update_limits();
    ++state_.steps;
    const bvh::Tree& tree = placed_.tree(Side::a);
    const std::uint32_t n = --next_node_, count = tree.nodes[n].child_count;
    const bool has_leaves = n >= tree.first_lowest_node();
    for (std::uint32_t k = 0; k < count && !goal_.is_done(); ++k) {
      const bvh::SlotId slot = n * bvh::width + k;
      if (has_leaves) state_.queue.push_first({0, {slot, slot}, Front::none, 0});
      if (k + 1 == count) break;
      Expansion e;
      e.pair = {0, {slot, bvh::root}, Front::none, 0};
      e.side = Side::b, e.node = n;
      e.children = (1U << count) - (2U << k);  // those after k
      e.record = Front::none, e.has_record = false;
      compare_children(e);
      keep(e);
    }
    return true;
  }

  /// Expands again what a record has not expanded. False if that is pruned.
  bool expand_record(Expansion& e) {
    const std::uint16_t record = e.pair.record;
    const Front::Record& r = front_->records()[record];
    if (front_->bound_of(r) >= pruning_.cutoff()) return false;
    e.side = r.expands_a ? Side::a : Side::b;
    e.pair = {e.pair.bound_sq, {r.slot[0], r.slot[1]}, Front::none, 0};
    e.node = child_of(e.side, r.slot[index(e.side)]);
    e.record = record;
    e.has_record = true;
    e.children = front_->take(record, pruning_.cutoff());
    return true;
  }

  /// Compares the children of the expanded node with the other node.
  void compare_children(Expansion& e) {
    LIMBER_ASSERT(e.children != 0);
    ++state_.work;
    const Side s = other(e.side);
    const simd::OtherNode other_node = is_leaf(s, e.pair) ? as_leaf(s, e.pair) : as_node(s, e.pair);
    const bvh::WideNode& node = placed_.tree(e.side).nodes[e.node];
    stats_.node_tests += node.child_count;
    alignas(32) float bound_sq[bvh::width];
    const simd::KeptSlots kept =
        kernels_.bound_children(node, other_node, frames_.of(e.side), pruning_.of(e.side), limit_sq_[index(e.side)],
                                e.order, has_front ? bound_sq : nullptr);
    // In variables of their own: GCC would combine the masks in memory, where the processor waits for them.
    const unsigned all = kept.all & e.children, overlapping = kept.overlapping & e.children;
    e.kept = {all, overlapping};
    if (state_.has_aimed) judge_direction(e);
    const unsigned pruned = e.children & ~e.kept.all;
    if (has_front && pruned != 0) record_pruned(e, pruned, bound_sq);
  }

  void record_pruned(const Expansion& e, unsigned children, const float* bound_sq) {
    float least = BucketQueue::no_limit_sq;
    for (unsigned rest = children; rest != 0; rest &= rest - 1) {
      least = std::min(least, bound_sq[std::countr_zero(rest)]);
    }
    const double distance = std::max(length_of(e.side, least), pruning_.cutoff());
    if (e.record == Front::none) return;
    front_->put(e.record, e.has_record ? children : 1U << e.pair.child, kind_of(distance), distance);
  }

  /// Puts the children that are kept where they will be taken in the right order.
  void keep(const Expansion& e) {
    if (e.kept.all == 0) return;
    if constexpr (Goal::needs_all && Goal::takes_any) {  // any order will do
      for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
        state_.queue.push_first(child_pair(e, static_cast<std::uint32_t>(std::countr_zero(rest))));
      }
      return;
    }
    unsigned overlapping = e.kept.overlapping;
    if (overlapping == 0) {
      if (!Goal::takes_any && state_.descends) return descend(e);
      if (!Goal::takes_any && state_.steps >= nearest_last_from_step) return push_nearest_last(e);
      return push(e, e.kept.all);
    }
    push(e, e.kept.all & ~overlapping);
    // The deepest overlap last, so that it is taken first.
    while (overlapping != 0) {
      auto shallowest = static_cast<std::uint32_t>(std::countr_zero(overlapping));
      for (unsigned rest = overlapping & (overlapping - 1); rest != 0; rest &= rest - 1) {
        const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
        if (e.order[child] >= e.order[shallowest]) shallowest = child;
      }
      overlapping &= ~(1U << shallowest);
      state_.queue.push_first(child_pair(e, shallowest));
    }
  }

  /// Straight down from the roots to the first two leaves. What is left on the way is queued only if these do not end
  /// the query, as they often do where models intersect.
  void descend_first(const NodePair& roots) {
    update_limits();
    if constexpr (can_guess) {
      if (state_.guess == Guess::due && roots.bound_sq < limit_sq_[0]) guess(), update_limits();
    }
    if (!state_.descends) return state_.queue.push_first(roots);
    NodePair pair = roots;
    Expansion way[longest_descent];
    std::uint32_t length = 0;
    for (;; ++length) {
      LIMBER_ASSERT(length < longest_descent);
      Expansion& e = way[length];
      e.pair = pair;
      if (!expand(e)) break;
      compare_children(e);
      if (e.kept.all == 0) break;
      const std::uint32_t child = first_child(e);
      pair = child_pair(e, child);
      e.kept.all &= ~(1U << child), e.kept.overlapping &= ~(1U << child);
    }
    if (goal_.is_done()) return;
    const bool descends_on = std::exchange(state_.descends, false);
    for (std::uint32_t i = 0; i < length; ++i) keep(way[i]);
    state_.descends = descends_on;
  }

  /// The deepest overlap, or the nearest child if none overlaps.
  std::uint32_t first_child(const Expansion& e) const {
    if (e.kept.overlapping == 0) return nearest_child(e);
    auto deepest = static_cast<std::uint32_t>(std::countr_zero(e.kept.overlapping));
    for (unsigned rest = e.kept.overlapping & (e.kept.overlapping - 1); rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (e.order[child] < e.order[deepest]) deepest = child;
    }
    return deepest;
  }

  std::uint32_t nearest_child(const Expansion& e) const {
    auto nearest = static_cast<std::uint32_t>(std::countr_zero(e.kept.all));
    for (unsigned rest = e.kept.all; rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
      if (e.order[child] < e.order[nearest]) nearest = child;
    }
    return nearest;
  }

  /// Straight down, to the nearest child.
  void descend(const Expansion& e) {
    const std::uint32_t nearest = nearest_child(e);
    push(e, e.kept.all & ~(1U << nearest));
    state_.queue.push_first(child_pair(e, nearest));
  }

  /// Pushes the nearest child last, so that it is popped before its siblings of the same bucket. Not inlined: shorter
  /// queries should not pay for it.
  [[gnu::noinline]] void push_nearest_last(const Expansion& e) {
    const std::uint32_t nearest = nearest_child(e);
    push(e, e.kept.all & ~(1U << nearest));
    state_.queue.push(child_pair(e, nearest));
  }

  void push(const Expansion& e, unsigned children) {
    for (; children != 0; children &= children - 1) {
      state_.queue.push(child_pair(e, static_cast<std::uint32_t>(std::countr_zero(children))));
    }
  }

  NodePair child_pair(const Expansion& e, std::uint32_t child) const {
    // Never as large as `no_limit_sq`, which must not prune, even where the product overflows.
    const float bound_sq =
        std::min(std::max(e.order[child] * to_a_sq_[index(e.side)], e.pair.bound_sq), BucketQueue::largest_bound);
    const bvh::SlotId slot = e.node * bvh::width + child;
    const bool of_a = e.side == Side::a;
    return {bound_sq,
            {of_a ? slot : e.pair.slot[0], of_a ? e.pair.slot[1] : slot},
            e.record,
            static_cast<std::uint16_t>(e.has_record ? child : e.pair.child)};
  }

  /// The same as below for a goal that compares leaves itself.
  bool compare_leaves(const NodePair& pair, double&) requires ComparesLeaves<Goal> {
    static_assert(!has_front);
    ++state_.work;
    const LeafPair leaves{as_leaf(Side::a, pair), as_leaf(Side::b, pair), leaf(Side::a, pair),
                          leaf(Side::b, pair),    frames_.of(Side::a),    pruning_.of(Side::a)};
    goal_.compare_leaves(leaves, stats_);
    return !goal_.is_done();
  }

  /// Chooses the normal of the flatter of two leaves that are apart as the search direction: what is near them is
  /// likely to be apart along it, too. Not inlined: the loop of a query should not pay for it.
  [[gnu::noinline]] void aim(const NodePair& pair) {
    if (pruning_.has_direction() || state_.wasted_aims == most_wasted_aims) return;
    const bvh::SlotId slots[2] = {leaf_slot(Side::a, pair), leaf_slot(Side::b, pair)};
    double flatness[2];
    Vec3 normal[2], center[2];
    for (const Side s : {Side::a, Side::b}) {
      const bvh::Tree& tree = placed_.tree(s);
      const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slots[index(s)])].bounds;
      const std::uint32_t k = bvh::slot_of(slots[index(s)]);
      flatness[index(s)] = static_cast<double>(n.high[k] - n.low[k]) * tree.unit;
      normal[index(s)] = placed_.pose(s).rotation * Vec3{n.normal_x[k], n.normal_y[k], n.normal_z[k]};
      center[index(s)] = placed_.pose(s)(bvh::slot_center(tree, slots[index(s)]));
    }
    const Vec3 n = flatness[0] <= flatness[1] ? normal[0] : normal[1];
    pruning_.aim(dot(n, center[1] - center[0]) < 0 ? -n : n);
    state_.has_aimed = pruning_.has_direction();
  }

  /// Gives a search direction up that has pruned nothing for a while.
  void judge_direction(const Expansion& e) {
    bool has_pruned = false;  // what no other bound has
    for (unsigned rest = e.children & ~e.kept.all; rest != 0; rest &= rest - 1) {
      has_pruned |= e.order[std::countr_zero(rest)] < limit_sq_[index(e.side)];
    }
    state_.idle_expansions = has_pruned ? 0 : state_.idle_expansions + 1;
    if (state_.idle_expansions < most_idle_expansions) return;
    state_.idle_expansions = 0;
    ++state_.wasted_aims;
    state_.has_aimed = false;
    pruning_.forget_direction();
  }

  /// Whether to guess. Where all pairs beyond a limit are pruned, a close pair saves nothing until one within the limit
  /// is found.
  void prepare_guess() {
    if (std::isinf(pruning_.distance()) || pruning_.distance() < goal_.initial_prune_distance()) {
      state_.guess = Guess::due;
    }
  }

  /// Compares two triangles that are likely to be the closest, where one model is flat.
  [[gnu::noinline]] void guess() {
    const bool is_first = state_.guess_near[0] == bvh::root && state_.guess_near[1] == bvh::root;
    const std::optional<FlatPart> part = flat_part(placed_, state_.guess_near[0], state_.guess_near[1]);
    // Before any triangles have been compared it is worth it only if the models may well be apart.
    const bool is_worth_it = part && (!is_first || part->room >= least_room * part->radius);
    state_.guess = is_first && !is_worth_it ? Guess::none : Guess::made;
    if (!is_worth_it) return;
    const std::optional<TrianglePair> likely = likely_pair(placed_, *part, stats_);
    if (!likely) return;
    state_.descends = false;
    ++stats_.triangle_tests;
    const PlacedTriangle a{likely->a, placed_.triangle(Side::a, likely->a)};
    const PlacedTriangle b{likely->b, placed_.triangle(Side::b, likely->b)};
    if (const auto improvement = goal_.compare(a, b)) {
      pruning_.improve(*improvement);
      state_.has_guessed_well = true;
      state_.leaf_credit = most_leaf_credit;
    }
  }

  /// Whether the search direction prunes two leaves as a whole. Where it seldom does, it is no longer asked.
  bool prunes_leaves(PlacedLeaf& a, PlacedLeaf& b, double& apart) {
    const bool is_pruned = pruning_.prunes(a, b, apart);
    state_.leaf_credit =
        is_pruned ? std::min(state_.leaf_credit + gain_of_leaves, most_leaf_credit) : state_.leaf_credit - 1;
    return is_pruned;
  }

  /// Looks for triangles that intersect in the first two leaves, whose volumes overlap: that takes a fraction of the
  /// time of finding the closest, and ends the query. Up to 64 exact tests. Pre: both leaves are taken.
  bool find_contact(const simd::OtherNode& leaf_a, const simd::OtherNode& leaf_b, simd::Candidates& found) {
    simd::PruneLimits contact{};
    contact.distance = simd::smallest_prune_distance;
    kernels_.find_candidates(leaf_a, leaf_b, frames_.of(Side::a), contact, nullptr, false, found);
    for (std::uint32_t i = 0; i < found.count; ++i) {
      const PlacedTriangle &a = placed_leaf_[0].at(found.pairs[i].slot_a),
                           &b = placed_leaf_[1].at(found.pairs[i].slot_b);
      ++stats_.triangle_tests;
      if (!geometry::intersects(a.corners, b.corners)) continue;
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      if (const auto improvement = goal_.take(0, {shared, shared, a.id, b.id})) pruning_.improve(*improvement);
      return true;
    }
    return false;
  }

  /// Where a descent has ended: compares the nearest two triangles, although the allowed error would let them be
  /// pruned. If they are nearer than the best so far, more can be pruned from now on.
  [[gnu::noinline]] void look_nearer(const simd::OtherNode& leaf_a, const simd::OtherNode& leaf_b,
                                     simd::Candidates& found) {
    simd::PruneLimits nearer = pruning_.of(Side::a);
    nearer.distance = pruning_.best_distance();
    kernels_.find_candidates(leaf_a, leaf_b, frames_.of(Side::a), nearer, nullptr, false, found);
    if (found.count == 0) return;
    const std::uint32_t i = nearest_of(found);
    ++stats_.triangle_tests;
    const auto improvement =
        goal_.compare(placed_leaf_[0].at(found.pairs[i].slot_a), placed_leaf_[1].at(found.pairs[i].slot_b));
    if (improvement) pruning_.improve(*improvement);
  }

  static std::uint32_t nearest_of(const simd::Candidates& found) {
    std::uint32_t nearest = 0;
    for (std::uint32_t i = 1; i < found.count; ++i) {
      if (found.pairs[i].bound_sq < found.pairs[nearest].bound_sq) nearest = i;
    }
    return nearest;
  }

  /// False if the goal or the budget has ended it before all triangles were compared. Otherwise leaves in `apart` a
  /// lower bound of their distance, which may be above the prune distance.
  bool compare_leaves(const NodePair& pair, double& apart) requires(!ComparesLeaves<Goal>) {
    simd::Candidates found;
    const simd::OtherNode leaf_a = as_leaf(Side::a, pair), leaf_b = as_leaf(Side::b, pair);
    const simd::SelfPair self{leaf(Side::a, pair), leaf(Side::b, pair)};
    PlacedLeaf &a = placed_leaf_[0], &b = placed_leaf_[1];
    a.take(self.a), b.take(self.b);
    const bool is_first = state_.next_descent == TraversalState::never;  // no leaves have been compared
    const bool descends = std::exchange(state_.descends, false);
    state_.next_descent = std::max(is_first ? 0 : state_.next_descent, state_.steps + steps_to_descent);
    if constexpr (can_guess) {
      if (state_.leaf_credit > 0 && prunes_leaves(a, b, apart)) return true;
      if (is_first && descends && pair.bound_sq == 0 && find_contact(leaf_a, leaf_b, found)) {
        return false;
      }
      if (descends && pruning_.has_error()) {
        look_nearer(leaf_a, leaf_b, found);
        if (goal_.is_done()) return false;
      }
    }
    kernels_.find_candidates(leaf_a, leaf_b, frames_.of(Side::a), pruning_.of(Side::a), Goal::is_self ? &self : nullptr,
                             has_front, found);
    ++state_.work;
    if (found.count == 0) {
      if constexpr (!Goal::needs_all) aim(pair);
      if (has_front) apart = static_cast<double>(found.apart) / found.scale;
      return true;
    }
    // The nearest first: it may prune the others.
    std::swap(found.pairs[0], found.pairs[nearest_of(found)]);
    for (std::uint32_t i = 0; i < found.count; ++i) {
      if (goal_.is_done()) return false;
      const double limit = pruning_.distance() * found.scale + static_cast<double>(found.error);
      const auto bound_sq = static_cast<double>(found.pairs[i].bound_sq);
      if (bound_sq >= limit * limit * double{core::squares_up}) continue;
      const double tight = limit - placed_.drift() * found.scale;
      if (placed_.drift() > 0 && bound_sq >= tight * tight) margin_cost_ += 1;
      const std::uint32_t slot_a = found.pairs[i].slot_a, slot_b = found.pairs[i].slot_b;
      if (Goal::needs_all && (a.is_repeated(slot_a) || b.is_repeated(slot_b))) continue;
      if (pruning_.prunes(a, slot_a, b, slot_b)) continue;
      ++stats_.triangle_tests;
      if (const auto improvement = goal_.compare(a.at(slot_a), b.at(slot_b))) {
        pruning_.improve(*improvement);
        state_.has_aimed = false;
      }
      if (meter_.cuts_short(state_.steps - first_step_)) return false;
    }
    if constexpr (can_guess) {
      const bool has_found_any = pruning_.has_direction() && pruning_.distance() < goal_.initial_prune_distance();
      if (state_.guess == Guess::none && has_found_any) {
        state_.guess_near[0] = leaf_slot(Side::a, pair), state_.guess_near[1] = leaf_slot(Side::b, pair);
        state_.guess = Guess::due;
      }
    }
    return !goal_.is_done();
  }

  // A search direction that prunes nothing in so many expansions is given up; after so many, no other is chosen.
  static constexpr int most_idle_expansions = 3, most_wasted_aims = 2;
  // Leaves are pruned as a whole while it pays: what a success gains, in failures; at first, and at most.
  static constexpr int gain_of_leaves = 2, first_leaf_credit = 8, most_leaf_credit = 64;
  // Of the radius of a sphere in looseness() (docs/algorithms/traversal.md).
  static constexpr float share_of_radius = 0.01F;
  // The queue is sorted anew when the range of bounds that matter has shrunk to this part of itself.
  static constexpr float worth_refocusing = 0.5F;
  // From this step on the nearest child is pushed last, where none overlaps: in shorter queries, to find it costs more
  // than it saves (docs/design/fast_engine.md).
  static constexpr std::uint64_t nearest_last_from_step = 1024;
  // A descent begins after so many steps without comparing leaves, and not before the number of steps is so many times
  // what it was at the last descent.
  static constexpr std::uint64_t steps_to_descent = 9, descent_factor = 3;
  // Expansions of two trees of at most 11 levels each.
  static constexpr std::uint32_t longest_descent = 23;
  // Room between a flat part and the other model, in radii of the latter, from which on triangles are guessed at once.
  static constexpr double least_room = -3. / 8;
  // A front is resumed if less than this part of it has to be compared again.
  static constexpr double worth_resuming = 0.5;
  // Larger squared ratios of units leave the range of float32.
  static constexpr double largest_unit_ratio_sq = 0x1p126;

  Frames& frames_;
  const PlacedModels& placed_;
  Pruning& pruning_;
  Goal& goal_;
  BudgetMeter& meter_;
  std::conditional_t<has_front, TraversalState&, TraversalState> state_;  // the front's, or our own
  Front* front_;                                                          // null without one
  QueryStats& stats_;
  const simd::Kernels& kernels_;
  double limits_for_ = -1;      // prune distance that what follows was derived from
  float limit_sq_[2] = {0, 0};  // the same squared, in units of either tree
  float tight_sq_ = 0;          // what it would be without a margin, in squared units of a
  float to_a_sq_[2] = {1, 1};   // squared units of either tree in those of a
  double margin_cost_ = 0;
  std::uint64_t first_step_ = 0;  // of state_.steps: how many were made before this traversal went on
  std::uint32_t next_node_ = 0;   // for one model: after the node whose child slots are compared next
  PlacedLeaf placed_leaf_[2];     // of the pair that was compared last
};

}  // namespace limber::query

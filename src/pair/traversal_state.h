// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/check.h"
#include "bvh/tree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "pair/collectors/collector.h"
#include "pair/node_pair.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"

namespace limber::pair {

// A guess of the closest pair where one model lies or moves over a flat part of the other, a floor, a wall, the top of
// a table: the vertex nearest to the plane of that part, and the triangle at its foot in the plane. Below, the model
// with the flat part is the ground, and the other one is above it.

/// A part of a model that is flat for as far as the other one reaches.
struct FlatPart {
  Side side;      ///< the ground: the model that has this part
  Vec3 center;    ///< in the world
  Vec3 normal;    ///< towards the other model, in the world
  double radius;  ///< of the bounding sphere of the other model
  double room;  ///< from the part to the bounding volume of the other model, along the normal; negative if they overlap
};

/// The largest flat part of the larger model: its slot, `near_a` or `near_b`, or one above that slot. None if the slot
/// itself is not flat, or if all flat ones are smaller than the other model.
std::optional<FlatPart> flat_part(const PlacedPair& placed, bvh::SlotId near_a, bvh::SlotId near_b);

/// A pair of triangles that is likely to be the closest: a triangle of the other model at the vertex that comes nearest
/// to the plane of a flat part, and one at the foot of that vertex. None if the vertex is beyond the plane.
///
/// Both searches end after a fixed number of nodes, so neither triangle need be exactly the one described.
std::optional<TrianglePair> likely_pair(const PlacedPair& placed, const FlatPart& part, QueryStats& stats);

/// Decides when a traversal descends: goes straight down to two leaves, always to the nearest child, instead of taking
/// the nearest pair of all.
///
/// Best first comes to leaves late, so the upper bound would stay loose for long. So a traversal begins with a descent,
/// and descends again from time to time (docs/design/one_query.md).
class Descents {
 public:
  bool is_descending() const { return descends_; }
  bool has_reached_leaves() const { return next_ != never; }
  /// Whether to begin another descent.
  bool is_due(std::uint64_t steps) const { return steps >= next_; }

  /// Begins a descent that is due, and sets when the next one is due.
  void start(std::uint64_t steps) {
    postpone(steps);
    descends_ = true;
  }
  /// Leaves out a descent that is due, and sets when the next one is due.
  void postpone(std::uint64_t steps) {
    descends_ = false;
    next_ = factor * steps;
  }
  void stop() { descends_ = false; }
  /// Ends a descent: two leaves are compared. Returns whether there was one.
  bool end_at_leaves(std::uint64_t steps) {
    next_ = std::max(has_reached_leaves() ? next_ : 0, steps + steps_between);
    return std::exchange(descends_, false);
  }

 private:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  // A descent begins after so many steps without comparing leaves, and not before the number of steps is so many times
  // what it was at the last descent.
  static constexpr std::uint64_t steps_between = 9, factor = 3;

  std::uint64_t next_ = never;
  bool descends_ = true;
};

/// The seed of a traversal where one model is flat: a pair of triangles that is likely to be the closest. It is looked
/// for at the roots first, and if these are not flat, once more near the first leaves that were compared.
class FlatSeed {
 public:
  bool is_due() const { return state_ == State::due; }
  /// Whether the pair was the closest known.
  bool was_close() const { return was_close_; }

  void make_due() { state_ = State::due; }
  /// Whether no pair has been looked for next to a flat part so far.
  bool may_look_near() const { return state_ == State::none; }
  /// Looks again, near two slots. Pre: may_look_near().
  void look_near(bvh::SlotId a, bvh::SlotId b) {
    LIMBER_ASSERT(may_look_near());
    near_[0] = a, near_[1] = b;
    state_ = State::due;
  }
  void note_close() { was_close_ = true; }

  /// Looks for the pair. Pre: is_due().
  std::optional<TrianglePair> find(const PlacedPair& placed, QueryStats& stats) {
    LIMBER_ASSERT(is_due());
    const bool is_first = near_[0] == bvh::root_slot && near_[1] == bvh::root_slot;
    const std::optional<FlatPart> part = flat_part(placed, near_[0], near_[1]);
    // Before any triangles have been compared it is worth it only if the models may well be apart.
    const bool is_worth_it = part && (!is_first || part->room >= least_room * part->radius);
    state_ = is_first && !is_worth_it ? State::none : State::done;
    return is_worth_it ? likely_pair(placed, *part, stats) : std::nullopt;
  }

 private:
  enum class State : std::uint8_t { none, due, done };
  // Least gap between a flat part and the other model, in radii of the latter, to look for a pair before any triangles
  // have been compared. Negative: the model's bounds may reach through the flat part.
  static constexpr double least_room = -3. / 8;

  State state_ = State::none;
  bool was_close_ = false;
  bvh::SlotId near_[2] = {bvh::root_slot, bvh::root_slot};
};

/// Decides whether two leaves are first tested as a whole: whether the search direction tells all their triangles
/// apart. That test pays where the direction is that of a close pair, and everything is nearly as far apart. It is made
/// on credit: a success adds to the credit, a failure takes from it, and without credit there are no more tests.
class WholeLeaves {
 public:
  bool are_tested() const { return credit_ > 0; }

  /// Gives a little credit: a direction is known that may be that of a close pair.
  void allow_some() { credit_ = at_first; }
  /// Gives all credit: a close pair has been found.
  void allow_many() { credit_ = most; }
  /// Notes whether a test has pruned its two leaves.
  void note(bool is_pruned) { credit_ = is_pruned ? std::min(credit_ + gain, most) : credit_ - 1; }

 private:
  // In failures: a success saves about two, as measured.
  static constexpr int gain = 2, at_first = 8, most = 64;

  int credit_ = 0;
};

/// What a best-first traversal carries from one step to the next, except for its cutoff and direction (Pruning). A
/// traversal that is interrupted and finds its state again does the steps that it would have done without the
/// interruption.
struct TraversalState {
  BucketQueue queue;
  float least_sq = 0, focus_sq = BucketQueue::no_limit_sq;  // the bounds between which its buckets lie
  std::uint64_t steps = 0;
  std::uint64_t work = 0;    // pairs that kernels have compared; those of a front's records too, which are no steps
  Descents descents;         // when to go straight down to two leaves, so that the cutoff is low soon
  WholeLeaves whole_leaves;  // whether leaves are tested as a whole before their triangles are compared
  FlatSeed seed;             // a guess of the closest pair over a flat part of a model

  TraversalState() {}  // NOLINT: a defaulted one would let callers clear the queue's memory

  /// Starts a traversal. The queue's memory is not written.
  void clear() {
    queue.clear();
    least_sq = 0, focus_sq = BucketQueue::no_limit_sq;
    steps = work = 0;
    descents = {}, whole_leaves = {}, seed = {};
  }
};

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

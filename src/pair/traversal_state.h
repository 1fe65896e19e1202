// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include "base/check.h"
#include "limber/distance.h"
#include "pair/bucket_queue.h"
#include "pair/likely_pair.h"
#include "pair/placed_pair.h"

namespace limber::pair {

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

}  // namespace limber::pair

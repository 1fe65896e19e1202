// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>

#include "query/bucket_queue.h"

namespace limber::query {

/// What a traversal carries from one step to the next, apart from what it prunes by. A traversal that is interrupted
/// and finds its state again does the steps that it would have done without the interruption.
struct TraversalState {
  /// Whether two triangles that are likely to be the closest still have to be looked for; `none` where nothing flat has
  /// been found so far.
  enum class Guess : std::uint8_t { none, due, made };

  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();

  BucketQueue queue;
  float least_sq = 0, focus_sq = BucketQueue::no_limit_sq;  // the focus of the queue
  std::uint64_t steps = 0;
  std::uint64_t work = 0;              // kernel calls: with records that were compared again, which are no steps
  std::uint64_t next_descent = never;  // the step from which on to descend again
  int idle_expansions = 0, wasted_aims = 0;
  bool has_aimed = false;  // whether the search direction is one that aim() has chosen
  bool descends = true;    // straight down, until leaves have been compared
  Guess guess = Guess::none;
  bool has_guessed_well = false;                       // the pair of the guess was the closest known then
  int leaf_credit = 0;                                 // leaves are pruned as a whole while this is above 0
  bvh::SlotId guess_near[2] = {bvh::root, bvh::root};  // where to look for a likely pair

  TraversalState() {}  // NOLINT: a defaulted one would let callers clear the queue's memory

  /// Starts a traversal. The queue's memory is not written.
  void clear() {
    queue.clear();
    least_sq = 0, focus_sq = BucketQueue::no_limit_sq;
    steps = work = 0;
    next_descent = never;
    idle_expansions = wasted_aims = 0;
    has_aimed = false;
    descends = true;
    guess = Guess::none;
    has_guessed_well = false;
    leaf_credit = 0;
    guess_near[0] = guess_near[1] = bvh::root;
  }
};

}  // namespace limber::query

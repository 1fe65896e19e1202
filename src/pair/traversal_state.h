// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pair/bucket_queue.h"
#include "pair/descents.h"
#include "pair/seeds/flat_seed.h"
#include "pair/whole_leaves.h"

namespace limber::pair {

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

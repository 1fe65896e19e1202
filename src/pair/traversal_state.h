// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "pair/bucket_order.h"
#include "pair/flat_seed.h"

namespace limber::pair {

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
  // In failures: a success saves about two, as measured. No answer depends on these numbers.
  static constexpr int gain = 2, at_first = 8, most = 64;

  int credit_ = 0;
};

/// What a best-first traversal carries from one step to the next, except for its cutoff and direction (Pruning). If it
/// is interrupted and goes on with its state, it does the steps that it would have done without the interruption.
struct TraversalState : BucketState {
  std::uint64_t steps = 0;
  std::uint64_t work = 0;  // pairs that kernels have compared; those of a front's records too, which are no steps
  WholeLeaves whole_leaves;
  FlatSeed seed;

  TraversalState() {}  // NOLINT: a defaulted one would let callers clear the queue's memory

  /// Starts a traversal. The queue's memory is not written.
  void clear() {
    queue.clear();
    least_sq = 0, focus_sq = no_limit_sq;
    steps = work = 0;
    is_descending = true, whole_leaves = {}, seed = {};
  }
};

}  // namespace limber::pair

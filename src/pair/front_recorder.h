// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/check.h"
#include "pair/front.h"
#include "pair/node_pair.h"
#include "pair/pruning.h"
#include "pair/squared_limits.h"

namespace limber::pair {

/// The observer of PairWalk that gives a front what the walk adds, prunes and compares. It stops to record where the
/// front is full and it may give up: then the front keeps no records, and the walk goes on as if it had no observer.
class FrontRecorder {
 public:
  FrontRecorder(Front& front, const Pruning& pruning, const SquaredLimits& limits)
      : front_(front), pruning_(pruning), limits_(limits) {}

  bool is_recording() const { return is_recording_; }
  void set_may_give_up() { may_give_up_ = true; }

  /// Queues the records whose children may be nearer than the cutoff. False if that is so much that a new traversal is
  /// cheaper, or if there are no records.
  bool add_records(TraversalState& state) const {
    const std::span<const Front::Record> records = front_.records();
    state.descents.stop();
    std::size_t count = 0;
    state.least_sq = BucketQueue::largest_bound;
    for (std::size_t i = 0; i < records.size(); ++i) {
      const double bound = front_.bound_of(records[i]);
      if (bound >= pruning_.cutoff()) continue;
      ++count;
      const float bound_sq = limits_.bound_of(bound);
      state.least_sq = std::min(state.least_sq, bound_sq);
      state.queue.push(NodePair::of_record(static_cast<std::uint16_t>(i), bound_sq));
    }
    // What the last traversal has left open is new work in any case. Each open pair brings back at most one
    // record, so subtracting all of them can only make the number too small.
    const double compared_again = static_cast<double>(count) - static_cast<double>(front_.open_count());
    return !records.empty() && compared_again < worth_resuming * static_cast<double>(records.size());
  }

  static bool is_record(const NodePair& pair) { return pair.child == NodePair::whole_record; }
  /// Opens a record again: its children are to be compared, unless they are beyond the cutoff by now.
  template <typename Bounds>
  bool reopens(Expansion& e, const Bounds& bounds) {
    const std::uint16_t record = e.pair.record;
    const Front::Record& r = front_.records()[record];
    if (front_.bound_of(r) >= pruning_.cutoff()) return false;
    const Side side = r.expands_a ? Side::a : Side::b;
    e.start(bounds.tree(side), NodePair::of(r.slot[0], r.slot[1], e.pair.bound_sq), side);
    e.record = record;
    e.has_record = true;
    e.children = front_.take(record, pruning_.cutoff());
    return true;
  }

  /// Where the bounds of children are to be written.
  float* bounds_of_children() { return is_recording_ ? bound_sq_ : nullptr; }

  /// A node is opened. Where there is no room for a record, that of its parent stands for all below it.
  void added(Expansion& e) {
    if (!is_recording_) return;
    e.record = front_.add(e.pair.slot, e.side);
    e.has_record = e.record != NodePair::no_record;
    if (!e.has_record) e.record = e.pair.record;
    if (!may_give_up_ || !front_.overflows()) return;
    front_.forget_records();
    is_recording_ = false;
  }
  /// A pair is settled: it is not opened, and what it holds is at least max(distance, cutoff) apart.
  void pruned(const NodePair& pair, double distance) {
    if (is_recording_ && pair.record != NodePair::no_record) put(pair.record, 1U << pair.child, distance);
  }
  void compared(const NodePair& pair, double distance) { pruned(pair, distance); }
  /// Children of a node that is opened were pruned, by the bounds that the kernel has given.
  void pruned_children(const Expansion& e) {
    const unsigned children = e.children & ~e.kept.all;
    if (!is_recording_ || children == 0 || e.record == NodePair::no_record) return;
    float least = BucketQueue::no_limit_sq;
    for (unsigned rest = children; rest != 0; rest &= rest - 1) {
      least = std::min(least, bound_sq_[std::countr_zero(rest)]);
    }
    put(e.record, e.has_record ? children : 1U << e.pair.child, limits_.length_of(e.side, least));
  }

 private:
  // A front is resumed if less than this part of its records has to be compared again, open ones not counted.
  static constexpr double worth_resuming = 0.5;

  void put(std::uint16_t record, unsigned children, double distance) {
    const double at_least = std::max(distance, pruning_.cutoff());
    front_.put(record, children, kind_of(distance), at_least);
  }
  /// The kind of what is settled at that distance.
  Front::Kind kind_of(double distance) const {
    constexpr double near_factor = 1 + 1. / 64;  // (docs/design/real_time.md)
    return distance < near_factor * pruning_.cutoff() ? Front::near : Front::settled;
  }

  Front& front_;
  const Pruning& pruning_;
  const SquaredLimits& limits_;
  bool is_recording_ = true, may_give_up_ = false;
  alignas(32) float bound_sq_[bvh::width];
};

}  // namespace limber::pair

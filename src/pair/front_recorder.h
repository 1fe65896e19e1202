// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>

#include "pair/expansion.h"
#include "pair/front.h"
#include "pair/pruning.h"
#include "pair/squared_limits.h"

namespace limber::pair {

/// Gives a front what a traversal expands, prunes and compares. Without a front it does nothing.
template <bool has_front>
class FrontRecorder {
 public:
  /// `front` is null without one.
  FrontRecorder(Front* front, const Pruning& pruning) : front_(front), pruning_(pruning) {}

  Front& get() const { return *front_; }

  /// Records an expansion. Returns `no_record` where there is no room.
  std::uint16_t add(const NodePair& pair, Side expanded) {
    if constexpr (has_front) {
      return front_->add(pair.slot, expanded);
    } else {
      return NodePair::no_record;
    }
  }
  /// A pair is settled: it is not expanded, and what it holds, pruned or compared, is at least max(distance, cutoff)
  /// apart.
  void settle(const NodePair& pair, double distance) {
    if (!has_front || pair.record == NodePair::no_record) return;
    front_->put(pair.record, 1U << pair.child, kind_of(distance), std::max(distance, pruning_.cutoff()));
  }
  /// Children of an expanded node are pruned, by the bounds that the kernel has given.
  void settle_children(const Expansion& e, unsigned children, const float* bound_sq, const SquaredLimits& limits) {
    if (!has_front || e.record == NodePair::no_record) return;
    float least = BucketQueue::no_limit_sq;
    for (unsigned rest = children; rest != 0; rest &= rest - 1) {
      least = std::min(least, bound_sq[std::countr_zero(rest)]);
    }
    const double distance = std::max(limits.length_of(e.side, least), pruning_.cutoff());
    front_->put(e.record, e.has_record ? children : 1U << e.pair.child, kind_of(distance), distance);
  }

 private:
  /// The kind of what is settled at that distance.
  Front::Kind kind_of(double distance) const {
    constexpr double near_factor = 1 + 1. / 64;  // (docs/design/real_time.md)
    return distance < near_factor * pruning_.cutoff() ? Front::near : Front::settled;
  }

  Front* front_;
  const Pruning& pruning_;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "motion/impacts_of_leaves.h"
#include "motion/moving_bounds.h"
#include "pair/pair_walk.h"
#include "pair/stack_order.h"

namespace limber::motion {

/// The walk that offers a collector the pairs of elements of two moving models, or of one, that may touch: depth first,
/// those that may meet first before the others.
///
/// Needs of a collector:
///          double max_time() const;           // what touches later does not matter
///          bool is_done() const;              // nothing else matters
///          bool wants_contacts_only() const;  // pairs that certainly do not touch may be left out
///          void compare(const ElementPair& pair, const MovingElements& elements);
/// With at_any_pace, it is offered pairs that may be near if each vertex is anywhere on its way, whatever others do;
/// pairs of leaves that both stay are left out.
///          bool stays(Side side, const bvh::Leaf& leaf) const;
template <typename Collector>
class ImpactSearch {
 public:
  ImpactSearch(const MovingPair& models, double separation, Collector& collector, pair::BudgetMeter& meter)
      : collector_(collector),
        bounds_(models, separation, collector, stats_),
        leaves_(models, bounds_, collector, meter, stats_) {}

  /// Searches all, or a part: one pair and all below.
  void run(const SlotPair& part = SlotPair::roots()) {
    first_later_time_ = part.first_later_time;
    order_.push(part);
    walk_.run();
  }
  /// Splits the search into parts, at least `count` where there is so much work, some thousand at most. The parts in
  /// this order, one after the other, with one collector, offer what run() does, in its order.
  std::vector<SlotPair> split(std::size_t count) { return walk_.split({SlotPair::roots()}, count); }

  /// A time before which none of the pairs that are left touches.
  double first_open_time() const {
    double first = std::min({collector_.max_time(), first_later_time_, leaves_.first_left_time()});
    for (const SlotPair& pair : order_.pairs()) first = std::min(first, pair.first_time);
    return first;
  }
  const QueryStats& stats() const { return stats_; }

 private:
  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles): 2 * 11 * 7 = 154. A node with itself adds at most 8 and 28 pairs, on each of 11 levels.
  using Order = pair::StackOrder<SlotPair, 154 + 11 * 36>;

  Collector& collector_;
  QueryStats stats_{};
  double first_later_time_ = std::numeric_limits<double>::infinity();
  Order order_;
  MovingBounds<Collector> bounds_;
  ImpactsOfLeaves<Collector> leaves_;
  pair::NoObserver none_;
  pair::PairWalk<Order, MovingBounds<Collector>, ImpactsOfLeaves<Collector>> walk_{order_, bounds_, leaves_, none_};
};

}  // namespace limber::motion

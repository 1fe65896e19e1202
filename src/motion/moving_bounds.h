// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "bvh/tree.h"
#include "limber/distance.h"
#include "motion/moving_pair.h"
#include "pair/pair_walk.h"
#include "simd/kernels.h"

namespace limber::motion {

/// Slots of two moving trees, or of one.
struct SlotPair {
  bvh::SlotId slot[2];
  double first_time, last_time;  ///< bounds of the times at which the boxes of both meet
  /// Of a part of a walk: no pair that comes after this part touches before this time.
  double first_later_time = std::numeric_limits<double>::infinity();

  static SlotPair of(bvh::SlotId a, bvh::SlotId b) { return {{a, b}, 0, 1}; }
  static SlotPair roots() { return of(bvh::root_slot, bvh::root_slot); }
  static SlotPair itself(bvh::SlotId slot) { return of(slot, slot); }

  /// Those that may meet first are taken before the others.
  bool comes_before(const SlotPair& other) const { return first_time < other.first_time; }
  /// Notes in each of some pairs, the last of which is taken first, when the others may touch: what `from` has become.
  static void note_later(std::span<SlotPair> pairs, const SlotPair& from) {
    double first = from.first_later_time;
    for (SlotPair& pair : pairs) pair.first_later_time = first, first = std::min(first, pair.first_time);
  }
};

/// The children of one node of a pair, compared with the other node.
struct MovingExpansion {
  SlotPair pair;
  Side side;
  std::uint32_t node;
  unsigned children;  ///< to be compared, a bit mask
  struct {
    unsigned all;
  } kept;  ///< those that may meet the other node while the parents do
  simd::MeetingTimes times;

  /// For one model: pairs a slot with each later child slot of the same node, which has `count` children.
  void start_siblings(bvh::SlotId slot, std::uint32_t count) {
    pair = SlotPair::of(slot, bvh::root_slot);
    side = Side::b, node = bvh::node_of(slot);
    children = (1U << count) - (2U << bvh::slot_of(slot));
  }
};

/// The bounds of PairWalk for moving models: boxes at both ends of the motion. A collector of the first impact soon
/// knows a time after which nothing matters. With at_any_pace (ImpactSearch), boxes are those of the whole way.
template <typename Collector>
class MovingBounds {
 public:
  using Pair = SlotPair;
  using Expansion = MovingExpansion;
  static constexpr bool at_any_pace = requires { requires Collector::at_any_pace; };

  MovingBounds(const MovingPair& models, double separation, const Collector& collector, QueryStats& stats)
      : models_(models), collector_(collector), kernels_(simd::kernels()), separation_(separation), stats_(stats) {}

  /// What matters of the time in which the boxes of a pair meet. At any pace each model has a time of its own, so all
  /// of it does.
  simd::MotionLimits limits_of(const SlotPair& pair) const {
    return {pair.first_time, std::min(pair.last_time, collector_.max_time()), separation_, at_any_pace};
  }

  bool prunes(const SlotPair& pair, double&) const { return pair.first_time > collector_.max_time(); }
  bool are_leaves(const SlotPair& pair) const { return is_leaf(Side::a, pair) && is_leaf(Side::b, pair); }
  std::uint32_t child_count(std::uint32_t node) const { return models_.tree(Side::a).nodes[node].child_count; }

  // One model is compared with itself from the root down: a node with itself becomes its children with each other, and
  // then each of them with itself.
  static constexpr bool is_compared_with_itself(bvh::SlotId) { return true; }
  bool opens_itself(const SlotPair& pair) const { return models_.is_self() && pair.slot[0] == pair.slot[1]; }
  std::uint32_t opened_by_itself(const SlotPair& pair) const {
    return bvh::child_of(models_.tree(Side::a), pair.slot[0]);
  }

  /// Opens the node of larger size, if it can be opened.
  template <bool raises>
  pair::Next open(MovingExpansion& e, double&) const {
    const bool is_a_larger = models_.size_of(Side::a, e.pair.slot[0]) >= models_.size_of(Side::b, e.pair.slot[1]);
    e.side = is_leaf(Side::b, e.pair) || (!is_leaf(Side::a, e.pair) && is_a_larger) ? Side::a : Side::b;
    e.node = bvh::child_of(models_.tree(e.side), e.pair.slot[index(e.side)]);
    e.children = (1U << models_.tree(e.side).nodes[e.node].child_count) - 1;
    return pair::Next::opened;
  }
  void bound_children(MovingExpansion& e, float*) {
    const Side other = pair::other(e.side);
    stats_.node_tests += models_.tree(e.side).nodes[e.node].child_count;
    e.kept.all =
        e.children & kernels_.find_meeting_children(models_.node(e.side, e.node), box(other, e.pair.slot[index(other)]),
                                                    limits_of(e.pair), e.times);
  }
  SlotPair child_pair(const MovingExpansion& e, std::uint32_t child) const {
    SlotPair pair = e.pair;
    pair.slot[index(e.side)] = e.node * bvh::width + child;
    if (!at_any_pace) pair.first_time = e.times.first[child], pair.last_time = e.times.last[child];
    return pair;
  }

 private:
  bool is_leaf(Side s, const SlotPair& pair) const { return bvh::has_leaf(models_.tree(s), pair.slot[index(s)]); }

  /// The box of a slot; at any pace the one around those of both ends, at both.
  bvh::MovingBox box(Side s, bvh::SlotId slot) const {
    bvh::MovingBox box = models_.box(s, slot);
    for (std::uint32_t axis = 0; at_any_pace && axis < 3; ++axis) {
      box.low[0][axis] = box.low[1][axis] = std::min(box.low[0][axis], box.low[1][axis]);
      box.high[0][axis] = box.high[1][axis] = std::max(box.high[0][axis], box.high[1][axis]);
    }
    return box;
  }

  const MovingPair& models_;
  const Collector& collector_;
  const simd::Kernels& kernels_;
  double separation_;
  QueryStats& stats_;
};

}  // namespace limber::motion

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <bitset>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "base/check.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "motion/moving_pair.h"
#include "motion/moving_vectors.h"
#include "pair/budget_meter.h"
#include "simd/kernels.h"

namespace limber::motion {

/// Slots of two moving trees, or of one.
struct SlotPair {
  bvh::SlotId slot[2];
  double first_time, last_time;  ///< bounds of the times at which the boxes of both meet
};

/// A part of a search: one pair of slots and all below.
struct ImpactSearchPart {
  SlotPair pair;
  double first_open_time;  ///< a time before which no pair touches that the stack holds while the part is searched
};

/// Offers a collector the pairs of elements of two moving models, or of one, that may touch.
///
/// Depth first over pairs of nodes, those that may meet first before the others. So a collector of the first impact
/// soon knows a time after which nothing matters. A node is compared with another by their boxes at both ends of the
/// motion; one of the two is expanded at a time. One model is compared with itself from the root down: a node with
/// itself becomes its children with each other, and then each of them with itself.
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
  ImpactSearch(const MovingPair& models, double separation, Collector& collector)
      : models_(models), collector_(collector), kernels_(simd::kernels()), separation_(separation) {}

  void run(pair::BudgetMeter& meter) {
    push(roots);
    visit_all(meter);
  }

  /// Offers the collector the pairs of a part.
  void run(const ImpactSearchPart& part, pair::BudgetMeter& meter) {
    LIMBER_ASSERT(size_ == 0);
    first_below_ = part.first_open_time;
    push(part.pair);
    visit_all(meter);
  }

  /// Splits the search into parts, at least `count` where there is so much work, some thousand at most. The parts in
  /// this order, one after the other, with one collector, offer what run() does, in its order.
  std::vector<ImpactSearchPart> split(std::size_t count) {
    LIMBER_ASSERT(size_ == 0 && count > 0);
    std::vector<ImpactSearchPart> parts{{roots, std::numeric_limits<double>::infinity()}}, next;
    for (bool goes_on = true; goes_on && parts.size() < count; parts.swap(next)) {
      goes_on = false, next.clear();
      for (const ImpactSearchPart& part : parts) {
        if (are_leaves(part.pair)) {
          next.push_back(part);
        } else {
          visit(part.pair);
          goes_on = goes_on || size_ > 0;
          move_stack_to(next, part.first_open_time);
        }
      }
    }
    return parts;
  }

  /// A time before which none of the pairs that are left touches. A search that ends early may have left pairs of the
  /// leaves that were compared last.
  double first_open_time() const {
    double first = std::min(collector_.max_time(), first_below_);
    if (has_left_pairs_) first = std::min(first, visited_.first_time);
    for (std::uint32_t i = 0; i < size_; ++i) first = std::min(first, stack_[i].first_time);
    return first;
  }

  QueryStats stats{};

 private:
  static constexpr bool at_any_pace = requires { requires Collector::at_any_pace; };
  static constexpr SlotPair roots{{bvh::root_slot, bvh::root_slot}, 0, 1};
  // As many take longer to compare than to find again.
  static constexpr std::uint32_t many_candidates = 16;

  bool are_leaves(const SlotPair& pair) const {
    return bvh::has_leaf(models_.tree(Side::a), pair.slot[0]) && bvh::has_leaf(models_.tree(Side::b), pair.slot[1]);
  }

  void visit_all(pair::BudgetMeter& meter) {
    meter_ = &meter;
    for (steps_ = 0; size_ > 0 && !collector_.is_done() && !meter.is_spent(steps_); ++steps_) {
      visited_ = stack_[--size_];
      visit(visited_);
    }
  }

  /// Appends the pairs of the stack as parts, in the order in which they would be visited.
  void move_stack_to(std::vector<ImpactSearchPart>& parts, double first_open_time) {
    const std::size_t begin = parts.size();
    for (std::uint32_t i = 0; i < size_; ++i) {
      parts.push_back({stack_[i], first_open_time});
      first_open_time = std::min(first_open_time, stack_[i].first_time);
    }
    std::reverse(parts.begin() + static_cast<std::ptrdiff_t>(begin), parts.end());
    size_ = 0;
  }

  /// The box of a slot; at any pace the one around those of both ends, at both.
  bvh::MovingBox box(Side s, bvh::SlotId slot) const {
    bvh::MovingBox box = models_.box(s, slot);
    for (std::uint32_t axis = 0; at_any_pace && axis < 3; ++axis) {
      box.low[0][axis] = box.low[1][axis] = std::min(box.low[0][axis], box.low[1][axis]);
      box.high[0][axis] = box.high[1][axis] = std::max(box.high[0][axis], box.high[1][axis]);
    }
    return box;
  }

  void push(const SlotPair& pair) {
    LIMBER_ASSERT(size_ < capacity);
    stack_[size_++] = pair;
  }

  void visit(const SlotPair& pair) {
    if (pair.first_time > collector_.max_time()) return;
    const bool is_leaf_a = bvh::has_leaf(models_.tree(Side::a), pair.slot[0]);
    const bool is_leaf_b = bvh::has_leaf(models_.tree(Side::b), pair.slot[1]);
    if (is_leaf_a && is_leaf_b) return compare_leaves(pair);
    if (models_.is_self() && pair.slot[0] == pair.slot[1]) return expand_with_itself(pair.slot[0]);
    const bool is_a_larger = models_.size_of(Side::a, pair.slot[0]) >= models_.size_of(Side::b, pair.slot[1]);
    expand(pair, is_leaf_b || (!is_leaf_a && is_a_larger) ? Side::a : Side::b);
  }

  /// Pushes the children of one node of a pair, compared with the other node.
  void expand(const SlotPair& pair, Side side) {
    const std::size_t own = index(side), other = 1 - own;
    const std::uint32_t node = bvh::child_of(models_.tree(side), pair.slot[own]);
    const std::uint32_t begin = size_;
    push_meeting(side, node, box(pair::other(side), pair.slot[other]), pair, ~0U, [&](bvh::SlotId child) {
      SlotPair of_child = pair;
      of_child.slot[own] = child;
      return of_child;
    });
    earliest_last(begin);
  }

  void expand_with_itself(bvh::SlotId slot) {
    LIMBER_ASSERT(!bvh::has_leaf(models_.tree(Side::a), slot));
    const std::uint32_t node = bvh::child_of(models_.tree(Side::a), slot), first = node * bvh::width;
    const std::uint32_t count = models_.tree(Side::a).nodes[node].child_count;
    for (std::uint32_t k = 0; k < count; ++k) push({{first + k, first + k}, 0, 1});  // below the others, so taken last
    const std::uint32_t begin = size_;
    for (std::uint32_t k = 0; k + 1 < count; ++k) {
      const unsigned after = ~0U << (k + 1);
      push_meeting(Side::a, node, box(Side::a, first + k), roots, after, [&](bvh::SlotId child) {
        return SlotPair{{first + k, child}, 0, 1};
      });
    }
    earliest_last(begin);
  }

  /// What matters of the time in which the boxes of a pair meet. At any pace each model has a time of its own, so all
  /// of it does.
  simd::MotionLimits limits_of(const SlotPair& pair) const {
    return {pair.first_time, std::min(pair.last_time, collector_.max_time()), separation_, at_any_pace};
  }

  /// Pushes pair_of(slot) for the child slots of a node, out of `which`, that may meet a box while the parents do.
  template <typename PairOf>
  void push_meeting(Side side, std::uint32_t node, const bvh::MovingBox& box, const SlotPair& parents, unsigned which,
                    const PairOf& pair_of) {
    simd::MeetingTimes times;
    unsigned found = kernels_.find_meeting_children(models_.node(side, node), box, limits_of(parents), times);
    const std::uint32_t count = models_.tree(side).nodes[node].child_count;
    stats.node_tests += count;
    found &= which & ((1U << count) - 1);
    for (; found != 0; found &= found - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(found));
      SlotPair pair = pair_of(node * bvh::width + k);
      if (!at_any_pace) pair.first_time = times.first[k], pair.last_time = times.last[k];
      push(pair);
    }
  }

  /// Sorts the pairs pushed since `begin`, so that the one that may meet first is taken first.
  void earliest_last(std::uint32_t begin) {
    for (std::uint32_t i = begin + 1; i < size_; ++i) {
      const SlotPair pair = stack_[i];
      std::uint32_t at = i;
      for (; at > begin && stack_[at - 1].first_time < pair.first_time; --at) stack_[at] = stack_[at - 1];
      stack_[at] = pair;
    }
  }

  void compare_leaves(const SlotPair& pair) {
    const MovingLeafOf a = models_.leaf(Side::a, pair.slot[0]), b = models_.leaf(Side::b, pair.slot[1]);
    if constexpr (at_any_pace) {
      if (collector_.stays(Side::a, a.leaf) && collector_.stays(Side::b, b.leaf)) return;
    }
    const simd::SelfPair self{a.leaf, b.leaf};
    has_left_pairs_ = false;
    const simd::MotionLimits limits = limits_of(pair);
    const auto find = [&](const simd::MotionLimits& piece, simd::ElementCandidates& found) {
      kernels_.find_impact_candidates(a.moving, b.moving, piece, a.owned, b.owned, models_.is_self() ? &self : nullptr,
                                      found);
      return found.vertex_face.count + found.face_vertex.count + found.edge_edge.count;
    };
    simd::ElementCandidates found, later;
    later.vertex_face.count = later.face_vertex.count = later.edge_edge.count = 0;
    // Directions that keep elements apart at both ends of the time seldom do so where leaves turn far or pass each
    // other. Those of its middle more often do.
    if (find(limits, found) >= many_candidates && !at_any_pace && turn_or_pass(a.moving, b.moving, limits)) {
      const double middle = 0.5 * (limits.begin + limits.end);
      find({limits.begin, middle, separation_}, found), find({middle, limits.end, separation_}, later);
      keep_new(found.vertex_face, later.vertex_face), keep_new(found.face_vertex, later.face_vertex);
      keep_new(found.edge_edge, later.edge_edge);
    }
    for (const simd::ElementCandidates* some : {&found, &later}) {
      compare(some->vertex_face, pair,
              [&](simd::ElementCandidate c) { return models_.vertex_face(Side::a, a, c.a, b, c.b); });
      compare(some->face_vertex, pair,
              [&](simd::ElementCandidate c) { return models_.vertex_face(Side::b, b, c.b, a, c.a); });
      compare(some->edge_edge, pair, [&](simd::ElementCandidate c) { return models_.edge_edge(a, c.a, b, c.b); });
    }
  }

  /// Whether two leaves turn by more than about a right angle while the limits say, or pass each other by about their
  /// size. A guess; no answer depends on it.
  static bool turn_or_pass(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b, const simd::MotionLimits& limits) {
    const auto at = [](double time, double start, double end) { return (1 - time) * start + time * end; };
    double way_sq = 0, size = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double start = b.center[0][axis] - a.center[0][axis], end = b.center[1][axis] - a.center[1][axis];
      const double way = (limits.end - limits.begin) * (end - start);
      way_sq += way * way;
    }
    for (const bvh::MovingLeaf* leaf : {&a, &b}) {
      double cosine = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto edge = [&](std::size_t end) {
          return leaf->unit[end] * double{leaf->corner[end][3 + axis][0] - leaf->corner[end][axis][0]};
        };
        const double first = edge(0), last = edge(1);
        cosine += at(limits.begin, first, last) * at(limits.end, first, last);
      }
      if (cosine <= 0) return true;
      size += std::max(leaf->unit[0], leaf->unit[1]);
    }
    return way_sq > size * size;
  }

  /// Leaves out of a list what another one has.
  template <typename Candidates>
  static void keep_new(const Candidates& known, Candidates& list) {
    std::bitset<(3 * bvh::width) * (3 * bvh::width)> is_known;
    const auto place = [](simd::ElementCandidate c) { return c.a * 3 * bvh::width + c.b; };
    for (std::uint32_t i = 0; i < known.count; ++i) is_known.set(place(known.pairs[i]));
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < list.count; ++i) {
      if (!is_known[place(list.pairs[i])]) list.pairs[count++] = list.pairs[i];
    }
    list.count = count;
  }

  /// Offers candidates of one kind to the collector, without those that certainly do not touch if it asks for that.
  template <typename Candidates, typename ElementsOf>
  void compare(const Candidates& candidates, const SlotPair& leaves, const ElementsOf& elements_of) {
    constexpr std::uint32_t room = simd::MovingPairs::room;
    const bool excludes = collector_.wants_contacts_only();
    for (std::uint32_t i = 0; i < candidates.count && leaves.first_time <= collector_.max_time(); i += room) {
      const std::span<const simd::ElementCandidate> some(candidates.pairs + i, std::min(candidates.count - i, room));
      stats.primitive_tests += some.size();  // pairs of elements count as pairs of triangles
      unsigned left = (1U << some.size()) - 1;
      if (excludes) left &= ~excluded(some, limits_of(leaves), elements_of);
      for (; left != 0; left &= left - 1) {
        // Some pairs take milliseconds.
        has_left_pairs_ = collector_.is_done() || meter_->cuts_short(steps_ + 1);
        if (has_left_pairs_) return;
        const IdentifiedElements found = elements_of(some[std::countr_zero(left)]);
        collector_.compare(found.pair, found.elements);
      }
    }
  }

  /// A bit mask of candidates of one kind that certainly do not touch in time.
  template <typename ElementsOf>
  unsigned excluded(std::span<const simd::ElementCandidate> candidates, const simd::MotionLimits& limits,
                    const ElementsOf& elements_of) const {
    LIMBER_ASSERT(!candidates.empty() && candidates.size() <= simd::MovingPairs::room);
    simd::MovingPairs pairs;
    MovingElements::Kind kind{};
    for (std::size_t k = 0; k < candidates.size(); ++k) {
      const MovingElements elements = elements_of(candidates[k]).elements;
      kind = elements.kind;
      for (std::size_t end = 0; end < bvh::motion_ends; ++end) {
        const Vectors x = vectors_of(kind, elements.corners[end]);
        pairs.u[end][k] = x.u, pairs.v[end][k] = x.v, pairs.w[end][k] = x.w;
      }
    }
    return kernels_.exclude_impacts(pairs, kind == MovingElements::Kind::vertex_face, limits);
  }

  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles): 2 * 11 * 7 = 154. A node with itself adds at most 8 and 28 pairs, on each of 11 levels.
  static constexpr std::uint32_t capacity = 154 + 11 * 36;

  const MovingPair& models_;
  Collector& collector_;
  const simd::Kernels& kernels_;
  double separation_;
  double first_below_ = std::numeric_limits<double>::infinity();  // of pairs that come after the part that is searched
  SlotPair visited_{};                                            // last
  bool has_left_pairs_ = false;  // whether pairs of elements of the leaves visited last have not been compared
  pair::BudgetMeter* meter_ = nullptr;
  std::uint64_t steps_ = 0;
  SlotPair stack_[capacity];
  std::uint32_t size_ = 0;
};

}  // namespace limber::motion

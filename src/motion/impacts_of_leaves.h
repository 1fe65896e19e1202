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

#include "base/check.h"
#include "limber/distance.h"
#include "motion/moving_bounds.h"
#include "motion/moving_elements.h"
#include "motion/moving_pair.h"
#include "pair/budget_meter.h"
#include "simd/kernels.h"

namespace limber::motion {

/// The visitor of PairWalk that offers a collector of ImpactSearch the pairs of elements of two leaves that may touch.
template <typename Collector>
class ImpactsOfLeaves {
 public:
  ImpactsOfLeaves(const MovingPair& models, const MovingBounds<Collector>& bounds, Collector& collector,
                  pair::BudgetMeter& meter, QueryStats& stats)
      : models_(models),
        bounds_(bounds),
        collector_(collector),
        kernels_(simd::kernels()),
        meter_(meter),
        stats_(stats) {}

  /// To be asked before every pair: each is a step, also one that is pruned.
  bool has_to_end() {
    if (collector_.is_done() || meter_.is_spent(steps_)) return true;
    ++steps_;
    return false;
  }
  static constexpr void count_step() {}
  static constexpr bool lowers_cutoff(const SlotPair&, bool) { return false; }

  /// Where a search has ended early: a time before which none of the pairs touches that are left of the leaves that
  /// were compared last.
  double first_left_time() const { return first_left_time_; }

  bool compare(const SlotPair& pair, bool, double&) {
    const MovingLeafOf a = models_.leaf(Side::a, pair.slot[0]), b = models_.leaf(Side::b, pair.slot[1]);
    if constexpr (at_any_pace) {
      if (collector_.stays(Side::a, a.leaf) && collector_.stays(Side::b, b.leaf)) return true;
    }
    const simd::SelfPair self{a.leaf, b.leaf};
    const simd::MotionLimits limits = bounds_.limits_of(pair);
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
      find({limits.begin, middle, limits.separation}, found), find({middle, limits.end, limits.separation}, later);
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
    return true;
  }

 private:
  static constexpr bool at_any_pace = MovingBounds<Collector>::at_any_pace;
  // As many take longer to compare than to find again.
  static constexpr std::uint32_t many_candidates = 16;

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
      stats_.primitive_tests += some.size();  // pairs of elements count as pairs of triangles
      unsigned left = (1U << some.size()) - 1;
      if (excludes) left &= ~excluded(some, bounds_.limits_of(leaves), elements_of);
      for (; left != 0; left &= left - 1) {
        // Some pairs take milliseconds.
        if (collector_.is_done() || meter_.cuts_short(steps_)) {
          first_left_time_ = leaves.first_time;
          return;
        }
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

  const MovingPair& models_;
  const MovingBounds<Collector>& bounds_;
  Collector& collector_;
  const simd::Kernels& kernels_;
  pair::BudgetMeter& meter_;
  QueryStats& stats_;
  double first_left_time_ = std::numeric_limits<double>::infinity();
  std::uint64_t steps_ = 0;
};

}  // namespace limber::motion

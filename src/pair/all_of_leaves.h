// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "pair/collectors/collector.h"
#include "pair/node_bounds.h"
#include "pair/placed_leaf.h"
#include "pair/search_context.h"
#include "pair/squared_limits.h"

namespace limber::pair {

/// The visitor of PairWalk that offers a collector every pair of triangles within the cutoff, or every pair of leaves.
/// The cutoff stays what it is, and there is no search direction.
template <typename Collector>
class AllOfLeaves {
 public:
  AllOfLeaves(const Search& search, const NodeBounds<Collector>& bounds, Collector& collector)
      : search_(search),
        bounds_(bounds),
        collector_(collector),
        kernels_(simd::kernels()),
        a_(search.placed, Side::a),
        b_(search.placed, Side::b) {}

  bool has_to_end() { return collector_.is_done() || search_.meter.is_spent(steps_); }
  void count_step() { ++steps_; }
  static constexpr bool lowers_cutoff(const NodePair&, bool) { return false; }

  [[gnu::always_inline]] bool compare(const NodePair& pair, bool, double&) {
    if constexpr (ComparesLeaves<Collector>) {
      const LeafPair leaves{bounds_.as_leaf(Side::a, pair), bounds_.as_leaf(Side::b, pair),
                            bounds_.leaf(Side::a, pair),    bounds_.leaf(Side::b, pair),
                            search_.frames.of(Side::a),     search_.pruning.of(Side::a)};
      collector_.compare_leaves(leaves, search_.stats);
    } else {
      compare_triangles(pair);
    }
    return true;
  }

 private:
  // From that many candidates on, better bounds take less time than the comparisons that they save.
  static constexpr std::uint32_t worth_refining = 2;

  [[gnu::always_inline]] void compare_triangles(const NodePair& pair) {
    const simd::SelfPair self{bounds_.leaf(Side::a, pair), bounds_.leaf(Side::b, pair)};
    simd::Candidates found;
    kernels_.find_candidates(bounds_.as_leaf(Side::a, pair), bounds_.as_leaf(Side::b, pair), search_.frames.of(Side::a),
                             search_.pruning.of(Side::a), Collector::is_self ? &self : nullptr, false, found);
    if (found.count == 0) return;
    if (found.count >= worth_refining) kernels_.refine_candidates(found);
    const double limit_sq = limit_sq_of(found, search_.pruning.distance());
    a_.take(self.a), b_.take(self.b);
    for (std::uint32_t i = 0; i < found.count && !collector_.is_done() && !search_.meter.cuts_short(steps_); ++i) {
      const std::uint32_t slot_a = found.pairs[i].slot_a, slot_b = found.pairs[i].slot_b;
      if (static_cast<double>(found.pairs[i].bound_sq) >= limit_sq) continue;
      ++search_.stats.primitive_tests;
      collector_.compare(a_.at(slot_a), b_.at(slot_b));
    }
  }

  Search search_;
  const NodeBounds<Collector>& bounds_;
  Collector& collector_;
  const simd::Kernels& kernels_;
  PlacedLeaf a_, b_;  // of the leaves that were compared last
  std::uint64_t steps_ = 0;
};

}  // namespace limber::pair

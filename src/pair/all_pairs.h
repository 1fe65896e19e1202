// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "base/check.h"
#include "pair/collectors/collector.h"
#include "pair/node_bounds.h"
#include "pair/pair_walk.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"

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
  static constexpr bool prepare_visit(const NodePair&) { return false; }

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

/// A part of a search for all pairs: one pair of nodes and all below; or, for one model, the children of each of some
/// nodes with each other.
using SearchPart = std::variant<NodePair, NodeRange>;

/// The walk of queries that need every pair of triangles within a cutoff: depth first.
template <typename Collector>
class AllPairs {
 public:
  AllPairs(const Search& search, Collector& collector)
      : collector_(collector), bounds_(search, work_), leaves_(search, bounds_, collector) {
    static_assert(Collector::hits == Hits::all);
    node_count_ = static_cast<std::uint32_t>(search.placed.tree(Side::a).nodes.size());
    bounds_.limits().update(search.pruning.distance());
  }

  /// Offers the collector all pairs, until it is done or the budget is spent. The models are at least `root_bound`
  /// apart.
  void run(double root_bound) {
    if constexpr (Collector::is_self) {
      run(NodeRange{0, node_count_});
    } else {
      run(roots(root_bound));
    }
  }
  /// Offers the collector the pairs of a part.
  void run(const SearchPart& part) {
    LIMBER_ASSERT(order_.empty());
    if (const NodeRange* const nodes = std::get_if<NodeRange>(&part)) {
      NodeRange left = *nodes;
      walk_.run_siblings(left);
    } else {
      order_.push(std::get<NodePair>(part));
      walk_.run();
    }
    if constexpr (requires { collector_.finish(); }) collector_.finish();
  }

  /// Splits the search into parts, at least `count` where there is so much work, some thousand at most. The parts in
  /// this order, one after the other, offer what run() does, in its order.
  std::vector<SearchPart> split(double root_bound, std::size_t count) {
    LIMBER_ASSERT(order_.empty() && count > 0);
    std::vector<SearchPart> parts;
    std::vector<NodePair> pairs;
    if constexpr (Collector::is_self) {
      // Most of the work is far down, but what is near the root is not little.
      const std::uint32_t top = std::min(node_count_, top_nodes);
      const auto size = static_cast<std::uint32_t>((node_count_ - top) / count + 1);
      for (std::uint32_t end = node_count_; end > top; end -= std::min(size, end - top)) {
        parts.emplace_back(NodeRange{end - std::min(size, end - top), end});
      }
      for (std::uint32_t n = top; n > 0; --n) {
        walk_.add_siblings(n - 1);
        order_.move_to(pairs, {});
      }
    } else {
      pairs.push_back(roots(root_bound));
    }
    for (const NodePair& pair : walk_.split(std::move(pairs), count)) parts.emplace_back(pair);
    return parts;
  }

 private:
  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles). For one model, a node begins with at most 28 pairs of children and 8 leaves. In all at most
  // 2 * 11 * 7 + 28 + 8 = 190.
  static constexpr std::uint32_t capacity = 256;
  // Nodes of the two levels below the root: their pairs of children are split further.
  static constexpr std::uint32_t top_nodes = 64;

  NodePair roots(double root_bound) const { return bounds_.roots(bounds_.limits().bound_of(root_bound)); }

  Collector& collector_;
  std::uint32_t node_count_;
  std::uint64_t work_ = 0;
  StackOrder<NodePair, capacity> order_;
  NodeBounds<Collector> bounds_;
  AllOfLeaves<Collector> leaves_;
  NoObserver none_;
  PairWalk<StackOrder<NodePair, capacity>, NodeBounds<Collector>, AllOfLeaves<Collector>> walk_{order_, bounds_,
                                                                                                leaves_, none_};
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <variant>
#include <vector>

#include "base/check.h"
#include "pair/all_of_leaves.h"
#include "pair/node_bounds.h"
#include "pair/pair_walk.h"
#include "pair/stack_order.h"

namespace limber::pair {

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
        parts.push_back(NodeRange{end - std::min(size, end - top), end});
      }
      for (std::uint32_t n = top; n > 0; --n) {
        walk_.add_siblings(n - 1);
        order_.move_to(pairs, {});
      }
    } else {
      pairs.push_back(roots(root_bound));
    }
    for (const NodePair& pair : walk_.split(std::move(pairs), count)) parts.push_back(pair);
    return parts;
  }

 private:
  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles). For one model, a node begins with at most 28 pairs of children and 8 leaves. In all at most
  // 2 * 11 * 7 + 28 + 8 = 190.
  static constexpr std::uint32_t capacity = 256;
  // Nodes of the two levels below the root: their pairs of children are split further.
  static constexpr std::uint32_t top_nodes = 64;

  NodePair roots(double root_bound) const { return NodePair::roots(bounds_.limits().bound_of(root_bound)); }

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/check.h"
#include "pair/collectors/collector.h"
#include "pair/expansion.h"
#include "pair/placed_leaf.h"
#include "pair/search_context.h"
#include "pair/squared_limits.h"
#include "pair/tree_pair.h"

namespace limber::pair {

/// A part of a search for all pairs: one pair of nodes and all below, or, for one model, the children of each of some
/// nodes with each other.
struct SearchPart {
  NodePair pair;
  std::uint32_t first_node = 0, end_node = 0;  ///< without `pair`, if there are any; the last one comes first
};

/// The loop of queries that need every pair of triangles within a cutoff: depth first, with a stack. The cutoff stays
/// what it is, and there is no search direction.
///
/// Based on  [Larsen1999]: pairs of nodes of two trees.
/// Differs   One node of a pair is expanded at a time, the one of higher split priority (the
///           thicker slab). Its eight children are
///           compared with the other node at once. A model is compared with itself node by node: the child slots of
///           each with each other.
template <typename Collector>
class AllPairs {
 public:
  AllPairs(const Search& search, Collector& collector)
      : search_(search),
        collector_(collector),
        kernels_(simd::kernels()),
        trees_(search.placed),
        limits_(search.placed),
        a_(search.placed, Side::a),
        b_(search.placed, Side::b) {
    static_assert(Collector::hits == Hits::all);
    limits_.update(search.pruning.distance());
  }

  /// Offers the collector all pairs, until it is done or the budget is spent. The models are at least `root_bound`
  /// apart.
  void run(double root_bound) {
    if constexpr (Collector::is_self) {
      compare_siblings_of(0, node_count());
    } else {
      push_roots(root_bound);
      visit_all();
    }
    finish();
  }

  /// Offers the collector the pairs of a part.
  void run(const SearchPart& part) {
    LIMBER_ASSERT(size_ == 0);
    if (part.first_node < part.end_node) {
      compare_siblings_of(part.first_node, part.end_node);
    } else {
      push(part.pair);
      visit_all();
    }
    finish();
  }

  /// Splits the search into parts, at least `count` where there is so much work, some thousand at most. The parts in
  /// this order, one after the other, offer what run() does, in its order.
  std::vector<SearchPart> split(double root_bound, std::size_t count) {
    LIMBER_ASSERT(size_ == 0 && count > 0);
    std::vector<SearchPart> parts;
    std::vector<NodePair> pairs, next;
    if constexpr (Collector::is_self) {
      // Most of the work is far down, but what is near the root is not little.
      const std::uint32_t top = std::min(node_count(), top_nodes);
      const auto size = static_cast<std::uint32_t>((node_count() - top) / count + 1);
      for (std::uint32_t end = node_count(); end > top; end -= std::min(size, end - top)) {
        parts.push_back({{}, end - std::min(size, end - top), end});
      }
      for (std::uint32_t n = top; n > 0; --n) {
        push_siblings(n - 1);
        move_stack_to(pairs);
      }
    } else {
      push_roots(root_bound);
      move_stack_to(pairs);
    }
    for (bool goes_on = true; goes_on && pairs.size() < count; pairs.swap(next)) {
      goes_on = false, next.clear();
      for (const NodePair& pair : pairs) {
        if (trees_.are_leaves(pair)) {
          next.push_back(pair);
        } else {
          visit(pair);
          goes_on = goes_on || size_ > 0;
          move_stack_to(next);
        }
      }
    }
    parts.reserve(parts.size() + pairs.size());
    for (const NodePair& pair : pairs) parts.push_back({pair});
    return parts;
  }

 private:
  std::uint32_t node_count() const { return static_cast<std::uint32_t>(trees_.tree(Side::a).nodes.size()); }

  void push_roots(double root_bound) {
    push({limits_.bound_of(root_bound), {bvh::root_slot, bvh::root_slot}, NodePair::no_record, 0, false});
  }

  /// Appends the pairs of the stack in the order in which they would be visited.
  void move_stack_to(std::vector<NodePair>& pairs) {
    while (size_ > 0) pairs.push_back(stack_[--size_]);
  }

  void push(const NodePair& pair) {
    LIMBER_ASSERT(size_ < capacity);
    stack_[size_++] = pair;
  }

  void finish() {
    if constexpr (requires { collector_.finish(); }) collector_.finish();
  }

  bool has_to_end() { return collector_.is_done() || search_.meter.is_spent(steps_); }

  void visit_all() {
    while (size_ > 0 && !has_to_end()) visit(stack_[--size_]);
  }

  /// Prunes a pair, compares two leaves, or expands one of two nodes.
  void visit(const NodePair& pair) {
    if (pair.bound_sq >= limits_.of(Side::a)) return;
    if constexpr (Collector::is_self) {
      const Apart what = ComparesLeaves<Collector> ? Apart::elements : Apart::triangles;
      if (trees_.share_and_are_apart(pair, what, search_.pruning.distance())) return;
    }
    ++steps_;
    if (trees_.are_leaves(pair)) return compare_leaves(pair);
    const auto [side, triangles_first] = trees_.choose(pair);
    if (triangles_first) {
      const Side of_leaf = other(side);
      ++search_.stats.node_tests;
      const float bound_sq =
          kernels_.bound_leaf(trees_.as_leaf(of_leaf, pair), trees_.as_node(side, pair), search_.frames.of(of_leaf));
      if (bound_sq >= limits_.of(of_leaf)) return;
    }
    Expansion e;
    e.start(trees_.tree(side), pair, side);
    expand(e);
  }

  /// Compares, for one model, the children of each node with each other, those of the last node first.
  void compare_siblings_of(std::uint32_t first_node, std::uint32_t end_node) {
    for (std::uint32_t n = end_node; n > first_node && !has_to_end(); --n) {
      push_siblings(n - 1);
      visit_all();
    }
  }

  /// Pairs the child slots of a node of one model with each other, and its leaves with themselves. Larger subtrees are
  /// compared with themselves when their own nodes are visited.
  void push_siblings(std::uint32_t n) {
    const bvh::Tree& tree = trees_.tree(Side::a);
    const std::uint32_t count = tree.nodes[n].child_count;
    ++steps_;
    for (std::uint32_t k = 0; k < count; ++k) {
      const bvh::SlotId slot = n * bvh::width + k;
      if (bvh::has_leaf(tree, slot)) push({0, {slot, slot}, NodePair::no_record, 0, false});
      if (k + 1 == count) break;
      Expansion e;
      e.start_siblings(slot, count);
      expand(e);
    }
  }

  /// Puts the children of a node that are not pruned on the stack.
  void expand(Expansion& e) {
    LIMBER_ASSERT(e.children != 0);
    const bvh::Node& node = trees_.tree(e.side).nodes[e.node];
    search_.stats.node_tests += node.child_count;
    const simd::KeptSlots kept =
        kernels_.bound_children(node, trees_.as_other(other(e.side), e.pair), search_.frames.of(e.side),
                                search_.pruning.of(e.side), limits_.of(e.side), e.order, nullptr);
    for (unsigned rest = kept.all & e.children; rest != 0; rest &= rest - 1) {
      const auto child = static_cast<std::uint32_t>(std::countr_zero(rest));
      push(e.child_pair(child, limits_.bound_of_child(e.side, e.order[child], e.pair.bound_sq)));
    }
  }

  void compare_leaves(const NodePair& pair) requires ComparesLeaves<Collector> {
    const LeafPair leaves{trees_.as_leaf(Side::a, pair), trees_.as_leaf(Side::b, pair), trees_.leaf(Side::a, pair),
                          trees_.leaf(Side::b, pair),    search_.frames.of(Side::a),    search_.pruning.of(Side::a)};
    collector_.compare_leaves(leaves, search_.stats);
  }

  void compare_leaves(const NodePair& pair) requires(!ComparesLeaves<Collector>) {
    const simd::SelfPair self{trees_.leaf(Side::a, pair), trees_.leaf(Side::b, pair)};
    simd::Candidates found;
    kernels_.find_candidates(trees_.as_leaf(Side::a, pair), trees_.as_leaf(Side::b, pair), search_.frames.of(Side::a),
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

  // Every pair visited adds less than `width` more and goes one level down one of two trees, each of at most 11 levels
  // (2^32 triangles). For one model, a node begins with at most 28 pairs of children and 8 leaves. In all at most
  // 2 * 11 * 7 + 28 + 8 = 190.
  static constexpr std::uint32_t capacity = 256;
  // From that many candidates on, better bounds take less time than the comparisons that they save.
  static constexpr std::uint32_t worth_refining = 2;
  // Nodes of the two levels below the root: their pairs of children are split further.
  static constexpr std::uint32_t top_nodes = 64;

  Search search_;
  Collector& collector_;
  const simd::Kernels& kernels_;
  TreePair<true> trees_;
  SquaredLimits limits_;
  PlacedLeaf a_, b_;  // of the leaves that were compared last
  NodePair stack_[capacity];
  std::uint32_t size_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace limber::pair

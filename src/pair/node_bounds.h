// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "limber/distance.h"
#include "pair/budget_meter.h"
#include "pair/collectors/collector.h"
#include "pair/node_pair.h"
#include "pair/pair_walk.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "simd/kernels.h"

namespace limber::pair {

/// What all parts of one search work on, whatever is looked for.
struct Search {
  const PlacedPair& placed;
  Frames& frames;
  Pruning& pruning;
  BudgetMeter& meter;
  QueryStats& stats;
};

/// The bounds of PairWalk for models that stand still: boxes, slabs and spheres of nodes, and the search direction. All
/// rules by which pairs of nodes are pruned, and by which one of two nodes is opened, are in this file. The limits are
/// those of Pruning, which float32 can resolve.
template <typename Collector>
class NodeBounds {
 public:
  using Pair = NodePair;
  using Expansion = pair::Expansion;

  /// `work` counts the pairs of nodes that kernels compare.
  NodeBounds(const Search& search, std::uint64_t& work)
      : search_(search), kernels_(simd::kernels()), limits_(search.placed), work_(work) {}

  const bvh::Tree& tree(Side s) const { return search_.placed.tree(s); }

  /// Whether a slot is not expanded: it has a leaf, or triangles below it coincide, so that no bound tells them apart.
  [[gnu::always_inline]] bool is_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    const bvh::Tree& tree = search_.placed.tree(s);
    if constexpr (tells_coincident_apart) {
      return bvh::has_leaf(tree, slot);
    } else {
      return bvh::has_leaf(tree, slot) || (bvh::is_coincident(tree, slot) && tree.slack == 0);
    }
  }
  bool are_leaves(const NodePair& pair) const { return is_leaf(Side::a, pair) && is_leaf(Side::b, pair); }

  /// The slot of the leaf that such a slot has or stands for. Pre: is_leaf().
  [[gnu::always_inline]] bvh::SlotId leaf_slot(Side s, const NodePair& pair) const {
    LIMBER_ASSERT(is_leaf(s, pair));
    return bvh::first_leaf_slot(search_.placed.tree(s), pair.slot[index(s)]);
  }
  [[gnu::always_inline]] const bvh::Leaf& leaf(Side s, const NodePair& pair) const {
    return bvh::leaf_of(search_.placed.tree(s), leaf_slot(s, pair));
  }

  /// A slot as the kernels take it, without triangles and with those of its leaf.
  simd::SlotRef as_node(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    return {&search_.placed.tree(s).nodes[bvh::node_of(slot)], bvh::slot_of(slot), nullptr};
  }
  [[gnu::always_inline]] simd::SlotRef as_leaf(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = search_.placed.tree(s);
    const bvh::Leaf& leaf = bvh::leaf_of(tree, slot);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &leaf.corners, triangle_count(s, leaf)};
  }
  /// With the triangles of its leaf if the slot is not expanded; then their number does not matter.
  simd::SlotRef as_other(Side s, const NodePair& pair) const {
    if (!is_leaf(s, pair)) return as_node(s, pair);
    const bvh::SlotId slot = leaf_slot(s, pair);
    const bvh::Tree& tree = search_.placed.tree(s);
    return {&tree.nodes[bvh::node_of(slot)], bvh::slot_of(slot), &bvh::leaf_of(tree, slot).corners};
  }

  SquaredLimits& limits() { return limits_; }
  const SquaredLimits& limits() const { return limits_; }

  std::uint32_t child_count(std::uint32_t node) const { return tree(Side::a).nodes[node].child_count; }
  /// For one model: leaves are. Larger subtrees are compared with themselves when their own nodes are visited.
  bool is_compared_with_itself(bvh::SlotId slot) const { return bvh::has_leaf(tree(Side::a), slot); }

  /// Whether nothing below a pair matters: it is at least `apart` from each other, or shares vertices and nothing else.
  bool prunes(const NodePair& pair, double& apart) const {
    if (pair.bound_sq >= limits_.of_pairs()) {
      apart = limits_.length_of_pair(pair.bound_sq);
      return true;
    }
    if constexpr (Collector::is_self) {
      return share_and_are_apart(pair);
    } else {
      return false;
    }
  }

  /// The pair of roots, which knows the thicker one.
  NodePair roots(float bound_sq) const {
    NodePair pair = NodePair::of(bvh::root_slot, bvh::root_slot, bound_sq);
    pair.is_a_larger = is_a_thicker(pair);
    return pair;
  }

  /// Opens the node of higher split priority. Of a leaf and a node it opens the node. If then the leaf is the thicker
  /// one, and the bound of the pair is small next to its priority, its triangles, one by one, tell more than the
  /// children of the node do, so they are looked at first. If they prune the pair, `apart` is what they tell.
  /// Pre: are_leaves() is false.
  ///
  /// With `raises`, a better bound by those triangles becomes that of the pair.
  template <bool raises>
  [[gnu::always_inline]] Next open(Expansion& e, double& apart) {
    const NodePair& pair = e.pair;
    // Bitwise: branches here would be mispredicted.
    const bool is_leaf_a = is_leaf(Side::a, pair), is_leaf_b = is_leaf(Side::b, pair);
    bool is_a_first = pair.is_a_larger;
    if (!knows_larger() || is_leaf_a || is_leaf_b) is_a_first = is_a_thicker(pair);
    const bool is_a = (static_cast<int>(is_a_first) | static_cast<int>(is_leaf_b)) > static_cast<int>(is_leaf_a);
    const Side side = is_a ? Side::a : Side::b;
    Next next = Next::opened;
    if (is_a != is_a_first && !pair.is_bounded && is_loose(pair, other(side))) {
      next = bound_by_leaf<raises>(e.pair, other(side), apart);
    }
    if (next != Next::pruned) e.start(tree(side), pair, side);
    return next;
  }

  /// Compares the children of the node that is opened with the other node. Their squared bounds are written where
  /// `bound_sq` points to, if it does.
  [[gnu::always_inline]] void bound_children(Expansion& e, float* bound_sq) {
    LIMBER_ASSERT(e.children != 0);
    ++work_;
    const bvh::Node& node = tree(e.side).nodes[e.node];
    search_.stats.node_tests += node.child_count;
    const simd::KeptSlots kept =
        kernels_.bound_children(node, as_other(other(e.side), e.pair), search_.frames.of(e.side),
                                search_.pruning.of(e.side), limits_.of(e.side), e.order, bound_sq);
    // Local variables, because GCC would combine the masks in memory.
    const unsigned all = kept.all & e.children, overlapping = kept.overlapping & e.children;
    e.kept.all = all, e.kept.overlapping = overlapping;
    if constexpr (finds_closest) e.kept.larger = kept.larger ^ (e.side == Side::a ? 0U : ~0U);
  }

  /// A child that was kept, with the other node.
  NodePair child_pair(const Expansion& e, std::uint32_t child) const {
    NodePair pair = e.child_pair(child, limits_.bound_of_child(e.side, e.order[child], e.pair.bound_sq));
    if constexpr (finds_closest) pair.is_a_larger = (e.kept.larger >> child & 1) != 0;
    return pair;
  }

 private:
  // Where every pair is needed, triangles that coincide are pairs of their own.
  static constexpr bool tells_coincident_apart = Collector::hits == Hits::all || Collector::hits == Hits::k_closest;
  static constexpr bool finds_closest = Collector::hits == Hits::closest || Collector::hits == Hits::k_closest;
  // A bound below that many times the priority of a leaf is loose. With 1, distances in a room and a maze take twice as
  // long; without a limit, those of a ball far over a square take 1.17 times as long.
  static constexpr double loose_priorities = 2;

  /// Whether pairs know which of their nodes has the higher split priority. Only collectors of closest pairs have a
  /// search direction, on which it depends; and kernels do not compute it where only contacts matter.
  [[gnu::always_inline]] bool knows_larger() const {
    return finds_closest && search_.pruning.distance() > simd::smallest_prune_distance;
  }
  /// The split priority of a slot without a search direction: half the thickness of its slab, and a little of its
  /// radius.
  double split_priority(Side s, const NodePair& pair) const {
    const bvh::SlotId slot = pair.slot[index(s)];
    const bvh::Tree& tree = this->tree(s);
    const bvh::ChildBounds& n = tree.nodes[bvh::node_of(slot)].bounds;
    const std::uint32_t k = bvh::slot_of(slot);
    return tree.unit * static_cast<double>((n.high[k] - n.low[k]) * 0.5F + simd::share_of_radius * n.radius[k]);
  }
  /// Whether split_priority() of a is at least that of b.
  [[gnu::always_inline]] bool is_a_thicker(const NodePair& pair) const {
    return split_priority(Side::a, pair) >= split_priority(Side::b, pair);
  }
  /// Whether the bound of a pair is small next to the priority of a leaf.
  [[gnu::always_inline]] bool is_loose(const NodePair& pair, Side of_leaf) const {
    const double loose = loose_priorities * split_priority(of_leaf, pair) / tree(Side::a).unit;
    return static_cast<double>(pair.bound_sq) < loose * loose;
  }

  /// Compares the triangles of a leaf one by one with the other volume.
  template <bool raises>
  Next bound_by_leaf(NodePair& pair, Side of_leaf, double& apart) {
    ++work_;
    ++search_.stats.node_tests;
    const float bound_sq =
        kernels_.bound_leaf(as_leaf(of_leaf, pair), as_node(other(of_leaf), pair), search_.frames.of(of_leaf));
    if (bound_sq >= limits_.of(of_leaf)) {
      apart = limits_.length_of(of_leaf, bound_sq);
      return Next::pruned;
    }
    if constexpr (raises) {
      const float raised_sq = limits_.bound_of_child(of_leaf, bound_sq, pair.bound_sq);
      if (raised_sq == pair.bound_sq) return Next::opened;
      pair.bound_sq = raised_sq;
      pair.is_bounded = true;
      return Next::raised;
    }
    return Next::opened;
  }

  /// For one model: whether all triangles below two slots share a vertex or an edge, as those of a fan or a book do,
  /// and have nothing else in common, so that they need not be compared. Leaves are too small for this test to pay.
  /// Under a pose nothing is said: the test does not know by how much placing rounds.
  bool share_and_are_apart(const NodePair& pair) const {
    if (!search_.placed.is_placed_exactly()) return false;
    const bvh::Tree& tree = this->tree(Side::a);
    if (bvh::has_leaf(tree, pair.slot[0]) || bvh::has_leaf(tree, pair.slot[1])) return false;
    const Apart what = ComparesLeaves<Collector> ? Apart::elements : Apart::triangles;
    return pair::share_and_are_apart(search_.placed, pair.slot[0], pair.slot[1], what, search_.pruning.distance());
  }

  /// All leaves but the last are full (I2).
  std::uint32_t triangle_count(Side s, const bvh::Leaf& leaf) const {
    const auto& leaves = search_.placed.tree(s).leaves;
    if (&leaf != &leaves.back()) return bvh::width;
    const std::size_t count = search_.placed.mesh(s).triangles.size() - bvh::width * (leaves.size() - 1);
    LIMBER_ASSERT(count > 0 && count <= bvh::width && leaf.triangle[count - 1] == leaf.triangle[bvh::width - 1]);
    return static_cast<std::uint32_t>(count);
  }

  Search search_;  // a bundle of references
  const simd::Kernels& kernels_;
  SquaredLimits limits_;
  std::uint64_t& work_;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/tree_cost.h"

#include <algorithm>

#include "core/check.h"

namespace limber::bvh {
namespace {

// Levels below the root at which a degraded subtree is looked for, each compared with what it cost itself.
constexpr int levels_searched = 2;

// A subtree is narrowed down to a child that has this part of its excess cost.
constexpr double nearly_all = 0.9;

/// The squared radii of the children of a node, in squared units.
double sum_of_squared_radii(const WideNode& node) {
  double sum = 0;
  for (std::uint32_t k = 0; k < node.child_count; ++k) {
    const auto radius = static_cast<double>(node.bounds.radius[k]);
    sum += radius * radius;
  }
  return sum;
}

double squared_radius_of_root(const Tree& tree) { return std::max(sum_of_squared_radii(tree.nodes[0]), 0x1p-100); }

/// The node of the lowest level that has a leaf, counted from the first of them.
std::uint32_t lowest_node_of(const Tree& tree, std::uint32_t leaf) {
  const auto begin = tree.nodes.begin() + tree.first_lowest_node();
  const auto after = std::upper_bound(begin, tree.nodes.end(), leaf,
                                      [](std::uint32_t l, const WideNode& node) { return l < node.first_child; });
  return static_cast<std::uint32_t>(after - begin) - 1;
}

/// Prefix sums over the nodes of the lowest level.
struct PrefixSums {
  std::vector<double> expected, excess;

  /// The sum over the nodes of a subtree.
  static double of(const std::vector<double>& sums, const Tree& tree, SlotId slot) {
    const Subtree s = subtree_of(tree, slot);
    return sums[lowest_node_of(tree, s.end_leaf - 1) + 1] - sums[lowest_node_of(tree, s.first_leaf)];
  }
};

/// The child of a slot, if that is a node above the lowest level.
std::optional<std::uint32_t> higher_child(const Tree& tree, SlotId slot) {
  if (node_of(slot) >= tree.first_lowest_node()) return std::nullopt;
  const std::uint32_t child = tree.nodes[node_of(slot)].first_child + slot_of(slot);
  return child < tree.first_lowest_node() ? std::optional(child) : std::nullopt;
}

/// The slot with the largest excess among those of the upper levels that cost more than is tolerated.
std::optional<SlotId> find_degraded(const Tree& tree, const PrefixSums& sums, double tolerated, SlotId slot,
                                    int levels) {
  const double excess = PrefixSums::of(sums.excess, tree, slot);
  if (excess > (tolerated - 1) * PrefixSums::of(sums.expected, tree, slot)) return slot;
  const std::optional<std::uint32_t> child = higher_child(tree, slot);
  if (!child || levels == 0) return std::nullopt;
  std::optional<SlotId> worst;
  for (std::uint32_t k = 0; k < tree.nodes[*child].child_count; ++k) {
    const std::optional<SlotId> found = find_degraded(tree, sums, tolerated, *child * width + k, levels - 1);
    if (!found) continue;
    if (!worst || PrefixSums::of(sums.excess, tree, *found) > PrefixSums::of(sums.excess, tree, *worst)) worst = found;
  }
  return worst;
}

}  // namespace

void TreeCost::set_expected(const Tree& tree, const Subtree& subtree) {
  expected_.resize(tree.nodes.size() - tree.first_lowest_node());
  const double whole = squared_radius_of_root(tree);
  const std::uint32_t end = lowest_node_of(tree, subtree.end_leaf - 1);
  for (std::uint32_t n = lowest_node_of(tree, subtree.first_leaf); n <= end; ++n) {
    expected_[n] = static_cast<float>(sum_of_squared_radii(tree.nodes[tree.first_lowest_node() + n]) / whole);
  }
}

double TreeCost::of(const Tree& tree, const Subtree& subtree) {
  double sum = 0;
  const std::uint32_t end = lowest_node_of(tree, subtree.end_leaf - 1);
  for (std::uint32_t n = lowest_node_of(tree, subtree.first_leaf); n <= end; ++n) {
    sum += sum_of_squared_radii(tree.nodes[tree.first_lowest_node() + n]);
  }
  return sum / squared_radius_of_root(tree);
}

std::optional<Subtree> TreeCost::most_degraded(const Tree& tree, double tolerated) const {
  const double whole = squared_radius_of_root(tree);
  PrefixSums sums{std::vector<double>(expected_.size() + 1), std::vector<double>(expected_.size() + 1)};
  for (std::size_t n = 0; n < expected_.size(); ++n) {
    const auto expected = static_cast<double>(expected_[n]);
    const double now = sum_of_squared_radii(tree.nodes[tree.first_lowest_node() + n]) / whole;
    sums.expected[n + 1] = sums.expected[n] + expected;
    sums.excess[n + 1] = sums.excess[n] + std::max(0.0, now - expected);
  }
  std::optional<SlotId> slot = find_degraded(tree, sums, tolerated, root, levels_searched);
  if (!slot) return std::nullopt;
  while (const std::optional<std::uint32_t> child = higher_child(tree, *slot)) {
    SlotId worst = *child * width;
    for (std::uint32_t k = 1; k < tree.nodes[*child].child_count; ++k) {
      const SlotId other = *child * width + k;
      if (PrefixSums::of(sums.excess, tree, other) > PrefixSums::of(sums.excess, tree, worst)) worst = other;
    }
    if (PrefixSums::of(sums.excess, tree, worst) < nearly_all * PrefixSums::of(sums.excess, tree, *slot)) break;
    slot = worst;
  }
  return subtree_of(tree, *slot);
}

}  // namespace limber::bvh

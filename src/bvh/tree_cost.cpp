// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/rebuild.h"

#include <algorithm>

#include "base/check.h"

namespace limber::bvh {
namespace {

// Levels below the root slot at which a degraded subtree is looked for, each compared with what it cost itself.
constexpr int levels_searched = 2;

// A subtree is narrowed down to a child that has this part of its excess cost.
constexpr double nearly_all = 0.9;

// Nodes of the lowest level that are looked at in one step.
constexpr std::uint32_t nodes_at_once = 8;

/// The squared radii of the children of a node, in squared units.
double sum_of_squared_radii(const Node& node) {
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
                                      [](std::uint32_t l, const Node& node) { return l < node.first_child; });
  return static_cast<std::uint32_t>(after - begin) - 1;
}

/// Sums over all lowest nodes before each one.
struct PrefixSums {
  const std::vector<double>&expected, &excess;

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

TreeCost::TreeCost(const Tree& tree)
    : expected_(tree.nodes.size() - tree.first_lowest_node()),
      expected_sum_(expected_.size() + 1),
      excess_sum_(expected_.size() + 1) {
  const double whole = squared_radius_of_root(tree);
  for (std::size_t n = 0; n < expected_.size(); ++n) {
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

void TreeCost::start_survey(const Tree& tree) {
  root_radius_sq_ = squared_radius_of_root(tree);
  surveyed_ = 0;
}

bool TreeCost::survey(const Tree& tree, base::WorkBudget& budget) {
  while (surveyed_ < expected_.size() && !budget.is_spent()) {
    const std::size_t end = std::min(surveyed_ + nodes_at_once, expected_.size());
    budget.spend(ns_per_node * static_cast<double>(end - surveyed_));
    for (std::size_t n = surveyed_; n < end; ++n) {
      const Node& node = tree.nodes[tree.first_lowest_node() + n];
      const auto expected = static_cast<double>(expected_[n]);
      const double now = sum_of_squared_radii(node) / root_radius_sq_;
      expected_sum_[n + 1] = expected_sum_[n] + expected;
      excess_sum_[n + 1] = excess_sum_[n] + std::max(0.0, now - expected);
    }
    surveyed_ = end;
  }
  return surveyed_ == expected_.size();
}

void TreeCost::start_comparison(const Tree& before, const Tree& after, const Subtree& subtree) {
  root_radius_sq_before_ = squared_radius_of_root(before);
  root_radius_sq_ = squared_radius_of_root(after);
  cost_before_ = cost_after_ = 0;
  compared_ = lowest_node_of(after, subtree.first_leaf);
  compare_end_ = lowest_node_of(after, subtree.end_leaf - 1) + 1;
}

bool TreeCost::compare(const Tree& before, const Tree& after, base::WorkBudget& budget) {
  while (compared_ < compare_end_ && !budget.is_spent()) {
    const std::uint32_t end = std::min(compared_ + nodes_at_once, compare_end_);
    budget.spend(2 * ns_per_node * (end - compared_));
    for (; compared_ < end; ++compared_) {
      const std::uint32_t n = after.first_lowest_node() + compared_;
      const double now = sum_of_squared_radii(after.nodes[n]) / root_radius_sq_;
      cost_before_ += sum_of_squared_radii(before.nodes[n]) / root_radius_sq_before_;
      cost_after_ += now;
      expected_[compared_] = static_cast<float>(now);
    }
  }
  return compared_ == compare_end_;
}

std::optional<Subtree> TreeCost::most_degraded(const Tree& tree, double tolerated) const {
  LIMBER_ASSERT(surveyed_ == expected_.size());
  const PrefixSums sums{expected_sum_, excess_sum_};
  std::optional<SlotId> slot = find_degraded(tree, sums, tolerated, root_slot, levels_searched);
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

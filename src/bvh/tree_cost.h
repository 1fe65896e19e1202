// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/work_budget.h"
#include "bvh/subtree.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// How much a tree has degraded: the cost of its leaves now, compared with what it was when they were built. Found out
/// step by step, while the tree may change.
///
/// The cost of a leaf is its squared radius as a part of the root's, so motion that scales the whole model costs
/// nothing.
///
/// Based on  [Lauterbach2006]: bounds that have grown more than their model show that triangles have moved apart.
/// Throws    Only the constructor allocates.
class TreeCost {
 public:
  /// What it takes to look at a node of the lowest level, in ns (docs/design/real_time.md).
  static constexpr double ns_per_node = 15;

  /// Takes the present cost as the expected one. Cost: O(nodes).
  explicit TreeCost(const Tree& tree);

  /// The present cost of the leaves of a subtree together. Cost: O(nodes of the subtree).
  static double of(const Tree& tree, const Subtree& subtree);

  /// Begins to compare the present cost with the expected one.
  void start_survey(const Tree& tree);
  /// Goes on within a budget. Returns whether the survey is complete.
  bool survey(const Tree& tree, base::WorkBudget& budget);
  /// The subtree to be rebuilt if the tree, or a large part of it, costs more than `tolerated` times what is expected:
  /// the smallest one that has nearly all of the excess. Pre: the survey is complete.
  std::optional<Subtree> most_degraded(const Tree& tree, double tolerated) const;

  /// Begins to compare the cost of a subtree before and after it was rebuilt.
  void start_comparison(const Tree& before, const Tree& after, const Subtree& subtree);
  /// Goes on within a budget, and takes the cost afterwards as the expected one. Returns whether all is compared.
  bool compare(const Tree& before, const Tree& after, base::WorkBudget& budget);
  /// The cost before as a multiple of that after. Pre: all is compared.
  double gain() const { return cost_before_ / cost_after_; }

 private:
  std::vector<float> expected_;  // by node of the lowest level
  // The survey's sums over all lowest nodes before each one.
  std::vector<double> expected_sum_, excess_sum_;
  double root_radius_sq_ = 1;
  std::size_t surveyed_ = 0;
  // How far the comparison has come.
  double root_radius_sq_before_ = 1, cost_before_ = 0, cost_after_ = 0;
  std::uint32_t compared_ = 0, compare_end_ = 0;
};

}  // namespace limber::bvh

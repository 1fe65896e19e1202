// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "bvh/subtree.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// How much a tree has degraded: the cost of its leaves now, compared with what it was when they were built.
///
/// The cost of a leaf is its squared radius as a part of the root's, so motion that scales the whole model costs
/// nothing.
///
/// Based on  [Lauterbach2006]: bounds that have grown more than their model show that triangles have moved apart.
class TreeCost {
 public:
  /// Takes the present cost as the expected one. Cost: O(nodes), as everything here.
  explicit TreeCost(const Tree& tree) { set_expected(tree, subtree_of(tree, root)); }

  /// Takes the present cost of a subtree as the expected one.
  void set_expected(const Tree& tree, const Subtree& subtree);

  /// The present cost of the leaves of a subtree together.
  static double of(const Tree& tree, const Subtree& subtree);

  /// The subtree to be rebuilt if the tree, or a large part of it, costs more than `tolerated` times what is expected:
  /// the smallest one that has nearly all of the excess.
  std::optional<Subtree> most_degraded(const Tree& tree, double tolerated) const;

 private:
  std::vector<float> expected_;  // by node of the lowest level
};

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "tree/divide.h"
#include "tree/node.h"

namespace limber::tree {

/// A subtree and its leaves, those from `first_leaf` up to `end_leaf`.
struct Subtree {
  NodeId node;
  std::uint32_t first_leaf, end_leaf;
};
Subtree subtree_of(const Tree& tree, NodeId node);

/// How loose the leaves are, compared with what they were once.
///
/// The measure of a leaf is its squared radius; motion that scales the whole model changes nothing.
/// Based on  [Lauterbach2006]: bounds that have grown more than their model tell of triangles that have come
/// apart.
class Quality {
 public:
  /// Takes the tree as it is for what it should be. Cost: O(blocks), as everything here.
  explicit Quality(const Tree& tree) { set(tree, subtree_of(tree, root)); }

  /// The same for a part of it.
  void set(const Tree& tree, const Subtree& subtree);

  /// The measures of the leaves of a subtree together, as a part of the root's.
  static double sum(const Tree& tree, const Subtree& subtree);

  /// The smallest subtree that holds nearly all of what the tree, or a large part of it, has become worse by; none
  /// where that is less than a factor of `most`.
  std::optional<Subtree> worst(const Tree& tree, double most) const;

 private:
  std::vector<float> expected_;  // by block of the lowest level, as parts of the root's
};

/// Puts the triangles of a subtree into its leaves anew, as if the tree had just been built, step by step: the shape of
/// the tree stays, only who is where becomes another.
///
/// Based on  [Yoon2007]: only what has become bad is restructured.
/// Differs   Nothing is changed until all is sorted, so the old tree serves queries in the meantime.
class Restructuring {
 public:
  /// Looks at the triangles as they are now. Cost: O(triangles of the subtree).
  /// Throws   std::bad_alloc.
  Restructuring(const Tree& tree, MeshView mesh, const Subtree& subtree);

  const Subtree& subtree() const { return subtree_; }

  /// Sorts on, until `budget` triangles have been looked at; one halving, of the whole subtree at first, is the least
  /// there is. Returns whether all is done. Allocates nothing, and uses no other thread.
  bool work(double budget);
  /// The same to the end, on the threads of the calling oneTBB arena.
  void finish();

  /// Writes the leaves. Their bounds and all above them have to be fitted afterwards. Pre: all is done.
  /// Throws   Nothing: where other threads cannot be had, the calling one writes all leaves.
  void apply(Tree& tree, MeshView mesh) const;

 private:
  Subtree subtree_;
  std::vector<Item> items_;
  std::vector<Part> parts_;  // still to be divided
};

}  // namespace limber::tree

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "bvh/partition.h"
#include "bvh/subtree.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// Rebuilds a subtree step by step: assigns its triangles to its leaves as build() would. The topology of the tree
/// stays.
///
/// Based on  [Yoon2007]: only what has degraded is rebuilt.
/// Differs   The tree does not change until all triangles have been partitioned, so queries go on meanwhile.
class PartialRebuild {
 public:
  /// Starts with the triangles as they are now.
  ///
  /// Cost     O(triangles of the subtree).
  /// Throws   std::bad_alloc.
  PartialRebuild(const Tree& tree, MeshView mesh, const Subtree& subtree);

  const Subtree& subtree() const { return subtree_; }

  /// Partitions on, until about `budget` triangles have been moved: nothing if that is 0, otherwise at least one split,
  /// at first that of the whole subtree. Returns whether all is partitioned. Allocates nothing, uses no other thread.
  bool work(double budget);
  /// Partitions to the end, on the threads of the calling oneTBB arena.
  void finish();

  /// Writes the leaves. Their bounds and all above them have to be fitted afterwards. Allocates nothing, uses no other
  /// thread.
  ///
  /// Pre      All is partitioned.
  void apply(Tree& tree, MeshView mesh) const;

 private:
  Subtree subtree_;
  std::vector<PrimitiveRef> primitives_;
  std::vector<BuildRange> ranges_;  // still to be partitioned
};

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "base/memory.h"
#include "bvh/tree.h"
#include "layout/moving_node.h"

namespace limber::bvh {

/// The bounds of a model whose vertices go from one position each to another: the topology is that of its tree.
///
/// A box whose corners are interpolated contains, at every time, what it contains at both ends: each coordinate of a
/// vertex is between two numbers that are interpolated as it is.
struct MovingTree {
  std::vector<MovingNode, base::UninitializedAllocator<MovingNode>> nodes;
  std::vector<MovingLeaf, base::UninitializedAllocator<MovingLeaf>> leaves;
};

/// Fits all bounds to vertices that go from `start` to `end`, both in the world. The tree's own bounds do not matter.
///
/// Cost     O(n), on the threads of the calling oneTBB arena; the same bounds on any number of them.
void fit(MovingTree& moving, const Tree& tree, std::span<const Vec3> start, std::span<const Vec3> end);

}  // namespace limber::bvh

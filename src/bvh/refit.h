// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "bvh/dirty_set.h"
#include "bvh/tree.h"
#include "limber/mesh.h"

namespace limber::bvh {

/// Refits the dirty nodes, and the nodes above them as long as bounds change; or fits the whole tree where that is
/// cheaper. Clears the set. Returns how many nodes were refitted. If oneTBB throws, what is left stays dirty.
///
/// Cost     O(nodes refitted); fit() at most.
std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty);

/// The unit that a rebuild should write a tree in: the tree's own, or the one that suits its bounds where the ratio of
/// the two is above `unit_ratio_until_rebuild`.
///
/// Cost     O(1), from the bounds of the root slot.
double unit_for_rebuild(const Tree& tree);

/// Fits the slots of a node above the lowest level. Nodes on the lowest level are fitted, with their leaves, along with
/// their parent. So called for all nodes above that level, from the last to the first, this fits the whole tree.
///
/// Pre      The slots of children above the lowest level are fitted.
void fit_upper_node(Tree& tree, MeshView mesh, std::uint32_t node);

/// Refits one dirty node: on the lowest level its slots and leaves; on all levels the slot of the parent that bounds
/// the node. Returns whether the parent has become dirty; false for node 0, which has none.
///
/// Pre      Everything below the node is fitted; above the lowest level also the node's own slots, which its children
///          have set.
bool refit_node(Tree& tree, MeshView mesh, std::uint32_t node);

}  // namespace limber::bvh

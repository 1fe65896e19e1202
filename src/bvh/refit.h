// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "bvh/dirty_set.h"
#include "bvh/tree.h"
#include "limber/mesh.h"

namespace limber::bvh {

/// Refits the dirty nodes, and the nodes above them as long as bounds change; or the whole tree where that is cheaper.
/// Clears the set. Returns how many nodes were refitted.
///
/// Cost     O(nodes refitted); fit() at most.
std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty);

/// The unit that a tree should be written in: its own, or another once the model has become far larger or smaller.
///
/// Cost     O(1), from the bounds of the root.
double better_unit(const Tree& tree);

/// Fits the child slots of a node above the lowest level: one step of fitting a tree from its last such node to its
/// first.
///
/// Pre      Called before for all children that are above the lowest level.
void fit_children(Tree& tree, MeshView mesh, std::uint32_t node);

/// Refits the slot of its parent that stands for a node. Returns whether it has changed, so that the parent is to be
/// refitted too.
///
/// Pre      What is below the node is fitted.
bool refit_node(Tree& tree, MeshView mesh, std::uint32_t node);

}  // namespace limber::bvh

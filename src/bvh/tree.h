// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "base/memory.h"
#include "bvh/unit.h"
#include "layout/node.h"
#include "limber/base.h"
#include "limber/mesh.h"

/// The hierarchy of a mesh: a BVH with up to eight children a node. Nodes lie level by level, so siblings are adjacent;
/// all leaves are children of the lowest level. A node stores the bounding volumes of its children, each in a child
/// slot. The volume around the node itself is in a slot of its parent.
///
/// So the volume of the whole mesh needs a node above the root: node 0, the header. Its only slot, `root_slot`, bounds
/// the mesh. The child of that slot is node 1, the root, called top node; or leaf 0 if there is only one leaf.
///
/// Invariants, checked by validate():
///   I1  The header has one child. Every other node is the child of exactly one slot, one level up.
///   I2  Every leaf is the child of exactly one slot of the lowest level; every triangle is in exactly one leaf. The
///       triangles of a leaf are in ascending order, with the ids of their vertices. If the last leaf has fewer than
///       eight triangles, copies of its last triangle fill it up.
///   I3  The levels of nodes, with the header's, without the leaves, are ceil(log8(n)) for n triangles, but at least 1.
///   I4  The sphere, box and slab of a slot contain every corner of every triangle below it, where the corner was when
///       bounds were last fitted to it: at its position at the last refit. It is at most `slack` away from there.
///   I5  A decoded quantized corner differs from the exact one by at most 0.52 quantization steps + 2^-51 times the
///       corner's largest coordinate, in each coordinate. All are in units, relative to the node's origin.
///   I6  `radius` of a node is at least the distance of its origin from every point of its children's spheres.
///   I7  All triangles below a slot that is marked coincident had equal corners, in equal order, at the last refit.
namespace limber::bvh {

/// The nodes and leaves of a tree.
struct TreeGeometry {
  std::vector<Node> nodes;
  std::vector<Leaf, base::UninitializedAllocator<Leaf>> leaves;
  std::vector<std::uint32_t> level_begin;  // first node of each level, from the header's down; at the end nodes.size()
  double unit = 1;                         // the length that 1 stands for in nodes, see unit.h

  std::size_t lowest_level() const { return level_begin.size() - 2; }
  /// The first node whose children are leaves. The children of all nodes after it are leaves, too.
  std::uint32_t first_lowest_node() const { return level_begin[lowest_level()]; }
};

/// The tree of a model whose vertices move.
struct Tree : TreeGeometry {
  std::uint64_t build_id = 0;  // names the assignment of triangles to leaves: another assignment gets another id
  double displacement = 0;     // upper bound of how far any vertex has moved since the tree got its build_id
  double slack = 0;            // upper bound of the distance of any vertex from its position at the last refit

  /// Swaps nodes, leaves and unit with another tree of this mesh, which has equal levels. Takes a new build id;
  /// `displacement`, which counts from then on, becomes 0.
  void exchange(TreeGeometry& other);
};

/// A child slot of a node: 8 * node + slot, with slot < 8. Stands for the child's bounding volume and subtree.
using SlotId = std::uint32_t;
/// The slot that bounds the whole mesh, the only one of node 0.
inline constexpr SlotId root_slot = 0;

/// The node that stores a slot, not the slot's child; child_of() is that.
inline std::uint32_t node_of(SlotId id) { return id / width; }
/// The index of a slot in its node, 0 to 7. Functions that take a node and a `slot` expect this index.
inline std::uint32_t slot_of(SlotId id) { return id % width; }

/// Center of a slot's volume, relative to the node's origin, in units.
inline Vec3 local_slot_center(const Node& node, std::uint32_t slot) {
  return {node.bounds.center_x[slot], node.bounds.center_y[slot], node.bounds.center_z[slot]};
}
/// Center of a slot's volume in the model frame. Products with the unit, a power of two, are exact; the sum is rounded,
/// by at most 2^-53 of each coordinate.
inline Vec3 slot_center(const Tree& tree, SlotId id) {
  const Node& node = tree.nodes[node_of(id)];
  return node.origin + tree.unit * local_slot_center(node, slot_of(id));
}

/// Whether the child of a slot is a leaf.
inline bool has_leaf(const Tree& tree, SlotId id) { return node_of(id) >= tree.first_lowest_node(); }
/// Whether all triangles below a slot coincided at the last refit.
inline bool is_coincident(const Tree& tree, SlotId id) {
  return (tree.nodes[node_of(id)].coincident_slots >> slot_of(id) & 1) != 0;
}
/// The index of a slot's child: in `leaves` if it has a leaf, else in `nodes`.
inline std::uint32_t child_of(const Tree& tree, SlotId id) { return tree.nodes[node_of(id)].first_child + slot_of(id); }
/// Pre: has_leaf().
inline const Leaf& leaf_of(const Tree& tree, SlotId id) { return tree.leaves[child_of(tree, id)]; }

/// Whether a slot need not be expanded: it has a leaf, or all triangles below it coincide now, so that any leaf below
/// stands for all. They may no longer coincide where vertices are away from their positions at the last refit.
inline bool has_leaf_or_coincides(const Tree& tree, SlotId id) {
  return has_leaf(tree, id) || (is_coincident(tree, id) && tree.slack == 0);
}

/// The slot of the first leaf below a slot.
inline SlotId first_leaf_slot(const Tree& tree, SlotId id) {
  while (!has_leaf(tree, id)) id = child_of(tree, id) * width;
  return id;
}

/// A leaf, with the slot whose child it is and the node that stores the slot: its corners are relative to
/// the slot's sphere.
struct LeafInNode {
  const Node& node;
  std::uint32_t slot;
  const Leaf& leaf;
};
/// The first leaf below a slot.
inline LeafInNode first_leaf(const Tree& tree, SlotId id) {
  const SlotId slot = first_leaf_slot(tree, id);
  return {tree.nodes[node_of(slot)], slot_of(slot), leaf_of(tree, slot)};
}

/// Builds the tree of a mesh: assigns triangles to leaves, and fits all bounds.
///
/// Cost     O(n log n), on the threads of the calling oneTBB arena; the same tree on any number of them.
Tree build(MeshView mesh);

/// Recomputes all bounds from the positions, and the unit if it no longer suits the model's size. The topology and the
/// assignment of triangles to leaves stay.
///
/// Cost     O(n), parallel as build().
void fit(Tree& tree, MeshView mesh);

/// Checks the invariants I1 to I7.
///
/// Errors   `broken_invariant`, naming the invariant's number and the node.
Result<void> validate(const Tree& tree, MeshView mesh);

}  // namespace limber::bvh

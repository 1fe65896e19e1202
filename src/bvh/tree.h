// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "base/uninitialized.h"
#include "bvh/node.h"
#include "limber/base.h"
#include "limber/mesh.h"

/// The hierarchy of a mesh. Nodes lie level by level, so siblings are adjacent; all leaves are on one level.
///
/// Invariants, checked by validate():
///   I1  Node 0 is the root's: it has one child, the root of the hierarchy. Every other node is the child of
///       exactly one slot, one level up.
///   I2  Every leaf is the child of exactly one slot of the lowest level; every triangle is in exactly one leaf. Slots
///       of the last leaf beyond the triangles repeat its last one. The triangles of a leaf are in ascending order. A
///       leaf names their vertices.
///   I3  The number of levels depends on the number of triangles alone: at most 2 + log8(n / 8) rounded up.
///   I4  The sphere, box and slab of a slot contain every corner of every triangle below it, up to `slack`:
///       they contain the positions at the last refit of its vertices.
///   I5  A quantized corner is within 0.52 steps, each coordinate, of the corner it stands for, and within the float64
///       rounding of its place relative to the node's origin, which the error of placed points covers.
///   I6  `radius` of a node is at least the distance from its origin of every point of its children's spheres.
///   I7  All triangles below a slot that is marked coincident had equal corners, in order, at the last refit.
namespace limber::bvh {

struct TreeGeometry {
  std::vector<Node> nodes;
  std::vector<Leaf, base::UninitializedAllocator<Leaf>> leaves;
  std::vector<std::uint32_t> level_begin;  // first node of each level, and one past the last
  double unit = 1;                         // length of 1 in the nodes, a power of two

  /// The first node whose children are leaves; all after it are of that kind too.
  std::uint32_t first_lowest_node() const { return level_begin[level_begin.size() - 2]; }
};

/// The same of a model, with how its vertices have moved.
struct Tree : TreeGeometry {
  std::uint64_t build_id = 0;  // of the assignment of triangles to leaves: changes whenever that does
  double displacement = 0;     // at least how far any vertex has moved since the tree got its build_id
  double slack = 0;            // vertices are at most this far from their positions at the last refit

  /// Changes places with the nodes and leaves of another tree of the same mesh, and gets a new build id.
  void exchange(TreeGeometry& other);
};

/// A child slot of a node, which stands for the child's bounding volume and subtree: node * width + slot.
using SlotId = std::uint32_t;
inline constexpr SlotId root = 0;

inline std::uint32_t node_of(SlotId id) { return id / width; }
inline std::uint32_t slot_of(SlotId id) { return id % width; }

inline Vec3 local_slot_center(const Node& node, std::uint32_t slot) {
  return {node.bounds.center_x[slot], node.bounds.center_y[slot], node.bounds.center_z[slot]};
}
/// Center of a slot's volume in the model frame, rounded: within 2^-52 of the sum of the magnitudes added.
inline Vec3 slot_center(const Tree& tree, SlotId id) {
  const Node& node = tree.nodes[node_of(id)];
  return node.origin + tree.unit * local_slot_center(node, slot_of(id));
}

/// Whether the child of a slot is a leaf.
inline bool has_leaf(const Tree& tree, SlotId id) { return node_of(id) >= tree.first_lowest_node(); }
/// Whether all triangles below a slot coincided when they were last fitted.
inline bool is_coincident(const Tree& tree, SlotId id) {
  return (tree.nodes[node_of(id)].coincident_slots >> slot_of(id) & 1) != 0;
}
/// The index of a slot's child: in `leaves` if it has a leaf, else in `nodes`.
inline std::uint32_t child_of(const Tree& tree, SlotId id) { return tree.nodes[node_of(id)].first_child + slot_of(id); }
/// Pre: has_leaf().
inline const Leaf& leaf_of(const Tree& tree, SlotId id) { return tree.leaves[child_of(tree, id)]; }

/// Whether a slot need not be expanded: it has a leaf, or all triangles below it coincide, so that any leaf below
/// stands for it. With a motion margin, vertices may have moved since they coincided.
inline bool has_leaf_or_coincides(const Tree& tree, SlotId id) {
  return has_leaf(tree, id) || (is_coincident(tree, id) && tree.slack == 0);
}

/// The slot of the first leaf below a slot.
inline SlotId first_leaf_slot(const Tree& tree, SlotId id) {
  while (!has_leaf(tree, id)) id = child_of(tree, id) * width;
  return id;
}

/// A leaf as kernels take it: with the node and the slot whose child it is.
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

/// Builds the tree of a mesh.
///
/// Cost     O(n log n), on the threads of the caller's oneTBB arena; the same tree on any number of them.
Tree build(MeshView mesh);

/// The unit for a mesh of that size, with coordinates of that magnitude: a power of two near the size; for a mesh that
/// is a point, near what float64 resolves there.
double unit_for(double size, double magnitude);

/// Recomputes all bounds from the positions. The topology of the tree and the assignment of triangles to leaves stay.
///
/// Cost     O(n), parallel as build().
void fit(Tree& tree, MeshView mesh);

/// Checks the invariants above.
///
/// Errors   `broken_invariant`, naming the invariant's number and the node.
Result<void> validate(const Tree& tree, MeshView mesh);

}  // namespace limber::bvh

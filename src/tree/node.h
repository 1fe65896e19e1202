// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "limber/base.h"
#include "limber/mesh.h"
#include "simd/packets.h"

/// The tree's data. A node is a lane of a block; a block holds the children of one node, and block 0 holds the root
/// alone. Blocks lie level by level, so siblings' blocks are adjacent; all leaves are on one level.
///
/// Invariants, checked by validate():
///   I1  Block 0 has one lane. Every other block is the child block of exactly one lane, one level up.
///   I2  Every leaf is the child of exactly one lane of the lowest level; every triangle is in exactly one leaf. Lanes
///       of the last leaf beyond the triangles repeat its last one. A leaf names the vertices of its triangles.
///   I3  The number of levels depends on the number of triangles alone: at most 2 + log8(n / 8) rounded up.
///   I4  A lane's ball, box and slab contain every corner of every triangle below it, up to `slack`: they hold the
///       anchors of its vertices.
///   I5  A quantised corner is within 0.52 steps, each coordinate, of the corner it stands for, and within the float64
///       rounding of its place relative to the block's origin, which the error of placed points covers.
///   I6  `reach` of a block is at least the distance from its origin of every point of its lanes' balls.
///   I7  All triangles below a lane that is marked coincident have equal corners, in order, where the bounds hold them.
namespace limber::tree {

using simd::width;

using simd::Block;
using simd::Leaf;

struct Tree {
  std::vector<Block> blocks;
  std::vector<Leaf> leaves;
  std::vector<std::uint32_t> level_begin;      // first block of each level, and one past the last
  double unit = 1;                             // length of 1 in the blocks, a power of two
  std::uint64_t id = 0;                        // of who is where: another one once that has changed
  double motion = 0;                           // at least the way any vertex has gone since the tree got its id
  double slack = 0;                            // corners are at most this far from where the bounds hold them
  std::atomic<std::uint64_t>* paid = nullptr;  // where queries add what the slack has cost them, in part_of_step

  /// Blocks from here on have leaves as children.
  std::uint32_t lowest_level() const { return level_begin[level_begin.size() - 2]; }
};

/// Unit of Tree::paid: queries count steps of a traversal that a tight tree would have been spared.
inline constexpr double part_of_step = 1.0 / 64;

/// A lane of a block: block * width + lane.
using NodeId = std::uint32_t;
inline constexpr NodeId root = 0;

inline std::uint32_t block_of(NodeId node) { return node / width; }
inline std::uint32_t lane_of(NodeId node) { return node % width; }

inline Vec3 local_center(const Block& block, std::uint32_t lane) {
  return {block.bounds.center_x[lane], block.bounds.center_y[lane], block.bounds.center_z[lane]};
}
/// Centre of a node in the model frame, rounded: within 2^-52 of the sum of the magnitudes added.
inline Vec3 model_center(const Tree& tree, NodeId node) {
  const Block& block = tree.blocks[block_of(node)];
  return block.origin + tree.unit * local_center(block, lane_of(node));
}

/// The first leaf below a node, as a node.
inline NodeId first_leaf_below(const Tree& tree, NodeId node) {
  while (block_of(node) < tree.lowest_level()) node = (tree.blocks[block_of(node)].first_child + lane_of(node)) * width;
  return node;
}

/// The tree of a mesh.
///
/// Cost     O(n log n), on the threads of the caller's oneTBB arena; the same tree on any number of them.
Tree build(MeshView mesh);

/// Length of 1 for a mesh of that size, with coordinates of that magnitude: a power of two near the size; for a mesh
/// that is a point, near what float64 resolves there.
double unit_for(double size, double magnitude);

/// Recomputes all bounds from the positions; the shape of the tree and who is in which leaf stay.
///
/// Cost     O(n), parallel as build().
void fit(Tree& tree, MeshView mesh);

/// Errors   `broken_invariant`, naming the invariant's number and the node.
Result<void> validate(const Tree& tree, MeshView mesh);

}  // namespace limber::tree

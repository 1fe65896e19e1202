// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "limber/classic.h"

/// The sphere tree's data. Nodes lie in breadth-first order, so the levels are contiguous, siblings are adjacent and
/// every child comes after its parent: walking the array backwards visits children first.
///
/// Invariants, checked by validate():
///   I1  There are 2 n - 1 nodes; node 0 is the root; a node is a leaf or has two children.
///   I2  The children of a node are adjacent, come after it, name it as parent and are one level deeper.
///   I3  Every triangle has exactly one leaf, and leaf_of finds it.
///   I4  The depth is ceil(log2 n), however the vertices move.
///   I5  A leaf's sphere contains its triangle.
///   I6  An inner sphere contains the spheres of both children.
///   I7  No repair is pending.
namespace limber::classic {

struct Node {
  Sphere sphere;              // 32 bytes
  std::uint32_t parent;       //  4   no_id for the root
  std::uint32_t first_child;  //  4   the second is first_child + 1; no_id for a leaf
  TriangleId triangle;        //  4   no_id for an inner node
  std::uint32_t depth;        //  4   edges to the root

  bool is_leaf() const { return triangle != no_id; }
};
static_assert(sizeof(Node) == 48);

inline constexpr std::uint32_t root = 0;

struct Tree {
  Mesh mesh;
  ModelOptions options;

  std::vector<Node> nodes;
  std::vector<std::uint32_t> leaf_of;  // by triangle

  // Triangles at vertex v: triangles_at[first_triangle_at[v]] up to first_triangle_at[v + 1].
  std::vector<std::uint32_t> first_triangle_at;
  std::vector<TriangleId> triangles_at;

  // What commit() has to repair.
  std::vector<TriangleId> changed_triangles;
  std::vector<std::uint8_t> is_changed;                    // by triangle
  std::vector<std::vector<std::uint32_t>> queue_at_depth;  // nodes waiting for repair, empty between commits
  std::vector<std::uint8_t> is_queued;                     // by node

  MaintenanceStats stats;

  Tree(Mesh mesh_to_own, const ModelOptions& model_options);
};

/// The sphere a node would be given now, without extra radius.
Sphere tight_sphere(const Tree& tree, const Node& node);

/// Whether the node's sphere contains its triangle or both children's spheres, judged so that rounding can only say no.
bool sphere_holds(const Tree& tree, const Node& node);

/// Adds the extra radius that the looseness settings ask for.
Sphere with_extra_radius(Sphere tight, const Looseness& looseness);

}  // namespace limber::classic

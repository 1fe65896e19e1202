// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "bvh/partition.h"
#include "bvh/tree.h"
#include "core/check.h"
#include "core/parallel.h"

namespace limber::bvh {
namespace {

// Fewer are not worth a task.
constexpr std::size_t primitives_per_task = 4096, leaves_per_task = 1024;

/// Appends, for each of `children` children, how many of `leaves` leaves are below it.
void distribute_leaves(std::uint32_t leaves, std::uint32_t children, std::vector<std::uint32_t>& counts) {
  if (children == 1) return counts.push_back(leaves);
  const std::uint32_t first = first_half_leaves(leaves, children);
  distribute_leaves(first, children / 2, counts);
  distribute_leaves(leaves - first, children - children / 2, counts);
}

/// Creates all wide nodes, without bounds, level by level.
void create_nodes(Tree& tree, std::uint32_t leaves) {
  std::vector<std::uint32_t> level{leaves}, counts;  // leaves below each slot of the level
  tree.nodes.push_back({});
  tree.nodes[0].child_count = 1;
  tree.level_begin = {0, 1};
  while (level.front() > 1) {
    std::vector<std::uint32_t> next;
    std::uint32_t parent = tree.level_begin[tree.level_begin.size() - 2], slot = 0;
    for (const std::uint32_t below : level) {
      const auto node = static_cast<std::uint32_t>(tree.nodes.size());
      if (slot == 0) tree.nodes[parent].first_child = node;
      const SlotId parent_slot = parent * width + slot;
      if (++slot == tree.nodes[parent].child_count) slot = 0, ++parent;
      counts.clear();
      distribute_leaves(below, child_count(below), counts);
      tree.nodes.push_back({});
      tree.nodes.back().child_count = static_cast<std::uint32_t>(counts.size());
      tree.nodes.back().parent = parent_slot;
      next.insert(next.end(), counts.begin(), counts.end());
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
    level.swap(next);
  }
  tree.nodes.shrink_to_fit();
  std::uint32_t leaf = 0;
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    tree.nodes[n].first_child = leaf;
    leaf += tree.nodes[n].child_count;
  }
  LIMBER_ASSERT(leaf == leaves);
}

}  // namespace

Tree build(MeshView mesh) {
  LIMBER_ASSERT(!mesh.triangles.empty());
  Tree tree;
  tree.assignment_id = new_assignment_id();
  const BoundingBox box = bounding_box_of(mesh);
  const Vec3 center = box.center();
  tree.unit = box.unit();

  std::vector<PrimitiveRef> primitives(mesh.triangles.size());
  core::parallel_for(primitives.size(), primitives_per_task, [&](std::size_t t) {
    primitives[t] = primitive_of(mesh, static_cast<TriangleId>(t), center, tree.unit);
  });
  partition_into_leaves(primitives, build_range(0, primitives.size()));
  const std::uint32_t leaves = leaf_count(primitives.size());
  create_nodes(tree, leaves);
  tree.leaves.resize(leaves);
  core::parallel_for(tree.leaves.size(), leaves_per_task,
                     [&](std::size_t i) { write_leaf(tree.leaves[i], mesh, primitives_of_leaf(primitives, i)); });
  fit(tree, mesh);
  return tree;
}

}  // namespace limber::bvh

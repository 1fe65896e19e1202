// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/parallel.h"
#include "bvh/partition.h"
#include "bvh/tree.h"
#include "bvh/unit.h"

namespace limber::bvh {
namespace {

// Fewer are not worth a task.
constexpr std::size_t primitives_per_task = 4096, leaves_per_task = 1024;

/// A build id that no tree has had.
std::uint64_t new_build_id() {
  static std::atomic<std::uint64_t> last{0};
  return ++last;
}

/// Appends, for each of `children` children, how many of `leaves` leaves are below it.
void distribute_leaves(std::uint32_t leaves, std::uint32_t children, std::vector<std::uint32_t>& counts) {
  if (children == 1) return counts.push_back(leaves);
  const std::uint32_t first = first_half_leaves(leaves, children);
  distribute_leaves(first, children / 2, counts);
  distribute_leaves(leaves - first, children - children / 2, counts);
}

/// How many leaves are below each slot of a level, level by level: first below the root slot, at last below those that
/// have a leaf each.
std::vector<std::vector<std::uint32_t>> leaves_below_slots(std::uint32_t leaves) {
  std::vector<std::vector<std::uint32_t>> levels{{leaves}};
  while (levels.back().front() > 1) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t below : levels.back()) distribute_leaves(below, child_count(below), next);
    levels.push_back(std::move(next));
  }
  return levels;
}

/// Creates all nodes, without bounds, level by level.
void create_nodes(Tree& tree, std::uint32_t leaves) {
  std::vector<std::vector<std::uint32_t>> levels = leaves_below_slots(leaves);
  levels.pop_back();  // slots with leaves have no nodes
  std::size_t count = 1;
  for (const auto& level : levels) count += level.size();
  tree.nodes.reserve(count);
  tree.nodes.push_back({});
  tree.nodes[0].child_count = 1;
  tree.level_begin = {0, 1};
  for (const std::vector<std::uint32_t>& level : levels) {
    std::uint32_t parent = tree.level_begin[tree.level_begin.size() - 2], slot = 0;
    for (const std::uint32_t below : level) {
      const auto node = static_cast<std::uint32_t>(tree.nodes.size());
      if (slot == 0) tree.nodes[parent].first_child = node;
      tree.nodes.push_back({});
      tree.nodes.back().child_count = child_count(below);
      tree.nodes.back().parent = parent * width + slot;
      if (++slot == tree.nodes[parent].child_count) slot = 0, ++parent;
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.nodes.size()));
  }
  std::uint32_t leaf = 0;
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    tree.nodes[n].first_child = leaf;
    leaf += tree.nodes[n].child_count;
  }
  LIMBER_ASSERT(leaf == leaves);
}

}  // namespace

void Tree::exchange(TreeGeometry& other) {
  LIMBER_ASSERT(level_begin == other.level_begin);
  std::swap(static_cast<TreeGeometry&>(*this), other);
  build_id = new_build_id();
  displacement = 0;
}

Tree build(MeshView mesh) {
  LIMBER_ASSERT(!mesh.triangles.empty());
  Tree tree;
  tree.build_id = new_build_id();
  const BoundingBox box = bounding_box_of(mesh);
  tree.unit = box.unit();

  const std::size_t count = mesh.triangles.size();
  const auto memory = std::make_unique_for_overwrite<PrimitiveRef[]>(count);
  const std::span<PrimitiveRef> primitives(memory.get(), count);
  const auto memory_of_sides = std::make_unique_for_overwrite<HalfSides[]>(count);
  const std::span<HalfSides> half_sides(memory_of_sides.get(), count);
  const PrimitiveSource source{mesh, box.center(), 0.5 / tree.unit};
  base::parallel_for(count, primitives_per_task, [&](std::size_t t) {
    primitives[t] = source.primitive_of(static_cast<TriangleId>(t), half_sides[t]);
  });
  partition_into_leaves(primitives, build_range(0, count), half_sides);
  const std::uint32_t leaves = leaf_count(count);
  create_nodes(tree, leaves);
  tree.leaves.resize(leaves);
  base::parallel_for(tree.leaves.size(), leaves_per_task,
                     [&](std::size_t i) { write_leaf(tree.leaves[i], mesh, primitives_of_leaf(primitives, i)); });
  fit(tree, mesh);
  return tree;
}

}  // namespace limber::bvh

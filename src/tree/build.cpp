// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

#include <algorithm>
#include <cmath>

#include "core/check.h"
#include "core/parallel.h"
#include "tree/divide.h"
#include "tree/node.h"

namespace limber::tree {
namespace {

void share(std::uint32_t leaves, std::uint32_t children, std::vector<std::uint32_t>& parts) {
  if (children == 1) return parts.push_back(leaves);
  const std::uint32_t first = first_share(leaves, children);
  share(first, children / 2, parts);
  share(leaves - first, children - children / 2, parts);
}

/// All blocks, without bounds, level by level.
void lay_out(Tree& tree, std::uint32_t leaves) {
  std::vector<std::uint32_t> level{leaves}, parts;  // leaves below each node of the level
  tree.blocks.push_back({});
  tree.blocks[0].count = 1;
  tree.level_begin = {0, 1};
  while (level.front() > 1) {
    std::vector<std::uint32_t> next;
    std::uint32_t parent = tree.level_begin[tree.level_begin.size() - 2], lane = 0;
    for (const std::uint32_t below : level) {
      const auto block = static_cast<std::uint32_t>(tree.blocks.size());
      if (lane == 0) tree.blocks[parent].first_child = block;
      const NodeId parent_node = parent * width + lane;
      if (++lane == tree.blocks[parent].count) lane = 0, ++parent;
      parts.clear();
      share(below, child_count(below), parts);
      tree.blocks.push_back({});
      tree.blocks.back().count = static_cast<std::uint32_t>(parts.size());
      tree.blocks.back().parent = parent_node;
      next.insert(next.end(), parts.begin(), parts.end());
    }
    tree.level_begin.push_back(static_cast<std::uint32_t>(tree.blocks.size()));
    level.swap(next);
  }
  tree.blocks.shrink_to_fit();
  std::uint32_t leaf = 0;
  for (std::uint32_t b = tree.lowest_level(); b < tree.blocks.size(); ++b) {
    tree.blocks[b].first_child = leaf;
    leaf += tree.blocks[b].count;
  }
  LIMBER_ASSERT(leaf == leaves);
}

}  // namespace

Tree build(MeshView mesh) {
  LIMBER_ASSERT(!mesh.triangles.empty());
  Tree tree;
  tree.id = new_id();
  const Extent extent = extent_of(mesh);
  const Vec3 middle = extent.middle();
  tree.unit = extent.unit();

  std::vector<Item> items(mesh.triangles.size());
  core::parallel_for(items.size(), 4096,
                     [&](std::size_t t) { items[t] = item_of(mesh, static_cast<TriangleId>(t), middle, tree.unit); });
  sort_into_leaves(items, part_of(0, items.size()));
  const std::uint32_t leaves = leaf_count(items.size());
  lay_out(tree, leaves);
  tree.leaves.resize(leaves);
  write_leaves(tree, mesh, 0, items);
  fit(tree, mesh);
  return tree;
}

}  // namespace limber::tree

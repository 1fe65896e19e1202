// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include "tree/node.h"

namespace limber::tree {
namespace {

Error broken(int invariant, const std::string& what, std::size_t where) {
  std::string text = "I";
  text += std::to_string(invariant) + ": " + what + " " + std::to_string(where);
  return {ErrorCode::broken_invariant, text, where};
}

Result<void> check_shape(const Tree& tree, std::size_t triangles) {
  if (tree.level_begin.size() < 2 || tree.level_begin[0] != 0 || tree.level_begin.back() != tree.blocks.size()) {
    return broken(1, "levels do not cover the blocks of level", tree.level_begin.size());
  }
  if (tree.blocks[0].count != 1) return broken(1, "lanes of block", 0);
  const std::size_t levels = tree.level_begin.size() - 1;
  for (std::size_t level = 0; level < levels; ++level) {
    const bool lowest = level + 1 == levels;
    std::size_t child = lowest ? 0 : tree.level_begin[level + 1];
    for (std::uint32_t b = tree.level_begin[level]; b < tree.level_begin[level + 1]; ++b) {
      const Block& block = tree.blocks[b];
      if (block.count == 0 || block.count > width) return broken(1, "number of lanes of block", b);
      if (block.first_child != child) return broken(lowest ? 2 : 1, "first child of block", b);
      for (std::uint32_t k = 0; k < block.count && !lowest; ++k) {
        if (child + k < tree.blocks.size() && tree.blocks[child + k].parent != b * width + k) {
          return broken(1, "parent of block", child + k);
        }
      }
      child += block.count;
    }
    if (child != (lowest ? tree.leaves.size() : tree.level_begin[level + 2]))
      return broken(1, "children of level", level);
  }
  std::size_t most = 1, fewest_levels = 1;
  for (; most * width < triangles; most *= width) ++fewest_levels;
  if (levels != fewest_levels) return broken(3, "number of levels is", levels);
  return {};
}

Result<void> check_leaves(const Tree& tree, MeshView mesh) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<bool> seen(triangles);
  for (std::size_t i = 0; i < tree.leaves.size() * width; ++i) {
    const TriangleId t = tree.leaves[i / width].triangle[i % width];
    if (t >= triangles) return broken(2, "triangle of leaf", i / width);
    const bool padding = i >= triangles;
    if (padding ? t != tree.leaves.back().triangle[(triangles - 1) % width] : seen[t]) {
      return broken(2, "a triangle is in two leaves, one of them", i / width);
    }
    if (tree.leaves[i / width].vertices[i % width] != mesh.triangles[t])
      return broken(2, "vertices of leaf", i / width);
    seen[t] = true;
  }
  return {};
}

/// Whether a corner lies in all three volumes of a lane.
bool holds(const Tree& tree, NodeId node, const Vec3& corner) {
  const Block& block = tree.blocks[block_of(node)];
  const std::uint32_t k = lane_of(node);
  const simd::NodeBounds& n = block.bounds;
  const Vec3 d = (corner - block.origin) * (1 / tree.unit) - local_center(block, k);
  const auto at_most = [](double x, float limit) { return x <= static_cast<double>(limit); };
  const double h = dot(Vec3{n.normal_x[k], n.normal_y[k], n.normal_z[k]}, d);
  return at_most(length(d), n.radius[k]) && at_most(std::abs(d.x), n.half_x[k]) &&
         at_most(std::abs(d.y), n.half_y[k]) && at_most(std::abs(d.z), n.half_z[k]) && at_most(h, n.high[k]) &&
         at_most(-h, -n.low[k]);
}

Result<void> check_quantised(const Tree& tree, const Block& block, std::uint32_t lane, MeshView mesh) {
  const std::size_t id = block.first_child + lane;
  const Leaf& leaf = tree.leaves[id];
  const double step = static_cast<double>(block.bounds.radius[lane]) / static_cast<double>(simd::quantum);
  for (std::uint32_t k = 0; k < width; ++k) {
    for (std::uint32_t i = 0; i < 9; ++i) {
      const Vec3 exact = (mesh.triangle(leaf.triangle[k])[i / 3] - block.origin) * (1 / tree.unit);
      const double stored = local_center(block, lane)[i % 3] + step * leaf.corners.corner[i][k];
      const double rounding = 0x1p-51 * max_abs(exact);
      if (!(std::abs(stored - exact[i % 3]) <= 0.52 * step + rounding)) return broken(5, "corner of leaf", id);
    }
  }
  return {};
}

/// Checks the bounds of a node against all triangles below it.
Result<void> check_bounds(const Tree& tree, NodeId node, MeshView mesh, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t leaf = first; leaf < last; ++leaf) {
    for (const TriangleId t : tree.leaves[leaf].triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (!holds(tree, node, mesh.triangle(t)[k])) return broken(4, "content of node", node);
      }
    }
  }
  return {};
}

bool is_coincident(const Tree& tree, MeshView mesh, std::uint32_t first, std::uint32_t last) {
  const Triangle one = mesh.triangle(tree.leaves[first].triangle[0]);
  for (std::uint32_t leaf = first; leaf < last; ++leaf) {
    for (const TriangleId id : tree.leaves[leaf].triangle) {
      const Triangle t = mesh.triangle(id);
      if (t.v0 != one.v0 || t.v1 != one.v1 || t.v2 != one.v2) return false;
    }
  }
  return true;
}

/// First leaf below block `b`, or below what would follow the level's last block.
std::uint32_t first_leaf(const Tree& tree, std::uint32_t b, std::size_t level) {
  for (; level + 2 < tree.level_begin.size(); ++level) {
    if (b == tree.level_begin[level + 1]) return static_cast<std::uint32_t>(tree.leaves.size());
    b = tree.blocks[b].first_child;
  }
  return b == tree.blocks.size() ? static_cast<std::uint32_t>(tree.leaves.size()) : tree.blocks[b].first_child;
}

}  // namespace

Result<void> validate(const Tree& tree, MeshView mesh) {
  if (auto sound = check_shape(tree, mesh.triangles.size()); !sound) return sound;
  if (auto sound = check_leaves(tree, mesh); !sound) return sound;
  for (std::size_t level = 0; level + 1 < tree.level_begin.size(); ++level) {
    const bool lowest = level + 2 == tree.level_begin.size();
    for (std::uint32_t b = tree.level_begin[level]; b < tree.level_begin[level + 1]; ++b) {
      const Block& block = tree.blocks[b];
      for (std::uint32_t lane = 0; lane < block.count; ++lane) {
        const std::uint32_t child = block.first_child + lane;
        const std::uint32_t first = lowest ? child : first_leaf(tree, child, level + 1);
        const std::uint32_t last = lowest ? child + 1 : first_leaf(tree, child + 1, level + 1);
        if (auto sound = check_bounds(tree, b * width + lane, mesh, first, last); !sound) return sound;
        const double furthest = length(local_center(block, lane)) + static_cast<double>(block.bounds.radius[lane]);
        if (!(furthest <= static_cast<double>(block.reach))) return broken(6, "reach of block", b);
        if ((block.coincident >> lane & 1) != 0 && !is_coincident(tree, mesh, first, last)) {
          return broken(7, "triangles of node", b * width + lane);
        }
        if (!lowest) continue;
        if (auto sound = check_quantised(tree, block, lane, mesh); !sound) return sound;
      }
    }
  }
  return {};
}

}  // namespace limber::tree

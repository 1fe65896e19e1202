// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <string>

#include "base/error_bounds.h"
#include "bvh/tree.h"

namespace limber::bvh {
namespace {

// Of a coordinate, in steps: half a step of rounding, and what scaling adds.
constexpr double largest_quantization_error = 0.52;

Error broken(int invariant, const std::string& what, std::size_t where) {
  std::string text = "I";
  text += std::to_string(invariant) + ": " + what + " " + std::to_string(where);
  return {ErrorCode::broken_invariant, text, where};
}

Result<void> check_topology(const Tree& tree, std::size_t triangles) {
  if (tree.level_begin.size() < 2 || tree.level_begin[0] != 0 || tree.level_begin.back() != tree.nodes.size()) {
    return broken(1, "levels do not cover the nodes of level", tree.level_begin.size());
  }
  if (tree.nodes[0].child_count != 1) return broken(1, "children of node", 0);
  const std::size_t levels = tree.level_begin.size() - 1;
  for (std::size_t level = 0; level < levels; ++level) {
    const bool lowest = level + 1 == levels;
    std::size_t child = lowest ? 0 : tree.level_begin[level + 1];
    for (std::uint32_t n = tree.level_begin[level]; n < tree.level_begin[level + 1]; ++n) {
      const Node& node = tree.nodes[n];
      if (node.child_count == 0 || node.child_count > width) return broken(1, "number of children of node", n);
      if (node.first_child != child) return broken(lowest ? 2 : 1, "first child of node", n);
      for (std::uint32_t k = 0; k < node.child_count && !lowest; ++k) {
        if (child + k < tree.nodes.size() && tree.nodes[child + k].parent != n * width + k) {
          return broken(1, "parent of node", child + k);
        }
      }
      child += node.child_count;
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
  std::vector<bool> is_in_leaf(triangles);
  for (std::size_t i = 0; i < tree.leaves.size() * width; ++i) {
    const TriangleId t = tree.leaves[i / width].triangle[i % width];
    if (t >= triangles) return broken(2, "triangle of leaf", i / width);
    const bool padding = i >= triangles;
    if (padding ? t != tree.leaves.back().triangle[(triangles - 1) % width] : is_in_leaf[t]) {
      return broken(2, "a triangle is in two leaves, one of them", i / width);
    }
    if (i % width != 0 && t < tree.leaves[i / width].triangle[i % width - 1])
      return broken(2, "order of leaf", i / width);
    if (tree.leaves[i / width].vertices[i % width] != mesh.triangles[t])
      return broken(2, "vertices of leaf", i / width);
    is_in_leaf[t] = true;
  }
  return {};
}

/// Whether the volume of a slot contains a corner.
bool contains(const Tree& tree, SlotId id, const Vec3& corner) {
  const Node& node = tree.nodes[node_of(id)];
  const std::uint32_t k = slot_of(id);
  const ChildBounds& n = node.bounds;
  const Vec3 d = (corner - node.origin) * (1 / tree.unit) - local_slot_center(node, k);
  const auto at_most = [](double x, float limit) { return x <= static_cast<double>(limit); };
  const Vec3 normal{n.normal_x[k], n.normal_y[k], n.normal_z[k]}, side = in_plane(normal, node.sides.turn[k]);
  const double h = dot(normal, d), step = static_cast<double>(n.radius[k]) / double{max_side};
  const double across[2] = {dot(side, d), dot(cross(normal, side), d)};
  for (std::size_t i = 0; i < 2; ++i) {
    if (across[i] < step * node.sides.low[i][k] || across[i] > step * node.sides.high[i][k]) return false;
  }
  return at_most(length(d), n.radius[k]) && at_most(std::abs(d.x), n.half_x[k]) &&
         at_most(std::abs(d.y), n.half_y[k]) && at_most(std::abs(d.z), n.half_z[k]) && at_most(h, n.high[k]) &&
         at_most(-h, -n.low[k]);
}

Result<void> check_quantized(const Tree& tree, const Node& node, std::uint32_t slot, MeshView mesh) {
  const std::size_t id = node.first_child + slot;
  const Leaf& leaf = tree.leaves[id];
  const double step = static_cast<double>(node.bounds.radius[slot]) / static_cast<double>(max_quantized);
  for (std::uint32_t k = 0; k < width; ++k) {
    for (std::uint32_t i = 0; i < 9; ++i) {
      const Vec3 exact = (mesh.triangle(leaf.triangle[k])[i / 3] - node.origin) * (1 / tree.unit);
      const double stored = local_slot_center(node, slot)[i % 3] + step * leaf.corners.corner[i][k];
      const double rounding = base::relative_position_error * max_abs(exact);
      if (!(std::abs(stored - exact[i % 3]) <= largest_quantization_error * step + rounding))
        return broken(5, "corner of leaf", id);
    }
  }
  return {};
}

/// Checks the bounds of a slot against all triangles below it.
Result<void> check_bounds(const Tree& tree, SlotId id, MeshView mesh, std::uint32_t first, std::uint32_t last) {
  for (std::uint32_t leaf = first; leaf < last; ++leaf) {
    for (const TriangleId t : tree.leaves[leaf].triangle) {
      for (std::size_t k = 0; k < 3; ++k) {
        if (!contains(tree, id, mesh.triangle(t)[k])) return broken(4, "content of slot", id);
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

/// The first leaf below node `n`, or below what would follow the level's last node.
std::uint32_t first_leaf(const Tree& tree, std::uint32_t n, std::size_t level) {
  for (; level + 2 < tree.level_begin.size(); ++level) {
    if (n == tree.level_begin[level + 1]) return static_cast<std::uint32_t>(tree.leaves.size());
    n = tree.nodes[n].first_child;
  }
  return n == tree.nodes.size() ? static_cast<std::uint32_t>(tree.leaves.size()) : tree.nodes[n].first_child;
}

}  // namespace

Vec3 in_plane(const Vec3& n, double turn) {
  const double sign = std::copysign(1.0, n.z), a = -1 / (sign + n.z), b = n.x * n.y * a;
  const double sine = turn / double{max_quantized}, cosine = std::sqrt(1 - sine * sine);
  return Vec3{1 + sign * n.x * n.x * a, sign * b, -sign * n.x} * cosine + Vec3{b, sign + n.y * n.y * a, -n.y} * sine;
}

Result<void> validate(const Tree& tree, MeshView mesh) {
  if (auto valid = check_topology(tree, mesh.triangles.size()); !valid) return valid;
  if (auto valid = check_leaves(tree, mesh); !valid) return valid;
  for (std::size_t level = 0; level + 1 < tree.level_begin.size(); ++level) {
    const bool lowest = level + 2 == tree.level_begin.size();
    for (std::uint32_t n = tree.level_begin[level]; n < tree.level_begin[level + 1]; ++n) {
      const Node& node = tree.nodes[n];
      for (std::uint32_t slot = 0; slot < node.child_count; ++slot) {
        const std::uint32_t child = node.first_child + slot;
        const std::uint32_t first = lowest ? child : first_leaf(tree, child, level + 1);
        const std::uint32_t last = lowest ? child + 1 : first_leaf(tree, child + 1, level + 1);
        if (auto valid = check_bounds(tree, n * width + slot, mesh, first, last); !valid) return valid;
        const double farthest = length(local_slot_center(node, slot)) + static_cast<double>(node.bounds.radius[slot]);
        if (!(farthest <= static_cast<double>(node.radius))) return broken(6, "radius of node", n);
        if ((node.coincident_slots >> slot & 1) != 0 && !is_coincident(tree, mesh, first, last)) {
          return broken(7, "triangles of slot", n * width + slot);
        }
        if (!lowest) continue;
        if (auto valid = check_quantized(tree, node, slot, mesh); !valid) return valid;
      }
    }
  }
  return {};
}

}  // namespace limber::bvh

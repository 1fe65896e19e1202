// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "classic/tree.h"

namespace limber::classic {
namespace {

Error broken(int invariant, std::size_t node) {
  return {ErrorCode::broken_invariant,
          "invariant I" + std::to_string(invariant) + " broken at node " + std::to_string(node), node};
}

bool links_are_valid(const Tree& tree, std::uint32_t n) {
  const Node& node = tree.nodes[n];
  if (node.is_leaf()) return node.first_child == no_id;
  if (node.first_child <= n || std::size_t{node.first_child} + 1 >= tree.nodes.size()) return false;
  for (const std::uint32_t child : {node.first_child, node.first_child + 1}) {
    if (tree.nodes[child].parent != n || tree.nodes[child].depth != node.depth + 1) return false;
  }
  return true;
}

/// ceil(log2(count)): the depth of a binary tree whose groups are halved.
std::uint32_t balanced_depth(std::size_t count) { return static_cast<std::uint32_t>(std::bit_width(count - 1)); }

template <typename T>
std::size_t bytes_of(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

}  // namespace

Result<void> Model::validate() const {
  const base::DefaultFloatEnvironment environment;
  require_valid("validate");
  const Tree& tree = *tree_;
  const std::size_t count = tree.mesh.triangles().size();
  if (tree.nodes.size() != 2 * count - 1 || tree.nodes[root].parent != no_id) return broken(1, root);
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    if (!links_are_valid(tree, n)) return broken(2, n);
  }
  if (tree.leaf_of.size() != count) return broken(3, root);
  for (TriangleId t = 0; t < count; ++t) {
    if (tree.leaf_of[t] >= tree.nodes.size() || tree.nodes[tree.leaf_of[t]].triangle != t)
      return broken(3, tree.leaf_of[t]);
  }
  if (tree.nodes.back().depth != balanced_depth(count)) return broken(4, tree.nodes.size() - 1);
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    if (!sphere_holds(tree, tree.nodes[n])) return broken(tree.nodes[n].is_leaf() ? 5 : 6, n);
  }
  const bool any_queued =
      std::any_of(tree.is_queued.begin(), tree.is_queued.end(), [](auto flag) { return flag != 0; });
  if (!is_committed() || any_queued) return broken(7, root);
  return {};
}

TreeStats Model::tree_stats() const {
  require_valid("tree_stats");
  const Tree& tree = *tree_;
  std::size_t bytes = bytes_of(tree.nodes) + bytes_of(tree.leaf_of) + bytes_of(tree.first_triangle_at) +
                      bytes_of(tree.triangles_at) + bytes_of(tree.changed_triangles) + bytes_of(tree.is_changed) +
                      bytes_of(tree.queue_at_depth) + bytes_of(tree.is_queued);
  for (const auto& queue : tree.queue_at_depth) bytes += bytes_of(queue);
  return {tree.nodes.back().depth, tree.nodes.size(), bytes, tree.nodes[root].sphere.radius};
}

}  // namespace limber::classic

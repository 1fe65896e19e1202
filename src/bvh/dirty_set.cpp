// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/dirty_set.h"

#include <algorithm>
#include <array>
#include <new>

#include "core/check.h"

namespace limber::bvh {
namespace {

// A node refitted on its own costs about a third more than in a pass over all of them (bench/develop/motion_margin).
constexpr double worth_a_pass = 0.75;  // part of the lowest nodes

/// Calls visit(vertex, node) for every corner of every triangle, node by node.
template <typename Visit>
void for_each_corner(const Tree& tree, const Visit& visit) {
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    const WideNode& node = tree.nodes[n];
    for (std::uint32_t leaf = node.first_child; leaf < node.first_child + node.child_count; ++leaf) {
      for (const std::array<VertexId, 3>& triangle : tree.leaves[leaf].vertices) {
        for (const VertexId v : triangle) visit(v, n);
      }
    }
  }
}

}  // namespace

DirtySet::DirtySet(const Tree& tree) : state_(tree.nodes.size()), dirty_(tree.level_begin.size() - 1) {
  for (std::size_t level = 0; level < dirty_.size(); ++level) {
    dirty_[level].reserve(tree.level_begin[level + 1] - tree.level_begin[level]);
  }
  avoided_.reserve(dirty_.back().capacity());
}

void DirtySet::index_vertices(const Tree& tree, std::size_t vertex_count) {
  has_vertex_index_ = false;
  first_.assign(vertex_count + 1, 0);
  // Nodes come in order, so it is enough to remember the last node at each vertex.
  std::vector<std::uint32_t> last(vertex_count, no_id);
  for_each_corner(tree, [&](VertexId v, std::uint32_t node) {
    first_[v + 1] += last[v] != node ? 1 : 0;
    last[v] = node;
  });
  for (std::size_t v = 0; v < vertex_count; ++v) first_[v + 1] += first_[v];
  nodes_at_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  std::fill(last.begin(), last.end(), no_id);
  for_each_corner(tree, [&](VertexId v, std::uint32_t node) {
    if (last[v] != node) nodes_at_[next[v]++] = node;
    last[v] = node;
  });
  has_vertex_index_ = true;
}

bool DirtySet::try_index_vertices(const Tree& tree, std::size_t vertex_count) {
  if (has_vertex_index_) return true;
  try {
    index_vertices(tree, vertex_count);
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

bool DirtySet::covers_most_of(const Tree& tree) const {
  const std::size_t lowest = tree.nodes.size() - tree.first_lowest_node();
  return all_ || static_cast<double>(dirty_.back().size()) > worth_a_pass * static_cast<double>(lowest);
}

void DirtySet::add_leaves(const Tree& tree, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    const WideNode& node = tree.nodes[n];
    if (node.first_child < end && node.first_child + node.child_count > first) add_node(dirty_.size() - 1, n);
  }
}

void DirtySet::clear() {
  for (std::vector<std::uint32_t>& level : dirty_) {
    for (const std::uint32_t node : level) state_[node] = State::clean;
    level.clear();
  }
  for (const std::uint32_t node : avoided_) state_[node] = State::clean;
  avoided_.clear();
  all_ = false;
  LIMBER_ASSERT(empty());
}

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "bvh/tree.h"
#include "core/check.h"
#include "limber/mesh.h"

namespace limber::bvh {

/// The wide nodes whose bounds have to be refitted, because vertices below them have moved.
///
/// A vertex marks the nodes of the lowest level that have a triangle at it. The nodes above them are added while
/// refit() goes up, level by level. Each node is listed once. Beside them the set counts the nodes that motion would
/// have marked if it had not stayed within the motion margin: the refits that the margin has avoided.
///
/// States   A node of the lowest level is clean, avoided or dirty; it goes from clean to either and from avoided to
///          dirty, and clear() makes all clean. add_all() makes the whole tree dirty whatever the nodes are.
/// Throws   Only the constructor and index_vertices() allocate: every list has room for all nodes of its level.
class DirtySet {
 public:
  /// Cost     O(nodes).
  explicit DirtySet(const Tree& tree);

  /// Finds the nodes at each vertex, which add() and add_avoided() need.
  ///
  /// Cost     O(n), and about 10 bytes a vertex.
  /// Throws   std::bad_alloc; then has_vertex_index() is false, and nothing else has changed.
  void index_vertices(const Tree& tree, std::size_t vertex_count);
  bool has_vertex_index() const { return has_vertex_index_; }
  /// The same if there is no index yet. Returns whether there is one now: false where memory is missing for it.
  bool try_index_vertices(const Tree& tree, std::size_t vertex_count);
  /// To be called when triangles have been assigned to other leaves.
  void drop_vertex_index() { has_vertex_index_ = false; }

  bool empty() const { return !all_ && dirty_.back().empty(); }

  /// Marks the whole tree.
  void add_all() { all_ = true; }
  /// Marks the lowest nodes at a vertex. Pre: has_vertex_index().
  void add(VertexId vertex) {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) add_node(dirty_.size() - 1, nodes_at_[i]);
  }
  /// Marks the lowest nodes that have some of these leaves.
  void add_leaves(const Tree& tree, std::uint32_t first, std::uint32_t end);
  /// Marks a node of a level.
  void add_node(std::size_t level, std::uint32_t node) {
    if (state_[node] == State::dirty) return;
    state_[node] = State::dirty;
    append(dirty_[level], node);
  }

  /// Notes the lowest nodes at a vertex that need no refit. Pre: has_vertex_index().
  void add_avoided(VertexId vertex) {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      const std::uint32_t node = nodes_at_[i];
      if (state_[node] != State::clean) continue;
      state_[node] = State::avoided;
      append(avoided_, node);
    }
  }
  /// How many nodes have been noted so; some of them may have become dirty since.
  std::size_t avoided_count() const { return avoided_.size(); }

  /// Whether so much is dirty that it is cheaper to fit the whole tree.
  bool covers_most_of(const Tree& tree) const;

  /// The dirty nodes of a level.
  const std::vector<std::uint32_t>& nodes(std::size_t level) const { return dirty_[level]; }
  /// Sorts those of the lowest level into the order of memory.
  void sort_lowest() { std::sort(dirty_.back().begin(), dirty_.back().end()); }

  /// Makes all nodes clean. Cost: O(nodes that were not).
  void clear();

 private:
  enum class State : std::uint8_t { clean, dirty, avoided };

  static void append(std::vector<std::uint32_t>& list, std::uint32_t node) {
    LIMBER_ASSERT(list.size() < list.capacity());
    list.push_back(node);
  }

  bool has_vertex_index_ = false;                  // whether first_ and nodes_at_ are those of the tree
  std::vector<std::uint32_t> first_, nodes_at_;    // nodes at vertex v: nodes_at_[first_[v]] up to first_[v + 1]
  std::vector<State> state_;                       // by node
  std::vector<std::vector<std::uint32_t>> dirty_;  // by level
  std::vector<std::uint32_t> avoided_;
  bool all_ = false;
};

/// Refits the dirty nodes, and the nodes above them as long as bounds change; or the whole tree where that is cheaper.
/// Clears the set. Returns how many wide nodes were refitted.
///
/// Cost     O(nodes refitted); fit() at most.
std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty);

}  // namespace limber::bvh

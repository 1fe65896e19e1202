// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "base/check.h"
#include "bvh/tree.h"
#include "bvh/vertex_index.h"
#include "limber/mesh.h"

namespace limber::bvh {

/// The nodes whose bounds have to be refitted, because vertices below them have moved.
///
/// A vertex marks the nodes of the lowest level that have a triangle at it. The nodes above them are added while
/// refit() goes up, level by level. Each node is listed once.
///
/// States   A node is clean or dirty; clear() and being taken make it clean. add_all() makes the whole tree dirty
///          whatever the nodes are.
/// Throws   Only the constructor and the vertex index allocate: every list has room for all nodes of its level.
class DirtySet {
 public:
  /// Cost     O(nodes).
  explicit DirtySet(const Tree& tree);

  /// The nodes at each vertex, which add() needs. To be dropped when triangles have been assigned to other leaves.
  VertexIndex& vertex_index() { return index_; }
  bool has_vertex_index() const { return index_.is_complete(); }
  /// Builds the index if there is none yet. Returns whether there is one now: false if memory is missing for it.
  ///
  /// Cost     O(n) for the first call and the first after the index was dropped.
  bool try_index_vertices(const Tree& tree, std::size_t vertex_count);

  /// From now on add() and add_all() of this set are passed on to a follower: the set of a second tree of the same
  /// mesh, with a vertex index of its own. Null for none.
  void set_follower(DirtySet* follower) { follower_ = follower; }

  bool empty() const { return !all_ && dirty_.back().empty(); }

  /// Makes the whole tree dirty.
  void add_all() {
    all_ = true;
    if (follower_ != nullptr) follower_->add_all();
  }
  /// Marks the lowest nodes at a vertex. Pre: has_vertex_index().
  void add(VertexId vertex) {
    for (const std::uint32_t node : index_.nodes_at(vertex)) add_node(dirty_.size() - 1, node);
    if (follower_ != nullptr) follower_->follow(vertex);
  }
  /// Of a follower: how many of its lowest nodes have been marked through the other set since start_interval(), which
  /// every commit calls. Counts each node once, even if it was dirty already.
  std::size_t marked_count() const { return marked_; }
  void start_interval() { ++interval_, marked_ = 0; }
  /// Marks a node of a level.
  void add_node(std::size_t level, std::uint32_t node) {
    if (state_[node] == State::dirty) return;
    state_[node] = State::dirty;
    append(dirty_[level], node);
  }

  /// Whether so much is dirty that it is cheaper to fit the whole tree.
  bool covers_most_of(const Tree& tree) const;

  /// Moves the dirty nodes of the lowest level into a list, and makes them clean.
  ///
  /// Pre      The list is empty, and has room for all nodes of that level.
  void take_lowest(std::vector<std::uint32_t>& list);
  /// Takes a dirty node of a level away. Pre: there is one.
  std::uint32_t take_node(std::size_t level);

  /// The dirty nodes of a level.
  const std::vector<std::uint32_t>& nodes(std::size_t level) const { return dirty_[level]; }
  /// Sorts those of the lowest level into the order of memory.
  void sort_lowest() { std::sort(dirty_.back().begin(), dirty_.back().end()); }

  /// Makes all nodes clean. Cost: O(nodes that were not).
  void clear();

 private:
  enum class State : std::uint8_t { clean, dirty };

  void follow(VertexId vertex) {
    for (const std::uint32_t node : index_.nodes_at(vertex)) {
      add_node(dirty_.size() - 1, node);
      marked_ += marked_in_[node] != interval_ ? 1 : 0;
      marked_in_[node] = interval_;
    }
  }

  static void append(std::vector<std::uint32_t>& list, std::uint32_t node) {
    LIMBER_ASSERT(list.size() < list.capacity());
    list.push_back(node);
  }

  VertexIndex index_;
  std::vector<State> state_;                       // by node
  std::vector<std::vector<std::uint32_t>> dirty_;  // by level
  bool all_ = false;
  DirtySet* follower_ = nullptr;
  std::vector<std::uint64_t> marked_in_;  // the interval in which a node was last marked by the set that it follows
  std::uint64_t interval_ = 1;
  std::size_t marked_ = 0;
};

}  // namespace limber::bvh

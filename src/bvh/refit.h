// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/check.h"
#include "base/work_budget.h"
#include "bvh/tree.h"
#include "limber/mesh.h"

namespace limber::bvh {

/// The nodes of the lowest level that have a triangle at a vertex, for every vertex of a mesh. Built step by step.
///
/// States   Empty -> building: start(). Building -> complete: build() has returned true. Back to empty: drop().
class VertexIndex {
 public:
  /// Makes room for a mesh, whatever its triangles: afterwards nothing is allocated.
  ///
  /// Cost     O(vertices + triangles), touches the memory: 8 bytes a vertex and 12 bytes a triangle.
  /// Throws   std::bad_alloc.
  void reserve(std::size_t vertex_count, std::size_t triangle_count);

  /// Begins anew. Throws std::bad_alloc if there is no room for that many vertices; the index is then empty.
  ///
  /// Cost     O(1), but O(vertices) if there is no room yet.
  void start(std::size_t vertex_count);
  /// Goes on within a budget. Returns whether the index is complete.
  ///
  /// Pre      It has been started. The assignment of triangles to leaves is what it was then.
  /// Cost     O(triangles + vertices) altogether; allocates 4 to 8 bytes a vertex without reserve().
  /// Throws   std::bad_alloc; the index is then empty.
  bool build(const Tree& tree, base::WorkBudget& budget);
  void drop() { step_ = Step::empty; }

  bool is_complete() const { return step_ == Step::complete; }
  /// Pre: is_complete().
  std::span<const std::uint32_t> nodes_at(VertexId vertex) const {
    return {nodes_.data() + first_[vertex], nodes_.data() + first_[vertex + 1]};
  }

 private:
  enum class Step { empty, clearing, counting, adding_up, filling, complete };

  void clear_some(std::size_t end);
  void count(const Tree& tree, std::uint32_t node);
  void add_up_some(std::size_t end);
  void fill(const Tree& tree, std::uint32_t node);
  void go_on_with(Step step) { step_ = step, done_ = 0; }

  Step step_ = Step::empty;
  std::size_t done_ = 0;              // vertices or nodes of the present step
  std::vector<std::uint32_t> first_;  // nodes at vertex v: nodes_[first_[v]] up to first_[v + 1], once complete
  std::vector<std::uint32_t> last_;   // the last node seen at a vertex: each is listed once
  std::vector<std::uint32_t> nodes_;
};

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
    LIMBER_ASSERT(dirty_[level].size() < dirty_[level].capacity());
    dirty_[level].push_back(node);
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

  VertexIndex index_;
  std::vector<State> state_;                       // by node
  std::vector<std::vector<std::uint32_t>> dirty_;  // by level
  bool all_ = false;
  DirtySet* follower_ = nullptr;
  std::vector<std::uint64_t> marked_in_;  // the interval in which a node was last marked by the set that it follows
  std::uint64_t interval_ = 1;
  std::size_t marked_ = 0;
};

/// Costs of refits in a commit, in ns: of a dirty node, and of each node where the whole tree is fitted. Only ratios
/// matter, and those are much the same on all machines (docs/design/deforming.md).
inline constexpr double ns_per_refit = 330, ns_per_refit_in_pass = 225;

/// Costs of refits in a rebuild, in ns, which does them one by one, so that nothing is prefetched: of a node on the
/// lowest level, and of one above (docs/design/real_time.md).
inline constexpr double ns_per_lowest_node = 600, ns_per_upper_node = 200;

/// Refits the dirty nodes, and the nodes above them as long as bounds change; or fits the whole tree where that is
/// cheaper. Clears the set. Returns how many nodes were refitted. If oneTBB throws, what is left stays dirty.
///
/// Cost     O(nodes refitted); fit() at most.
std::uint64_t refit(Tree& tree, MeshView mesh, DirtySet& dirty);

/// The unit that a rebuild should write a tree in: the tree's own, or the one that suits its bounds where the ratio of
/// the two is above `unit_ratio_until_rebuild`.
///
/// Cost     O(1), from the bounds of the root slot.
double unit_for_rebuild(const Tree& tree);

/// Fits the slots of a node above the lowest level. Nodes on the lowest level are fitted, with their leaves, along with
/// their parent. So called for all nodes above that level, from the last to the first, this fits the whole tree.
///
/// Pre      The slots of children above the lowest level are fitted.
void fit_upper_node(Tree& tree, MeshView mesh, std::uint32_t node);

/// Refits one dirty node: on the lowest level its slots and leaves; on all levels the slot of the parent that bounds
/// the node. Returns whether the parent has become dirty; false for node 0, which has none.
///
/// Pre      Everything below the node is fitted; above the lowest level also the node's own slots, which its children
///          have set.
bool refit_node(Tree& tree, MeshView mesh, std::uint32_t node);

}  // namespace limber::bvh

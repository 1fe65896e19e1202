// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

}  // namespace limber::bvh

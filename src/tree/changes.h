// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/check.h"
#include "limber/mesh.h"
#include "tree/node.h"

namespace limber::tree {

/// Which blocks of a tree no longer fit their triangles.
///
/// A vertex names the blocks of the lowest level that have a triangle at it; they are listed once each. Blocks above
/// them are listed while they are repaired, level by level.
///
/// Throws   Only the constructor and find_vertices() allocate: every list has room for all blocks of its level.
class Changes {
 public:
  /// Cost     O(blocks).
  explicit Changes(const Tree& tree);

  /// Finds out where the triangles at each vertex are, which add() and spare() need.
  ///
  /// Cost     O(n), and about 10 bytes a vertex.
  /// Throws   std::bad_alloc; then knows_vertices() stays false, and nothing else has changed.
  void find_vertices(const Tree& tree, std::size_t vertex_count);
  bool knows_vertices() const { return knows_vertices_; }
  /// Once triangles lie elsewhere.
  void forget_vertices() { knows_vertices_ = false; }

  bool empty() const { return !all_ && changed_.back().empty(); }

  /// Every vertex has moved.
  void add_all() { all_ = true; }
  void add(VertexId vertex) {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) add_block(changed_.size() - 1, at_[i]);
  }

  /// Remembers the blocks of a vertex that is not repaired for.
  void spare(VertexId vertex) {
    for (std::uint32_t i = first_[vertex]; i < first_[vertex + 1]; ++i) {
      const std::uint32_t block = at_[i];
      if (is_changed_[block] != 0) continue;
      is_changed_[block] = 2;
      append(spared_, block);
    }
  }
  /// How many blocks of the lowest level that were, some of which may have been listed since.
  std::size_t spared_count() const { return spared_.size(); }

  /// Whether so much has changed that it is cheaper to fit everything.
  bool is_most_of(const Tree& tree) const;

  /// Blocks listed on a level, each once.
  const std::vector<std::uint32_t>& blocks(std::size_t level) const { return changed_[level]; }
  /// In the order of memory, which refit() goes by.
  void sort_lowest() { std::sort(changed_.back().begin(), changed_.back().end()); }
  void add_block(std::size_t level, std::uint32_t block) {
    if (is_changed_[block] == 1) return;
    is_changed_[block] = 1;
    append(changed_[level], block);
  }

  /// All blocks of the lowest level that have some of these leaves.
  void add_leaves(const Tree& tree, std::uint32_t first, std::uint32_t end);

  /// Nothing is listed any more. Cost: O(what was listed).
  void clear();

 private:
  static void append(std::vector<std::uint32_t>& list, std::uint32_t block) {
    LIMBER_ASSERT(list.size() < list.capacity());
    list.push_back(block);
  }

  bool knows_vertices_ = false;                      // whether first_ and at_ are those of the tree
  std::vector<std::uint32_t> first_, at_;            // blocks at vertex v: at_[first_[v]] up to first_[v + 1]
  std::vector<std::uint8_t> is_changed_;             // by block: 1 listed, 2 spared only
  std::vector<std::vector<std::uint32_t>> changed_;  // by level
  std::vector<std::uint32_t> spared_;
  bool all_ = false;
};

/// Recomputes the bounds of what has changed, and of what lies above it until nothing changes any more; every block
/// once, or everything where that is cheaper. Clears `changes`. Returns how many blocks were refitted.
///
/// Cost     O(blocks refitted); fit() at most.
std::uint64_t refit(Tree& tree, MeshView mesh, Changes& changes);

}  // namespace limber::tree

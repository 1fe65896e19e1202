// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "tree/changes.h"

#include <algorithm>
#include <array>

#include "core/check.h"

namespace limber::tree {
namespace {

/// Calls visit(vertex, block) for every corner of every triangle, block by block.
template <typename Visit>
void for_each_corner(const Tree& tree, const Visit& visit) {
  for (std::uint32_t b = tree.lowest_level(); b < tree.blocks.size(); ++b) {
    const Block& block = tree.blocks[b];
    for (std::uint32_t leaf = block.first_child; leaf < block.first_child + block.count; ++leaf) {
      for (const std::array<VertexId, 3>& triangle : tree.leaves[leaf].vertices) {
        for (const VertexId v : triangle) visit(v, b);
      }
    }
  }
}

}  // namespace

Changes::Changes(const Tree& tree) : is_changed_(tree.blocks.size()), changed_(tree.level_begin.size() - 1) {
  for (std::size_t level = 0; level < changed_.size(); ++level) {
    changed_[level].reserve(tree.level_begin[level + 1] - tree.level_begin[level]);
  }
  spared_.reserve(changed_.back().capacity());
}

void Changes::find_vertices(const Tree& tree, std::size_t vertex_count) {
  knows_vertices_ = false;
  first_.assign(vertex_count + 1, 0);
  // Blocks come in order, so a vertex that names a block again has just named it.
  std::vector<std::uint32_t> last(vertex_count, no_id);
  for_each_corner(tree, [&](VertexId v, std::uint32_t block) {
    first_[v + 1] += last[v] != block ? 1 : 0;
    last[v] = block;
  });
  for (std::size_t v = 0; v < vertex_count; ++v) first_[v + 1] += first_[v];
  at_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  std::fill(last.begin(), last.end(), no_id);
  for_each_corner(tree, [&](VertexId v, std::uint32_t block) {
    if (last[v] != block) at_[next[v]++] = block;
    last[v] = block;
  });
  knows_vertices_ = true;
}

bool Changes::is_most_of(const Tree& tree) const {
  // A block costs about a third more on its own than in a pass over all.
  const std::size_t lowest = tree.blocks.size() - tree.lowest_level();
  return all_ || 4 * changed_.back().size() > 3 * lowest;
}

void Changes::add_leaves(const Tree& tree, std::uint32_t first, std::uint32_t end) {
  for (std::uint32_t b = tree.lowest_level(); b < tree.blocks.size(); ++b) {
    const Block& block = tree.blocks[b];
    if (block.first_child < end && block.first_child + block.count > first) add_block(changed_.size() - 1, b);
  }
}

void Changes::clear() {
  for (std::vector<std::uint32_t>& level : changed_) {
    for (const std::uint32_t block : level) is_changed_[block] = 0;
    level.clear();
  }
  for (const std::uint32_t block : spared_) is_changed_[block] = 0;
  spared_.clear();
  all_ = false;
  LIMBER_ASSERT(empty());
}

}  // namespace limber::tree

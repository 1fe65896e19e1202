// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/dirty_set.h"

#include <algorithm>
#include <new>

#include "base/check.h"

namespace limber::bvh {
namespace {

// A node refitted on its own costs about a third more than in a pass over all of them (docs/design/deforming.md).
constexpr double worth_a_pass = 0.75;  // part of the lowest nodes

}  // namespace

DirtySet::DirtySet(const Tree& tree)
    : state_(tree.nodes.size()), dirty_(tree.level_begin.size() - 1), marked_in_(tree.nodes.size()) {
  // Touches the memory too.
  const auto make_room = [](std::vector<std::uint32_t>& list, std::size_t size) {
    list.resize(size);
    list.clear();
  };
  for (std::size_t level = 0; level < dirty_.size(); ++level) {
    make_room(dirty_[level], tree.level_begin[level + 1] - tree.level_begin[level]);
  }
}

bool DirtySet::try_index_vertices(const Tree& tree, std::size_t vertex_count) {
  if (has_vertex_index()) return true;
  try {
    index_.start(vertex_count);
    base::WorkBudget unlimited = base::WorkBudget::unlimited();
    return index_.build(tree, unlimited);
  } catch (const std::bad_alloc&) {
    return false;
  }
}

bool DirtySet::covers_most_of(const Tree& tree) const {
  const std::size_t lowest = tree.nodes.size() - tree.first_lowest_node();
  return all_ || static_cast<double>(dirty_.back().size()) > worth_a_pass * static_cast<double>(lowest);
}

void DirtySet::take_lowest(std::vector<std::uint32_t>& list) {
  LIMBER_ASSERT(list.empty() && list.capacity() >= dirty_.back().capacity());
  list.swap(dirty_.back());
  for (const std::uint32_t node : list) state_[node] = State::clean;
}

std::uint32_t DirtySet::take_node(std::size_t level) {
  LIMBER_ASSERT(!dirty_[level].empty());
  const std::uint32_t node = dirty_[level].back();
  dirty_[level].pop_back();
  state_[node] = State::clean;
  return node;
}

void DirtySet::clear() {
  for (std::vector<std::uint32_t>& level : dirty_) {
    for (const std::uint32_t node : level) state_[node] = State::clean;
    level.clear();
  }
  all_ = false;
  LIMBER_ASSERT(empty());
}

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/refit.h"

#include <algorithm>
#include <array>
#include <new>

#include "base/check.h"

namespace limber::bvh {
namespace {

// What a step costs, in ns (docs/design/real_time.md).
constexpr double ns_per_vertex = 2, ns_per_listed_node = 500;

// Vertices in one step.
constexpr std::size_t vertices_at_once = 1024;

/// Calls visit(vertex) for every corner of every triangle of a lowest node.
template <typename Visit>
void for_each_corner(const Tree& tree, std::uint32_t n, const Visit& visit) {
  const Node& node = tree.nodes[n];
  for (std::uint32_t leaf = node.first_child; leaf < node.first_child + node.child_count; ++leaf) {
    for (const std::array<VertexId, 3>& triangle : tree.leaves[leaf].vertices) {
      for (const VertexId v : triangle) visit(v);
    }
  }
}

}  // namespace

void VertexIndex::reserve(std::size_t vertex_count, std::size_t triangle_count) {
  first_.resize(vertex_count + 1);
  last_.resize(vertex_count);
  nodes_.resize(3 * triangle_count);
}

void VertexIndex::start(std::size_t vertex_count) {
  drop();
  first_.resize(vertex_count + 1);
  last_.resize(vertex_count);
  go_on_with(Step::clearing);
}

void VertexIndex::clear_some(std::size_t end) {
  std::fill(first_.begin() + static_cast<std::ptrdiff_t>(done_), first_.begin() + static_cast<std::ptrdiff_t>(end), 0);
  std::fill(last_.begin() + static_cast<std::ptrdiff_t>(done_), last_.begin() + static_cast<std::ptrdiff_t>(end),
            no_id);
}

void VertexIndex::count(const Tree& tree, std::uint32_t node) {
  for_each_corner(tree, node, [&](VertexId v) {
    first_[v] += last_[v] != node ? 1 : 0;
    last_[v] = node;
  });
}

void VertexIndex::add_up_some(std::size_t end) {
  std::uint32_t sum = done_ == 0 ? 0 : first_[done_ - 1];
  for (std::size_t v = done_; v < end; ++v) {
    first_[v] = sum += first_[v];
    last_[v] = no_id;
  }
}

void VertexIndex::fill(const Tree& tree, std::uint32_t node) {
  for_each_corner(tree, node, [&](VertexId v) {
    if (last_[v] != node) nodes_[--first_[v]] = node;
    last_[v] = node;
  });
}

bool VertexIndex::build(const Tree& tree, base::WorkBudget& budget) {
  LIMBER_ASSERT(step_ != Step::empty);
  const std::size_t vertex_count = last_.size(), node_count = tree.nodes.size() - tree.first_lowest_node();
  while (step_ != Step::complete && !budget.is_spent()) {
    const std::size_t end = std::min(done_ + vertices_at_once, vertex_count);
    const auto node = static_cast<std::uint32_t>(tree.first_lowest_node() + done_);
    switch (step_) {
      case Step::clearing:
      case Step::adding_up:
        step_ == Step::clearing ? clear_some(end) : add_up_some(end);
        budget.spend(ns_per_vertex * static_cast<double>(end - done_));
        done_ = end;
        if (done_ < vertex_count) break;
        if (step_ == Step::clearing) {
          go_on_with(Step::counting);
          break;
        }
        // From here on the entries go down from the ends of their lists to the beginnings.
        first_[vertex_count] = first_[vertex_count - 1];
        if (nodes_.size() < first_.back()) {
          step_ = Step::empty;  // in case there is no memory
          nodes_.resize(first_.back());
        }
        go_on_with(Step::filling);
        break;
      case Step::counting:
      case Step::filling:
        step_ == Step::counting ? count(tree, node) : fill(tree, node);
        budget.spend(ns_per_listed_node);
        if (++done_ == node_count) go_on_with(step_ == Step::counting ? Step::adding_up : Step::complete);
        break;
      case Step::empty:
      case Step::complete:
        break;
    }
  }
  return is_complete();
}

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/vertex_index.h"

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

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/rebuild.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/check.h"
#include "bvh/costs.h"
#include "bvh/refit.h"

namespace limber::bvh {
namespace {

// Splitting ends on fewer than 2^31 leaves, and leaves at most one range behind at each depth.
constexpr std::size_t max_ranges = 64;

// Ranges of up to that many triangles are partitioned in one step.
constexpr std::size_t small_range = 64;

// Triangles and leaves in one step.
constexpr std::size_t triangles_at_once = 128, leaves_at_once = 64;

// What a step costs, in ns (docs/design/real_time.md): to read a triangle's center; for each time that a triangle is in
// a range that is partitioned; to write a leaf; to take a dirty node.
constexpr double ns_per_center = 30, ns_per_triangle = 16, ns_per_leaf = 60, ns_per_taken_node = 2;

// While what has moved is refitted, a commit may spend this many times as long on it as refits of what it has moved
// itself take in the second tree. More than once, or the second tree would never catch up.
constexpr double refits_beside_budget = 2;

std::size_t lowest_level(const Tree& tree) { return tree.level_begin.size() - 2; }

double ns_of_children(const Tree& tree, std::uint32_t n) {
  const Node& node = tree.nodes[n];
  return node.child_count * (node.first_child >= tree.first_lowest_node() ? ns_per_lowest_node : ns_per_upper_node);
}

}  // namespace

void Rebuild::allocate(const Tree& tree, MeshView mesh) {
  primitives_.reserve(mesh.triangles.size());
  ranges_.reserve(max_ranges);
  if (dirty_) return;
  next_ = tree;
  round_.resize(tree.nodes.size() - tree.first_lowest_node());
  round_.clear();
  dirty_.emplace(tree);
}

void Rebuild::reserve(const Tree& tree, MeshView mesh) {
  allocate(tree, mesh);
  dirty_->vertex_index().reserve(mesh.positions.size(), mesh.triangles.size());
  primitives_.resize(mesh.triangles.size());
}

void Rebuild::start(const Tree& tree, MeshView mesh, const Subtree& subtree) {
  LIMBER_ASSERT(stage_ == Stage::idle && tree.leaves.size() > 1);
  allocate(tree, mesh);
  subtree_ = subtree;
  origin_ = slot_center(tree, subtree.slot), unit_ = tree.unit;
  primitives_.clear();
  ranges_.clear();
  split_.reset();
  stage_ = Stage::gathering, done_ = std::size_t{subtree.first_leaf} * width;
}

void Rebuild::stop() {
  stage_ = Stage::idle;
  round_.clear();
  if (dirty_) dirty_->clear();
}

void Rebuild::work(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  switch (stage_) {
    case Stage::gathering:
      return gather(tree, mesh, budget);
    case Stage::assigning:
      return assign(tree, mesh, budget);
    case Stage::fitting:
      return fit(tree, mesh, budget);
    case Stage::idle:
      return;
  }
}

void Rebuild::gather(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  const std::size_t end = std::min(std::size_t{subtree_.end_leaf} * width, mesh.triangles.size());
  const double half_per_unit = 0.5 / unit_;
  while (done_ < end) {
    if (budget.is_spent()) return;
    const std::size_t until = std::min(done_ + triangles_at_once, end);
    budget.spend(ns_per_center * static_cast<double>(until - done_));
    for (; done_ < until; ++done_) {
      const TriangleId triangle = tree.leaves[done_ / width].triangle[done_ % width];
      primitives_.push_back(primitive_of(mesh, triangle, origin_, half_per_unit));
    }
  }
  ranges_.push_back(build_range(0, primitives_.size()));
  stage_ = Stage::assigning, step_ = Step::partitioning;
}

void Rebuild::assign(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  while (!budget.is_spent()) {
    switch (step_) {
      case Step::partitioning:
        partition(budget);
        if (ranges_.empty()) step_ = Step::writing, done_ = 0;
        break;
      case Step::writing:
        write(tree, mesh, budget);
        if (done_ < next_.leaves.size()) break;
        dirty_->vertex_index().start(mesh.positions.size());
        step_ = Step::indexing;
        break;
      case Step::indexing:
        if (!dirty_->vertex_index().build(next_, budget)) break;
        stage_ = Stage::fitting, step_ = Step::assigned;
        return;
      default:
        LIMBER_ASSERT(false);
    }
  }
}

void Rebuild::partition(base::WorkBudget& budget) {
  while (!ranges_.empty() && !budget.is_spent()) {
    const BuildRange range = ranges_.back();
    const std::size_t size = range.end - range.begin;
    if (size <= small_range) {
      budget.spend(ns_per_triangle * static_cast<double>(size * std::bit_width(size / width)));
      partition_into_leaves(primitives_, range);
      ranges_.pop_back();
      continue;
    }
    if (!split_) split_.emplace(range);
    if (!split_->work(primitives_, budget)) return;
    ranges_.pop_back();
    for (const BuildRange& half : split_->halves()) {
      if (half.children <= 1) continue;
      LIMBER_ASSERT(ranges_.size() < ranges_.capacity());
      ranges_.push_back(half);
    }
    split_.reset();
  }
}

void Rebuild::write(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  while (done_ < next_.leaves.size() && !budget.is_spent()) {
    const std::size_t until = std::min(done_ + leaves_at_once, next_.leaves.size());
    budget.spend(ns_per_leaf * static_cast<double>(until - done_));
    for (; done_ < until; ++done_) {
      Leaf& leaf = next_.leaves[done_];
      if (subtree_.first_leaf <= done_ && done_ < subtree_.end_leaf) {
        write_leaf(leaf, mesh, primitives_of_leaf(primitives_, done_ - subtree_.first_leaf));
      } else {
        std::copy_n(tree.leaves[done_].triangle, width, leaf.triangle);
        std::copy_n(tree.leaves[done_].vertices, width, leaf.vertices);
      }
    }
  }
}

void Rebuild::start_sweep(const Tree& tree) {
  unit_before_ = tree.unit;
  next_.unit = better_unit(tree);
  dirty_->clear();
  round_.clear();
  step_ = Step::sweeping, done_ = next_.first_lowest_node();
}

void Rebuild::fit(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  if (step_ == Step::assigned || unit_before_ != tree.unit) start_sweep(tree);
  while (step_ == Step::sweeping) {
    if (budget.is_spent()) return;
    const auto node = static_cast<std::uint32_t>(--done_);
    budget.spend(ns_of_children(next_, node));
    fit_children(next_, mesh, node);
    if (done_ == 0) step_ = Step::refitting;
  }
  refit_some(mesh, budget);
}

void Rebuild::refit_some(MeshView mesh, base::WorkBudget& budget) {
  // Round by round: what becomes dirty again and again is refitted once in each, so a round ends.
  const std::size_t lowest = lowest_level(next_);
  std::size_t level = lowest;
  while (!budget.is_spent()) {
    std::uint32_t node = 0;
    if (!round_.empty()) {
      node = round_.back(), level = lowest;
      round_.pop_back();
    } else {
      while (level > 0 && (level == lowest || dirty_->nodes(level).empty())) --level;
      if (level == 0 && dirty_->nodes(0).empty()) {
        if (dirty_->nodes(lowest).empty()) return;
        dirty_->take_lowest(round_);
        budget.spend(ns_per_taken_node * static_cast<double>(round_.size()));
        continue;
      }
      node = dirty_->take_node(level);
    }
    budget.spend(level == lowest ? ns_per_lowest_node : ns_per_upper_node);
    if (refit_node(next_, mesh, node)) dirty_->add_node(level - 1, node_of(next_.nodes[node].parent));
  }
}

std::size_t Rebuild::dirty_count() const {
  std::size_t count = round_.size();
  for (std::size_t level = 0; level <= lowest_level(next_); ++level) count += dirty_->nodes(level).size();
  return count;
}

double Rebuild::ns_beside_budget() const {
  if (stage_ != Stage::fitting || step_ != Step::refitting) return 0;
  const double ns_per_path = ns_per_lowest_node + ns_per_upper_node * static_cast<double>(lowest_level(next_));
  return refits_beside_budget * ns_per_path * static_cast<double>(dirty_->marked_count());
}

bool Rebuild::can_take_over(const Tree& tree, const DirtySet& dirty, double ns) const {
  if (stage_ != Stage::fitting) return false;
  if (dirty.covers_most_of(tree)) return true;  // all has to be fitted anyway
  if (step_ != Step::refitting || unit_before_ != tree.unit) return false;
  const double due = ns_per_lowest_node * static_cast<double>(dirty_count());
  return due <= ns_per_lowest_node * static_cast<double>(dirty_->marked_count()) + ns;
}

void Rebuild::take_over(Tree& tree, DirtySet& dirty) {
  LIMBER_ASSERT(stage_ == Stage::fitting);
  dirty.set_follower(nullptr);
  if (step_ != Step::refitting || unit_before_ != tree.unit || dirty.covers_most_of(tree)) {
    dirty_->add_all();
    next_.unit = tree.unit;
  }
  for (const std::uint32_t node : round_) dirty_->add_node(lowest_level(next_), node);
  tree.exchange(next_);
  std::swap(dirty, *dirty_);
  stop();
}

}  // namespace limber::bvh

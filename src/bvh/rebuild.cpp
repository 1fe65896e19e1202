// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A rebuild partitions the triangles of one subtree anew while queries go on with the present tree, the first. The
// result is a second tree, which replaces the first in take_over(). Meanwhile moves make nodes of both dirty: the
// second tree's DirtySet follows the first's. The stages go in small steps of some microseconds, and a call may end
// after any:
//   gathering  reads the centers and the sides of the subtree's triangles. Later stages that a worker may do need no
//              positions.
//   assigning  partitions them, range by range; writes the leaves of the second tree; indexes its vertices.
//   fitting    sweeps over all nodes above the lowest level, from the last to the first, and fits the slots of each.
//              Then catches up: refits what has become dirty since, in rounds. A round refits the lowest nodes that are
//              dirty when it begins, and the nodes above. Goes on, commit by commit, until take_over().
#include "bvh/rebuild.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "base/check.h"
#include "bvh/refit.h"

namespace limber::bvh {
namespace {

// Room for ranges that wait to be partitioned. A level takes at most 3 splits, from 8 children to 4, 2 and 1, and there
// are at most 11 levels. Ranges are split depth first, so at most one waits at each of these 33 depths: 64 is ample.
constexpr std::size_t max_ranges = 64;

// Ranges of up to that many triangles are partitioned in one step.
constexpr std::size_t small_range = 64;

// Triangles and leaves in one step.
constexpr std::size_t triangles_at_once = 128, leaves_at_once = 64;

// Costs in ns (docs/design/real_time.md); that of a split is for each triangle in the range.
constexpr double ns_per_gathered_triangle = 30, ns_per_split_triangle = 22;
constexpr double ns_per_written_leaf = 60, ns_per_node_of_round = 2;

// While the second tree catches up, the moves of each commit mark some of its nodes. For each node that was marked the
// commit may exceed its budget by the time of this many refits. With 1 or less, nodes might be marked as fast as they
// are refitted.
constexpr double refits_per_marked_node = 2;

/// What fit_upper_node() takes, in ns.
double ns_of_fitting(const Tree& tree, std::uint32_t n) {
  const Node& node = tree.nodes[n];
  return node.child_count * (node.first_child >= tree.first_lowest_node() ? ns_per_lowest_node : ns_per_upper_node);
}

}  // namespace

/// Allocates what has not been allocated yet, except for the vertex index.
void Rebuild::allocate(const Tree& tree, MeshView mesh) {
  primitives_.reserve(mesh.triangles.size());
  half_sides_.resize(mesh.triangles.size());
  ranges_.reserve(max_ranges);
  if (second_dirty_) return;
  second_ = tree;
  round_.resize(tree.nodes.size() - tree.first_lowest_node());  // touches the memory, for reserve()
  round_.clear();
  second_dirty_.emplace(tree);
}

void Rebuild::reserve(const Tree& tree, MeshView mesh) {
  allocate(tree, mesh);
  second_dirty_->vertex_index().reserve(mesh.positions.size(), mesh.triangles.size());
  primitives_.resize(mesh.triangles.size());  // touches the memory
}

void Rebuild::start(const Tree& tree, MeshView mesh, const Subtree& subtree) {
  LIMBER_ASSERT(stage_ == Stage::idle && tree.leaves.size() > 1);
  allocate(tree, mesh);
  subtree_ = subtree;
  origin_ = slot_center(tree, subtree.slot), unit_ = tree.unit;
  primitives_.clear();
  ranges_.clear();
  split_.reset();
  stage_ = Stage::gathering;
  next_ = std::size_t{subtree.first_leaf} * width;
}

void Rebuild::stop() {
  stage_ = Stage::idle;
  round_.clear();
  if (second_dirty_) second_dirty_->clear();
}

void Rebuild::work(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  switch (stage_) {
    case Stage::gathering:
      return gather(tree, mesh, budget);
    case Stage::assigning:
      return assign(tree, mesh, budget);
    case Stage::fitting:
      return fit_bounds(tree, mesh, budget);
    case Stage::idle:
      return;
  }
}

void Rebuild::gather(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  // Copies of a triangle fill up only the last leaf of the tree: they come after all triangles.
  const std::size_t end = std::min(std::size_t{subtree_.end_leaf} * width, mesh.triangles.size());
  const PrimitiveSource source{mesh, origin_, 0.5 / unit_};
  while (next_ < end) {
    if (budget.is_spent()) return;
    const std::size_t until = std::min(next_ + triangles_at_once, end);
    budget.spend(ns_per_gathered_triangle * static_cast<double>(until - next_));
    for (; next_ < until; ++next_) {
      const TriangleId triangle = tree.leaves[next_ / width].triangle[next_ % width];
      primitives_.push_back(source.primitive_of(triangle, half_sides_[triangle]));
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
        if (!ranges_.empty()) break;
        step_ = Step::writing;
        next_ = 0;
        break;
      case Step::writing:
        write_leaves(tree, mesh, budget);
        if (next_ < second_.leaves.size()) break;
        second_dirty_->vertex_index().start(mesh.positions.size());
        step_ = Step::indexing;
        break;
      case Step::indexing:
        if (!second_dirty_->vertex_index().build(second_, budget)) break;
        stage_ = Stage::fitting, step_ = Step::before_sweep;
        return;
      default:  // steps of another stage
        LIMBER_ASSERT(false);
    }
  }
}

void Rebuild::partition(base::WorkBudget& budget) {
  while (!ranges_.empty() && !budget.is_spent()) {
    const BuildRange range = ranges_.back();
    const std::size_t size = range.end - range.begin;
    if (size <= small_range) {
      const auto most_splits = std::bit_width(size / width);  // that a triangle goes through
      budget.spend(ns_per_split_triangle * static_cast<double>(size * most_splits));
      partition_into_leaves(primitives_, range, half_sides_);
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

/// Writes the leaves of the subtree, and copies all others from the first tree: the second tree may still have the
/// leaves of an earlier rebuild.
void Rebuild::write_leaves(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  while (next_ < second_.leaves.size() && !budget.is_spent()) {
    const std::size_t until = std::min(next_ + leaves_at_once, second_.leaves.size());
    budget.spend(ns_per_written_leaf * static_cast<double>(until - next_));
    for (; next_ < until; ++next_) {
      Leaf& leaf = second_.leaves[next_];
      if (subtree_.first_leaf <= next_ && next_ < subtree_.end_leaf) {
        write_leaf(leaf, mesh, primitives_of_leaf(primitives_, next_ - subtree_.first_leaf));
      } else {
        std::copy_n(tree.leaves[next_].triangle, width, leaf.triangle);
        std::copy_n(tree.leaves[next_].vertices, width, leaf.vertices);
      }
    }
  }
}

/// Sweeps once, then catches up. Sweeps anew if a commit has given the first tree another unit since.
void Rebuild::fit_bounds(const Tree& tree, MeshView mesh, base::WorkBudget& budget) {
  if (step_ == Step::before_sweep || unit_before_sweep_ != tree.unit) {
    unit_before_sweep_ = tree.unit;
    second_.unit = unit_for_rebuild(tree);
    second_dirty_->clear();  // the sweep fits everything; what moves meanwhile becomes dirty again
    round_.clear();
    unswept_ = second_.first_lowest_node();
    step_ = Step::sweeping;
  }
  while (step_ == Step::sweeping) {
    if (budget.is_spent()) return;
    --unswept_;
    budget.spend(ns_of_fitting(second_, unswept_));
    fit_upper_node(second_, mesh, unswept_);
    if (unswept_ == 0) step_ = Step::catching_up;
  }
  catch_up(mesh, budget);
}

/// Refits the lowest nodes of the present round, then dirty nodes of the levels above, from below. Then begins the next
/// round, with all lowest nodes that are dirty by then; or returns if there are none. So a node that becomes dirty
/// again and again is refitted once a round, and every round ends.
void Rebuild::catch_up(MeshView mesh, base::WorkBudget& budget) {
  const std::size_t lowest = second_.lowest_level();
  while (!budget.is_spent()) {
    if (!round_.empty()) {
      budget.spend(ns_per_lowest_node);
      const std::uint32_t node = round_.back();
      round_.pop_back();
      refit_at(lowest, node, mesh);
    } else if (const std::optional<std::size_t> level = lowest_dirty_upper_level()) {
      budget.spend(ns_per_upper_node);
      refit_at(*level, second_dirty_->take_node(*level), mesh);
    } else if (!second_dirty_->nodes(lowest).empty()) {
      second_dirty_->take_lowest(round_);
      budget.spend(ns_per_node_of_round * static_cast<double>(round_.size()));
    } else {
      return;
    }
  }
}

std::optional<std::size_t> Rebuild::lowest_dirty_upper_level() const {
  for (std::size_t level = second_.lowest_level(); level-- > 0;) {
    if (!second_dirty_->nodes(level).empty()) return level;
  }
  return std::nullopt;
}

/// Refits a node of a level, and makes its parent dirty if that has to be refitted, too.
void Rebuild::refit_at(std::size_t level, std::uint32_t node, MeshView mesh) {
  if (refit_node(second_, mesh, node)) second_dirty_->add_node(level - 1, node_of(second_.nodes[node].parent));
}

std::size_t Rebuild::due_count() const {
  std::size_t count = round_.size();
  for (std::size_t level = 0; level <= second_.lowest_level(); ++level) count += second_dirty_->nodes(level).size();
  return count;
}

double Rebuild::ns_beyond_budget() const {
  if (stage_ != Stage::fitting || step_ != Step::catching_up) return 0;
  // Of a lowest node and all nodes above it.
  const double ns_per_path = ns_per_lowest_node + ns_per_upper_node * static_cast<double>(second_.lowest_level());
  return refits_per_marked_node * ns_per_path * static_cast<double>(second_dirty_->marked_count());
}

bool Rebuild::can_take_over(const Tree& tree, const DirtySet& dirty, double ns) const {
  if (stage_ != Stage::fitting) return false;
  if (dirty.covers_most_of(tree)) return true;  // all is refitted next anyway
  if (step_ != Step::catching_up || unit_before_sweep_ != tree.unit) return false;
  // Nodes of higher levels are cheaper than lowest ones, so ns_of_all is an upper bound.
  const double ns_of_all = ns_per_lowest_node * static_cast<double>(due_count());
  const double ns_of_this_commit = ns_per_lowest_node * static_cast<double>(second_dirty_->marked_count());
  // What earlier commits have left takes at most `ns`.
  return ns_of_all <= ns_of_this_commit + ns;
}

void Rebuild::take_over(Tree& tree, DirtySet& dirty) {
  LIMBER_ASSERT(stage_ == Stage::fitting);
  dirty.set_follower(nullptr);  // its follower is second_dirty_: after the swap below it would follow itself
  const bool is_fitted = step_ == Step::catching_up && unit_before_sweep_ == tree.unit;
  if (!is_fitted || dirty.covers_most_of(tree)) {
    second_dirty_->add_all();
    second_.unit = tree.unit;  // which suits the present positions: the whole tree is fitted next
  }
  for (const std::uint32_t node : round_) second_dirty_->add_node(second_.lowest_level(), node);
  tree.exchange(second_);
  std::swap(dirty, *second_dirty_);
  stop();  // also clears second_dirty_: the set of the old tree, which is second_ now and is not refitted any more
}

}  // namespace limber::bvh

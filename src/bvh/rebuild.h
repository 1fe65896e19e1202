// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/work_budget.h"
#include "bvh/partition.h"
#include "bvh/refit.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// Rebuilds a subtree of a tree step by step: assigns its triangles to its leaves as build() would. The topology of the
/// tree stays. All is written into a second tree, which in the end changes places with the first.
///
/// Based on  [Yoon2007]: only what has degraded is rebuilt.
/// Differs   The first tree does not change meanwhile, so queries and refits go on. Taking over costs as little as
///           swapping two vectors, and the vertex index is ready by then.
///
/// States   Idle -> gathering: start(). Gathering -> assigning -> fitting: work(). Fitting -> idle: take_over(). From
///          all states to idle: stop(). While fitting, the caller makes dirty() the follower of the first tree's
///          DirtySet, so that every move marks nodes of both trees; take_over() ends that.
/// Memory   As much as the tree, its vertex index and 16 bytes a triangle, kept from one rebuild to the next.
class Rebuild {
 public:
  enum class Stage {
    idle,
    gathering,  // the triangles' centers are read from the positions
    assigning,  // triangles are partitioned, leaves are written and vertices indexed, without the positions
    fitting,    // all bounds are fitted to the positions; then those are refitted that have moved meanwhile
  };

  /// Allocates and touches all memory, so that no later call allocates. Throws std::bad_alloc.
  void reserve(const Tree& tree, MeshView mesh);

  /// Throws std::bad_alloc; it is then idle. Allocates nothing after reserve(). Pre: it is idle.
  void start(const Tree& tree, MeshView mesh, const Subtree& subtree);
  void stop();

  Stage stage() const { return stage_; }
  const Subtree& subtree() const { return subtree_; }

  /// Goes on within a budget, until the present stage is done; while fitting, until nothing in the second tree is
  /// dirty. `mesh` has the present positions while gathering; while fitting, the positions that bounds are to contain,
  /// which differ from the present ones where a motion margin has absorbed moves.
  ///
  /// Threads  While assigning this may run beside changes of the positions and refits of `tree`: it reads ids alone.
  /// Throws   std::bad_alloc while assigning; it is then to be stopped.
  void work(const Tree& tree, MeshView mesh, base::WorkBudget& budget);

  /// The nodes of the second tree below which vertices have moved since they were fitted. Pre: it is fitting.
  DirtySet& dirty() { return *second_dirty_; }

  /// What a commit may add to its budget for work(), in ns: in proportion to the nodes of the second tree that its
  /// moves have marked. The second tree only catches up if commits refit more of its nodes than they mark.
  double ns_beyond_budget() const;

  /// Whether a commit may take over now. Its refit is then one of the second tree, not of `dirty` in `tree`. Yes if
  ///   - the commit has to fit a whole tree anyway: most of `tree` is dirty; or
  ///   - all bounds of the second tree were fitted once, and refitting its dirty nodes takes at most `ns` more than
  ///     refitting those that the moves of this commit have marked.
  bool can_take_over(const Tree& tree, const DirtySet& dirty, double ns) const;

  /// Swaps the second tree with `tree`, and its dirty nodes with `dirty`. The new `tree` has to be refitted next: some
  /// of its bounds, or all, may not be fitted yet. previous() is then the tree as it was.
  ///
  /// Pre      can_take_over().
  void take_over(Tree& tree, DirtySet& dirty);
  const Tree& previous() const { return second_; }

 private:
  // The first three are steps of Stage::assigning, the others of Stage::fitting.
  enum class Step { partitioning, writing, indexing, before_sweep, sweeping, catching_up };

  void allocate(const Tree& tree, MeshView mesh);
  // The stages.
  void gather(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void assign(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void fit_bounds(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  // Their steps.
  void partition(base::WorkBudget& budget);
  void write_leaves(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void catch_up(MeshView mesh, base::WorkBudget& budget);
  /// The lowest level above that of the lowest nodes that has a dirty node.
  std::optional<std::size_t> lowest_dirty_upper_level() const;
  void refit_at(std::size_t level, std::uint32_t node, MeshView mesh);
  /// How many nodes of the second tree are dirty, or left of the present round.
  std::size_t due_count() const;

  Stage stage_ = Stage::idle;
  Step step_ = Step::partitioning;
  Subtree subtree_{};
  std::size_t next_ = 0;  // the next triangle to gather, counted as 8 * leaf + slot; or the next leaf to write
  Vec3 origin_;           // of all primitives
  double unit_ = 1;       // of all primitives

  std::vector<PrimitiveRef> primitives_;
  std::vector<HalfSides> half_sides_;  // by triangle id; set for those of the subtree
  std::vector<BuildRange> ranges_;     // still to be partitioned
  std::optional<Split> split_;         // of the last of them

  Tree second_;                           // after take_over(): the tree as it was
  std::optional<DirtySet> second_dirty_;  // nullopt until allocate()
  double unit_before_sweep_ = 1;          // that the first tree had then; the second may get another one
  std::uint32_t unswept_ = 0;             // how many nodes, the first ones, the sweep has still to fit
  std::vector<std::uint32_t> round_;      // lowest nodes still to be refitted in the present round of catching up
};

/// How much a tree has degraded: the cost of its leaves now, compared with what it was when they were built. Found out
/// step by step, while the tree may change.
///
/// The cost of a leaf is its squared radius as a part of the root's, so motion that scales the whole model costs
/// nothing.
///
/// Based on  [Lauterbach2006]: bounds that have grown more than their model show that triangles have moved apart.
/// Throws    Only the constructor allocates.
class TreeCost {
 public:
  /// What it takes to look at a node of the lowest level, in ns (docs/design/real_time.md).
  static constexpr double ns_per_node = 15;

  /// Takes the present cost as the expected one. Cost: O(nodes).
  explicit TreeCost(const Tree& tree);

  /// The present cost of the leaves of a subtree together. Cost: O(nodes of the subtree).
  static double of(const Tree& tree, const Subtree& subtree);

  /// Begins to compare the present cost with the expected one.
  void start_survey(const Tree& tree);
  /// Goes on within a budget. Returns whether the survey is complete.
  bool survey(const Tree& tree, base::WorkBudget& budget);
  /// The subtree to be rebuilt if the tree, or a large part of it, costs more than `tolerated` times what is expected:
  /// the smallest one that has nearly all of the excess. Pre: the survey is complete.
  std::optional<Subtree> most_degraded(const Tree& tree, double tolerated) const;

  /// Begins to compare the cost of a subtree before and after it was rebuilt.
  void start_comparison(const Tree& before, const Tree& after, const Subtree& subtree);
  /// Goes on within a budget, and takes the cost afterwards as the expected one. Returns whether all is compared.
  bool compare(const Tree& before, const Tree& after, base::WorkBudget& budget);
  /// The cost before as a multiple of that after. Pre: all is compared.
  double gain() const { return cost_before_ / cost_after_; }

 private:
  std::vector<float> expected_;  // by node of the lowest level
  // The survey's sums over all lowest nodes before each one.
  std::vector<double> expected_sum_, excess_sum_;
  double root_radius_sq_ = 1;
  std::size_t surveyed_ = 0;
  // How far the comparison has come.
  double root_radius_sq_before_ = 1, cost_before_ = 0, cost_after_ = 0;
  std::uint32_t compared_ = 0, compare_end_ = 0;
};

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/work_budget.h"
#include "bvh/dirty_set.h"
#include "bvh/partition.h"
#include "bvh/subtree.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// Rebuilds a subtree of a tree step by step: assigns its triangles to its leaves as build() would. The topology of the
/// tree stays. All is written into a second tree, which in the end changes places with the first.
///
/// Based on  [Yoon2007]: only what has degraded is rebuilt.
/// Differs   The first tree does not change meanwhile, so queries and refits go on. Taking over costs as little as
///           swapping two vectors, and the vertex index is ready by then.
///
/// States   Idle -> gathering: start(). Gathering -> assigning -> fitting: work(), which says which stages need the
///          positions. From then on every move has to be marked in dirty(), which follows the first tree's DirtySet.
///          Fitting -> idle: take_over(). From all states to idle: stop().
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

  /// Goes on within a budget, until the present stage is done, or for as long as fitting makes sense. `mesh` has the
  /// present positions while gathering, and those to be fitted while fitting.
  ///
  /// Threads  While assigning this may run beside changes of the positions and refits of `tree`.
  /// Throws   std::bad_alloc while assigning; it is then to be stopped.
  void work(const Tree& tree, MeshView mesh, base::WorkBudget& budget);

  /// The nodes of the second tree below which vertices have moved since they were fitted. Pre: it is fitting.
  DirtySet& dirty() { return *second_dirty_; }

  /// By how much a commit may exceed its budget, in ns. Once all bounds of the second tree are fitted, every commit
  /// adds dirty nodes to it by its moves; the second tree only catches up if each refits more than it adds.
  double ns_beyond_budget() const;

  /// Whether the commit that asks may take over; it then refits what is dirty in the second tree instead of `dirty`,
  /// what is dirty in `tree`. Yes if that takes at most `ns` longer than refits of what its own moves have made dirty
  /// in the second tree, which are due sooner or later; and if the commit has to fit the whole tree, whichever it is.
  bool can_take_over(const Tree& tree, const DirtySet& dirty, double ns) const;

  /// Swaps the second tree and its dirty nodes with `tree` and `dirty`, which have to be refitted next: bounds of the
  /// second tree may not be fitted yet. previous() is then the tree as it was.
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
  /// How many nodes are dirty or still due in the present round.
  std::size_t due_count() const;

  Stage stage_ = Stage::idle;
  Step step_ = Step::partitioning;
  Subtree subtree_{};
  std::size_t next_ = 0;  // the next triangle to gather, counted as 8 * leaf + slot; or the next leaf to write
  Vec3 origin_;           // of all primitives
  double unit_ = 1;       // of all primitives

  std::vector<PrimitiveRef> primitives_;
  std::vector<BuildRange> ranges_;  // still to be partitioned
  std::optional<Split> split_;      // of the last of them

  Tree second_;                           // after take_over(): the tree as it was
  std::optional<DirtySet> second_dirty_;  // nullopt until allocate()
  double first_unit_ = 1;                 // of the first tree when the sweep began
  std::uint32_t unswept_ = 0;             // the nodes before this one have still to be fitted by the sweep
  std::vector<std::uint32_t> round_;      // lowest nodes to be refitted before any that become dirty meanwhile
};

}  // namespace limber::bvh

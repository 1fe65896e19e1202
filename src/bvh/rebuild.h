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

/// Rebuilds a subtree step by step: assigns its triangles to its leaves as build() would. The topology of the tree
/// stays. All is written into a second tree, which in the end changes places with the first.
///
/// Based on  [Yoon2007]: only what has degraded is rebuilt.
/// Differs   The tree does not change meanwhile, so queries and refits go on. Taking over costs as little as swapping
///           two vectors, and the vertex index is ready by then.
///
/// States   Idle -> gathering: start(). Gathering -> assigning -> fitting: work(), which says which steps need the
///          positions. Once it is fitting, every move has to be marked in dirty(). Fitting -> idle: take_over().
///          Back to idle from everywhere: stop().
/// Memory   As much as the tree, its vertex index and 16 bytes a triangle, kept from one rebuild to the next.
class Rebuild {
 public:
  enum class Stage {
    idle,
    gathering,  // the triangles' centers are read from the positions
    assigning,  // triangles are partitioned, leaves are written and vertices indexed, without the positions
    fitting,    // bounds are fitted to the positions
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

  /// What has moved since its bounds were fitted. Pre: it is fitting.
  DirtySet& dirty() { return *dirty_; }

  /// How long a commit may work beside its budget, in ns. Once all bounds were fitted, what has moved meanwhile is
  /// refitted; that ends only if more is refitted than what goes on moving makes dirty.
  double ns_beside_budget() const;

  /// Whether taking over takes no longer than the refits that the last moves need in the second tree, which later
  /// commits need anyway, and `ns`; or no time at all, because the whole tree is to be fitted.
  bool can_take_over(const Tree& tree, const DirtySet& dirty, double ns) const;

  /// Changes places with a tree and with what is dirty in it, which has to be refitted next. previous() then has the
  /// tree as it was.
  ///
  /// Pre      can_take_over().
  void take_over(Tree& tree, DirtySet& dirty);
  const Tree& previous() const { return next_; }

 private:
  // What is done while assigning, and while fitting.
  enum class Step { partitioning, writing, indexing, assigned, sweeping, refitting };

  void allocate(const Tree& tree, MeshView mesh);
  void gather(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void assign(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void partition(base::WorkBudget& budget);
  void write(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void fit(const Tree& tree, MeshView mesh, base::WorkBudget& budget);
  void start_sweep(const Tree& tree);
  void refit_some(MeshView mesh, base::WorkBudget& budget);
  /// The nodes that are dirty or due in the present round.
  std::size_t dirty_count() const;

  Stage stage_ = Stage::idle;
  Step step_ = Step::partitioning;
  Subtree subtree_{};
  std::size_t done_ = 0;  // triangles, leaves or nodes of the present step
  Vec3 origin_;           // of all primitives
  double unit_ = 1;

  std::vector<PrimitiveRef> primitives_;
  std::vector<BuildRange> ranges_;  // still to be partitioned
  std::optional<Split> split_;      // of the last of them

  double unit_before_ = 1;  // of the tree when the sweep began: in another one the bounds have to be fitted anew
  Tree next_;
  std::optional<DirtySet> dirty_;     // of next_
  std::vector<std::uint32_t> round_;  // lowest nodes that are refitted before any that become dirty meanwhile
};

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <optional>

#include "bvh/partial_rebuild.h"
#include "bvh/tree_cost.h"
#include "limber/model.h"

namespace limber::update {

/// Decides when a part of a tree has degraded enough to be rebuilt, and does that in commits or on a worker thread.
///
/// States   Idle -> rebuilding: schedule() has found a degraded subtree, or rebuild_all() was called.
///          Rebuilding -> rebuilt: advance() has finished, and has assigned the triangles to other leaves.
///          Rebuilt -> idle: judge(), once the bounds have been refitted.
///          While a worker runs, it alone touches the rebuild.
/// Throws   rebuild_all() throws std::bad_alloc and changes nothing; schedule() postpones what memory is missing for.
class RebuildScheduler {
 public:
  RebuildScheduler(const bvh::Tree& tree, RebuildPolicy policy, std::optional<double> budget_us);
  ~RebuildScheduler() { stop_worker(); }
  RebuildScheduler(const RebuildScheduler&) = delete;
  RebuildScheduler& operator=(const RebuildScheduler&) = delete;

  /// Partitions the triangles of the whole tree; the next advance() assigns them.
  void rebuild_all(const bvh::Tree& tree, const Mesh& mesh);

  /// Goes on with a rebuild, within the budget; `refit_ns` is what the refits of this commit are expected to take.
  /// Returns the subtree whose triangles have been assigned anew, once all are.
  std::optional<bvh::Subtree> advance(bvh::Tree& tree, const Mesh& mesh, double refit_ns);

  /// Compares the cost of the subtree that has been rebuilt with what it was. Pre: its bounds are refitted.
  void judge(const bvh::Tree& tree, MaintenanceStats& stats);

  /// Counts refits. Returns whether the cost of the tree is to be looked at: at the first call, and whenever as many
  /// nodes as the tree has were refitted since the last look.
  bool count_refits(const bvh::Tree& tree, std::uint64_t refits);

  /// Starts to rebuild what has degraded, if the policy says so. To be called once a pass.
  void schedule(const bvh::Tree& tree, const Mesh& mesh);

 private:
  void start_worker();
  /// What the worker does. Returns whether all is partitioned.
  bool work_until_stopped();
  void stop_worker();

  RebuildPolicy policy_;
  std::optional<double> budget_us_;
  bvh::TreeCost cost_;
  double passes_ = 0;              // since the whole tree was rebuilt
  double passes_until_check_ = 0;  // until the cost is looked at again
  double tolerated_;               // cost, as a multiple of the expected one
  double interval_;                // passes after which the whole tree is rebuilt whatever its cost
  double cost_before_ = 0;         // of the subtree that is rebuilt
  std::optional<bvh::PartialRebuild> rebuild_;
  std::atomic<bool> stops_worker_{false};
  std::future<bool> worker_;
};

}  // namespace limber::update

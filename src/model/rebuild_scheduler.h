// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <optional>

#include "bvh/rebuild.h"
#include "limber/model.h"

namespace limber::model {

/// Decides when a part of a tree has degraded enough to be rebuilt, and does that in commits or on a worker thread.
///
/// States   Idle -> surveying: once a pass, count_refits() begins to look at the cost of the tree.
///          Surveying -> rebuilding, if a subtree has degraded; otherwise back to idle.
///          Rebuilding -> comparing: advance() has put the rebuilt tree in the place of the old one.
///          Comparing -> idle: advance() has found out what that has gained. Surveys go on beside the last two, but
///          not from one tree to the other.
///          While a worker runs, it alone touches the rebuild.
/// Throws   reserve() throws std::bad_alloc and changes nothing; otherwise what memory is missing for is postponed.
class RebuildScheduler {
 public:
  RebuildScheduler(const bvh::Tree& tree, RebuildPolicy policy, std::optional<double> budget_us);
  ~RebuildScheduler() { stop_worker(); }
  RebuildScheduler(const RebuildScheduler&) = delete;
  RebuildScheduler& operator=(const RebuildScheduler&) = delete;

  /// Allocates all memory that rebuilds will need, if the policy allows any.
  void reserve(const bvh::Tree& tree, const Mesh& mesh);

  /// Goes on with a rebuild, within the budget; `own_ns` is what the commit is expected to take otherwise. Returns
  /// whether the rebuilt tree has taken the place of `tree`; what `dirty` then says has to be refitted next.
  bool advance(bvh::Tree& tree, const Mesh& mesh, MeshView fitted, bvh::DirtySet& dirty, double own_ns,
               MaintenanceStats& stats);

  /// Counts refits and surveys the tree, in proportion to them: from the first call on, and from whenever as many nodes
  /// as the tree has were refitted since the last survey began. Starts to rebuild what has degraded, if the policy says
  /// so. Returns whether a survey is complete.
  bool count_refits(const bvh::Tree& tree, const Mesh& mesh, std::uint64_t refits);

  /// Gives up what is under way: the tree has been built anew, and costs what `cost` says.
  void start_over(bvh::DirtySet& dirty, bvh::TreeCost cost);

 private:
  bool may_rebuild() const { return policy_ != RebuildPolicy::off && budget_us_ != 0; }
  void schedule(const bvh::Tree& tree, const Mesh& mesh);
  void go_on_comparing(const bvh::Tree& tree, base::WorkBudget& budget);
  void judge();
  bool go_on_rebuilding(bvh::Tree& tree, const Mesh& mesh, MeshView fitted, bvh::DirtySet& dirty,
                        base::WorkBudget& budget, double beside_ns);
  bool try_start_worker(const bvh::Tree& tree, const Mesh& mesh);
  /// Whether a worker is not finished yet. If there was one and it is, the rebuild is the caller's again.
  bool waits_for_worker();
  void stop_worker();

  RebuildPolicy policy_;
  std::optional<double> budget_us_;
  bvh::TreeCost cost_;
  bvh::Rebuild rebuild_;
  bool is_surveying_ = false;
  enum class Comparison { none, due, running } comparison_ = Comparison::none;
  double passes_ = 0;               // since the whole tree was rebuilt
  double passes_until_survey_ = 0;  // until the next one begins
  double tolerated_;                // cost, as a multiple of the expected one
  double interval_;                 // passes after which the whole tree is rebuilt whatever its cost
  double passes_before_ = 0;        // those between the last two rebuilds of the whole tree
  std::atomic<bool> stops_worker_{false}, worker_is_done_{false};
  std::future<void> worker_;
};

}  // namespace limber::model

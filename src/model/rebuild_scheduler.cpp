// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/rebuild_scheduler.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <system_error>
#include <utility>

#include "base/check.h"
#include "base/float_environment.h"
#include "bvh/refit.h"

namespace limber::model {
namespace {

// docs/design/deforming.md has the results of the experiment behind these numbers.

// How many times its expected cost a tree may have before it is rebuilt. Each rebuild that gains less than
// `worthwhile_gain` doubles the tolerated excess, up to `most_tolerated`.
constexpr double least_tolerated = 1.2, most_tolerated = 16, worthwhile_gain = 1.1;

// Passes over the tree after which it is rebuilt whatever its cost; afterwards as many as leave `wanted_gain` to gain.
constexpr double first_interval = 32, least_interval = 8, most_interval = 256, wanted_gain = 1.1;

// How much the interval may change at once.
constexpr double least_change = 0.4, most_change = 1.6, least_gain = 0.01;

// The automatic budget of a commit, as a multiple of what it takes otherwise.
constexpr double automatic_share = 5;

// A survey looks at that many nodes for each node that was refitted, so it takes a quarter of a pass.
constexpr double surveyed_per_refit = 4;

// What the worker does before it looks whether it has to stop.
constexpr double worker_slice_ns = 1e5;

}  // namespace

RebuildScheduler::RebuildScheduler(const bvh::Tree& tree, RebuildPolicy policy, std::optional<double> budget_us)
    : policy_(policy), budget_us_(budget_us), cost_(tree), tolerated_(least_tolerated), interval_(first_interval) {}

void RebuildScheduler::reserve(const bvh::Tree& tree, const Mesh& mesh) {
  if (may_rebuild()) rebuild_.reserve(tree, mesh);
}

bool RebuildScheduler::try_start_worker(const bvh::Tree& tree, const Mesh& mesh) {
  LIMBER_ASSERT(!worker_.valid());
  stops_worker_ = worker_is_done_ = false;
  const auto work = [this, &tree, view = mesh.view()] {
    const base::DefaultFloatEnvironment environment;
    try {
      while (!stops_worker_.load(std::memory_order_relaxed) && rebuild_.stage() == bvh::Rebuild::Stage::assigning) {
        base::WorkBudget slice(worker_slice_ns);
        rebuild_.work(tree, view, slice);
      }
    } catch (const std::bad_alloc&) {
      rebuild_.stop();
    }
    worker_is_done_.store(true, std::memory_order_release);
  };
  try {
    worker_ = std::async(std::launch::async, work);
  } catch (const std::system_error&) {  // no thread can be started
    return false;
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

bool RebuildScheduler::waits_for_worker() {
  if (!worker_.valid()) return false;
  if (!worker_is_done_.load(std::memory_order_acquire)) return true;
  worker_.get();
  return false;
}

void RebuildScheduler::stop_worker() {
  if (!worker_.valid()) return;
  stops_worker_ = true;
  worker_.get();
}

void RebuildScheduler::start_over(bvh::DirtySet& dirty, bvh::TreeCost cost) {
  stop_worker();
  rebuild_.stop();
  dirty.set_follower(nullptr);
  cost_ = std::move(cost);
  is_surveying_ = false;
  comparison_ = Comparison::none;
  passes_ = 0;
}

bool RebuildScheduler::advance(bvh::Tree& tree, const Mesh& mesh, MeshView fitted, bvh::DirtySet& dirty, double own_ns,
                               MaintenanceStats& stats) {
  base::WorkBudget budget(budget_us_ ? 1000 * *budget_us_ : automatic_share * own_ns);
  const double beside_ns = worker_.valid() ? 0 : rebuild_.ns_beyond_budget();
  budget.add(beside_ns);
  go_on_comparing(tree, budget);
  const bool has_taken_over =
      comparison_ == Comparison::none && go_on_rebuilding(tree, mesh, fitted, dirty, budget, beside_ns);
  stats.rebuild_us += budget.spent_ns() / 1000;
  if (!worker_.valid() && rebuild_.stage() == bvh::Rebuild::Stage::fitting) rebuild_.dirty().start_interval();
  if (!has_taken_over) return false;
  is_surveying_ = false;  // of the tree that was
  comparison_ = Comparison::due;
  const bvh::Subtree& subtree = rebuild_.subtree();
  stats.rebuilt_triangles += std::uint64_t{subtree.end_leaf - subtree.first_leaf} * bvh::width;
  if (subtree.slot == bvh::root_slot) passes_before_ = std::exchange(passes_, 0);
  return true;
}

/// Returns whether the rebuilt tree has taken the place of the other.
bool RebuildScheduler::go_on_rebuilding(bvh::Tree& tree, const Mesh& mesh, MeshView fitted, bvh::DirtySet& dirty,
                                        base::WorkBudget& budget, double beside_ns) {
  using Stage = bvh::Rebuild::Stage;
  while (!budget.is_spent() && !waits_for_worker() && rebuild_.stage() != Stage::idle) {
    if (rebuild_.can_take_over(tree, dirty, std::max(0.0, budget.left_ns() - beside_ns))) {
      rebuild_.take_over(tree, dirty);
      return true;
    }
    // Where no worker can be started, commits do its work.
    const bool is_for_worker = policy_ == RebuildPolicy::on_worker && rebuild_.stage() == Stage::assigning;
    if (is_for_worker && try_start_worker(tree, mesh)) return false;
    try {
      rebuild_.work(tree, rebuild_.stage() == Stage::fitting ? fitted : mesh.view(), budget);
    } catch (const std::bad_alloc&) {
      rebuild_.stop();
    }
    if (rebuild_.stage() == Stage::fitting) dirty.set_follower(&rebuild_.dirty());
  }
  return false;
}

/// Finds out what a rebuild has gained, once the bounds of the rebuilt tree are refitted.
void RebuildScheduler::go_on_comparing(const bvh::Tree& tree, base::WorkBudget& budget) {
  if (comparison_ == Comparison::due) {
    cost_.start_comparison(rebuild_.previous(), tree, rebuild_.subtree());
    comparison_ = Comparison::running;
  }
  if (comparison_ == Comparison::none || !cost_.compare(rebuild_.previous(), tree, budget)) return;
  comparison_ = Comparison::none;
  judge();
}

void RebuildScheduler::judge() {
  const double gain = cost_.gain();
  tolerated_ = gain > worthwhile_gain ? least_tolerated : std::min(1 + 2 * (tolerated_ - 1), most_tolerated);
  if (rebuild_.subtree().slot != bvh::root_slot || passes_before_ < least_interval) return;
  const double change = std::clamp((wanted_gain - 1) / std::max(gain - 1, least_gain), least_change, most_change);
  interval_ = std::clamp(change * passes_before_, least_interval, most_interval);
}

bool RebuildScheduler::count_refits(const bvh::Tree& tree, const Mesh& mesh, std::uint64_t refits) {
  const auto count = static_cast<double>(refits);
  const double passes = count / static_cast<double>(tree.nodes.size());
  passes_ += passes;
  passes_until_survey_ -= passes;
  if (!is_surveying_ && passes_until_survey_ <= 0) {
    cost_.start_survey(tree);
    is_surveying_ = true;
    passes_until_survey_ = 1;
  }
  if (!is_surveying_) return false;
  base::WorkBudget budget(bvh::TreeCost::ns_per_node * surveyed_per_refit * count);
  if (!cost_.survey(tree, budget)) return false;
  is_surveying_ = false;
  schedule(tree, mesh);
  return true;
}

void RebuildScheduler::schedule(const bvh::Tree& tree, const Mesh& mesh) {
  if (!may_rebuild() || tree.leaves.size() <= 1) return;
  if (worker_.valid() || comparison_ != Comparison::none || rebuild_.stage() != bvh::Rebuild::Stage::idle) return;
  const bool is_whole = passes_ >= interval_ || bvh::unit_for_rebuild(tree) != tree.unit;
  const std::optional<bvh::Subtree> degraded =
      is_whole ? bvh::subtree_of(tree, bvh::root_slot) : cost_.most_degraded(tree, tolerated_);
  if (!degraded) return;
  try {
    rebuild_.start(tree, mesh, *degraded);
  } catch (const std::bad_alloc&) {
    rebuild_.stop();  // tries again after another pass
  }
}

}  // namespace limber::model

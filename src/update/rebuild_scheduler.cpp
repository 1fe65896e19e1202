// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "update/rebuild_scheduler.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <system_error>
#include <utility>

#include "core/check.h"
#include "core/float_environment.h"

namespace limber::update {
namespace {

// The experiment behind these numbers is bench/develop/partial_rebuild.cpp; docs/design/deforming.md has its results.

// How many times its expected cost a tree may have before it is rebuilt. Each rebuild that gains less than
// `worthwhile_gain` doubles the tolerated excess, up to `most_tolerated`.
constexpr double least_tolerated = 1.2, most_tolerated = 16, worthwhile_gain = 1.1;

// Passes over the tree after which it is rebuilt whatever its cost; afterwards as many as leave `wanted_gain` to gain.
constexpr double first_interval = 32, least_interval = 8, most_interval = 256, wanted_gain = 1.1;

// How much the interval may change at once.
constexpr double least_change = 0.4, most_change = 1.6, least_gain = 0.01;

// The automatic budget of a commit, as a multiple of its refits; and the time a triangle takes in a split.
constexpr double automatic_share = 5, ns_per_triangle = 10;

// Triangles that the worker moves before it looks whether it has to stop.
constexpr double worker_slice = 0x1p16;

}  // namespace

RebuildScheduler::RebuildScheduler(const bvh::Tree& tree, RebuildPolicy policy, std::optional<double> budget_us)
    : policy_(policy), budget_us_(budget_us), cost_(tree), tolerated_(least_tolerated), interval_(first_interval) {}

void RebuildScheduler::rebuild_all(const bvh::Tree& tree, const Mesh& mesh) {
  bvh::PartialRebuild rebuild(tree, mesh, bvh::subtree_of(tree, bvh::root));
  rebuild.finish();
  stop_worker();
  rebuild_ = std::move(rebuild);
}

void RebuildScheduler::start_worker() {
  LIMBER_ASSERT(rebuild_ && !worker_.valid());
  stops_worker_ = false;
  bool has_started = false;
  try {
    worker_ = std::async(std::launch::async, [this] { return work_until_stopped(); });
    has_started = true;
  } catch (const std::system_error&) {  // no thread can be started
  } catch (const std::bad_alloc&) {
  }
  // Commits do the work instead; if they may not, a later commit tries to start a worker again.
  if (!has_started && budget_us_ == 0) rebuild_.reset();
}

bool RebuildScheduler::work_until_stopped() {
  const core::DefaultFloatEnvironment environment;
  while (!stops_worker_.load(std::memory_order_relaxed)) {
    if (rebuild_->work(worker_slice)) return true;
  }
  return false;
}

void RebuildScheduler::stop_worker() {
  if (!worker_.valid()) return;
  stops_worker_ = true;
  worker_.wait();
  worker_ = {};
}

std::optional<bvh::Subtree> RebuildScheduler::advance(bvh::Tree& tree, const Mesh& mesh, double refit_ns) {
  if (!rebuild_) return std::nullopt;
  if (worker_.valid()) {
    if (worker_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return std::nullopt;
    worker_.get();
  } else {
    const double ns = budget_us_ ? 1000 * *budget_us_ : automatic_share * refit_ns;
    if (!rebuild_->work(ns / ns_per_triangle)) return std::nullopt;
  }
  cost_before_ = bvh::TreeCost::of(tree, rebuild_->subtree());
  rebuild_->apply(tree, mesh);
  return rebuild_->subtree();
}

void RebuildScheduler::judge(const bvh::Tree& tree, MaintenanceStats& stats) {
  LIMBER_ASSERT(rebuild_);
  const bvh::Subtree subtree = rebuild_->subtree();
  const bool is_whole = subtree.slot == bvh::root;
  stats.rebuilt_triangles += std::uint64_t{subtree.end_leaf - subtree.first_leaf} * bvh::width;
  cost_.set_expected(tree, subtree);
  const double gain = cost_before_ / bvh::TreeCost::of(tree, subtree);
  tolerated_ = gain > worthwhile_gain ? least_tolerated : std::min(1 + 2 * (tolerated_ - 1), most_tolerated);
  if (is_whole && passes_ >= least_interval) {
    const double change = std::clamp((wanted_gain - 1) / std::max(gain - 1, least_gain), least_change, most_change);
    interval_ = std::clamp(change * passes_, least_interval, most_interval);
  }
  if (is_whole) passes_ = 0;
  rebuild_.reset();
}

bool RebuildScheduler::count_refits(const bvh::Tree& tree, std::uint64_t refits) {
  const double passes = static_cast<double>(refits) / static_cast<double>(tree.nodes.size());
  passes_ += passes;
  passes_until_check_ -= passes;
  if (passes_until_check_ > 0) return false;
  passes_until_check_ = 1;
  return true;
}

void RebuildScheduler::schedule(const bvh::Tree& tree, const Mesh& mesh) {
  if (policy_ == RebuildPolicy::off || rebuild_) return;
  if (policy_ == RebuildPolicy::in_commit && budget_us_ == 0) return;
  try {
    const std::optional<bvh::Subtree> degraded =
        passes_ >= interval_ ? bvh::subtree_of(tree, bvh::root) : cost_.most_degraded(tree, tolerated_);
    if (!degraded) return;
    rebuild_.emplace(tree, mesh, *degraded);
  } catch (const std::bad_alloc&) {
    return;  // tries again after another pass
  }
  if (policy_ == RebuildPolicy::on_worker) start_worker();
}

}  // namespace limber::update

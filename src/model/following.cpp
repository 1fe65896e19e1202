// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/following.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <new>
#include <system_error>
#include <utility>

#include "core/check.h"
#include "core/float_environment.h"
#include "simd/kernels.h"

namespace limber {
namespace {

// Covers the rounding of lengths and of sums of them.
constexpr double outward = 1 + 0x1p-40;

// What things cost, in ns: only the ratios matter, and those are much the same on all machines.
constexpr double ns_of_refit = 330, ns_of_refit_in_pass = 225, ns_of_step = 110, ns_of_sorting = 10;

// Vertices that have gone that many units may be where float32 does not reach in the unit of the tree.
constexpr double outgrown = 0x1p40;

// How much worse than expected a tree may become. More is tolerated where restructuring has gained little.
constexpr double least_tolerated = 1.2, most_tolerated = 16, worthwhile_gain = 1.1;

// Passes over the tree after which it is restructured whatever it looks like; then as many as leave so much to gain.
constexpr double first_interval = 32, least_interval = 8, most_interval = 256, wanted_gain = 1.1;

// What restructuring may cost when nothing else is said, as a multiple of the repairs of the same commit.
constexpr double restructuring_share = 5;

// Triangles that the worker looks at before it looks whether it is to stop.
constexpr double worker_slice = 0x1p16;

// Of the leaves' mean radius.
constexpr double worthwhile_part = 0.5;

// Squared displacements below this have lost digits, or have become 0.
constexpr double least_square = 0x1p-960;

/// At least the squared distance of two points; 0 only if they are equal.
double distance_sq_up(const Vec3& p, const Vec3& q) {
  const double d_sq = length_sq(p - q);
  return d_sq >= least_square || p == q ? d_sq : least_square;
}

}  // namespace

Following::Following(tree::Tree& tree, const Mesh& mesh, const ModelOptions& options)
    : tree_(tree),
      changes_(tree),
      chosen_slack_(options.slack),
      tuner_(most_worthwhile_slack()),
      restructuring_(options.restructuring),
      restructuring_us_(options.restructuring_us),
      quality_(tree),
      tolerated_(least_tolerated),
      interval_(first_interval) {
  if (this->slack() > 0) start_anchors(mesh);
}

Following::~Following() { stop_worker(); }

void Following::start_anchors(const Mesh& mesh) {
  anchors_ = mesh.positions();
  furthest_sq_ = 0;
  since_found_ = 0;
  tree_.paid = &paid_;
}

double Following::most_worthwhile_slack() const {
  double sum = 0;
  for (std::size_t b = tree_.lowest_level(); b < tree_.blocks.size(); ++b) {
    const tree::Block& block = tree_.blocks[b];
    for (std::uint32_t k = 0; k < block.count; ++k) sum += static_cast<double>(block.bounds.radius[k]);
  }
  return worthwhile_part * tree_.unit * sum / static_cast<double>(tree_.leaves.size());
}

double Following::slack() const { return is_tuned() ? tuner_.slack() : chosen_slack_; }

void Following::set_slack(const Mesh& mesh, double slack) {
  LIMBER_ASSERT(slack >= 0 || slack == ModelOptions::automatic);
  const bool starts_tuning = slack == ModelOptions::automatic && !is_tuned();
  const SlackTuner tuner = starts_tuning ? SlackTuner(most_worthwhile_slack()) : tuner_;
  // The only step that may fail comes first.
  if (anchors_.empty() && (slack == ModelOptions::automatic ? tuner.slack() : slack) > 0) start_anchors(mesh);
  tuner_ = tuner;
  if (starts_tuning) tuned_commits_ = 0;
  chosen_slack_ = slack;
  tightens_ = !anchors_.empty();
}

MeshView Following::anchored(const Mesh& mesh) const {
  return anchors_.empty() ? mesh.view() : MeshView{anchors_, mesh.triangles()};
}

void Following::anchor(const Mesh& mesh, VertexId vertex) {
  anchors_[vertex] = mesh.positions()[vertex];
  changes_.add(vertex);
  ++anchored_;
}

void Following::anchor_all(const Mesh& mesh) {
  changes_.add_all();
  if (anchors_.empty()) return;
  LIMBER_ASSERT(anchors_.size() == mesh.positions().size());
  std::copy(mesh.positions().begin(), mesh.positions().end(), anchors_.begin());
  furthest_sq_ = 0;
}

bool Following::finds_vertices(const Mesh& mesh) {
  if (changes_.knows_vertices()) return true;
  try {
    changes_.find_vertices(tree_, mesh.positions().size());
  } catch (const std::bad_alloc&) {
    return false;
  }
  return true;
}

void Following::note_step(double length_sq) {
  LIMBER_ASSERT(std::isfinite(length_sq));
  const double step = std::sqrt(std::max(length_sq, least_square));
  longest_step_ = std::max(longest_step_, step);
  all_steps_ = (all_steps_ + step) * (1 + 0x1p-50);
  has_moved_ = true;
}

void Following::list(const Mesh& mesh, std::span<const VertexId> ids) {
  // Where a good part of all vertices moves, finding out which blocks they are in costs more than fitting all.
  if (4 * ids.size() >= mesh.positions().size() || !finds_vertices(mesh)) return changes_.add_all();
  for (const VertexId id : ids) {
    if (changes_.is_most_of(tree_)) return changes_.add_all();
    changes_.add(id);
  }
}

void Following::absorb_or_anchor(const Mesh& mesh, VertexId vertex) {
  const double away_sq = distance_sq_up(mesh.positions()[vertex], anchors_[vertex]), most = slack();
  if (away_sq > most * most) return anchor(mesh, vertex);
  furthest_sq_ = std::max(furthest_sq_, away_sq);
  ++absorbed_;
  if (is_tuned() && counts_spared()) changes_.spare(vertex);
}

void Following::move(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions) {
  // From where they were before the batch, however often an id is in it.
  double furthest_sq = 0;
  constexpr std::size_t ahead = 32;  // is fetched
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + ahead < ids.size()) __builtin_prefetch(&mesh.positions()[ids[i + ahead]]);
    furthest_sq = std::max(furthest_sq, length_sq(positions[i] - mesh.positions()[ids[i]]));
  }
  mesh.set_positions(ids, positions);
  note_step(furthest_sq);
  if (anchors_.empty()) return list(mesh, ids);
  if (!finds_vertices(mesh)) {
    anchored_ += ids.size();
    return anchor_all(mesh);
  }
  for (const VertexId id : ids) absorb_or_anchor(mesh, id);
  since_found_ += ids.size();
}

void Following::move_all(Mesh& mesh, std::span<const Vec3> positions, double furthest_sq) {
  mesh.set_positions(positions);
  note_step(furthest_sq);
  if (anchors_.empty()) return changes_.add_all();
  absorbed_ += positions.size() - anchor_far(mesh);
  spares_all_ = true;
}

std::size_t Following::anchor_far(const Mesh& mesh) {
  const std::vector<Vec3>& positions = mesh.positions();
  const double most_sq = slack() * slack();
  since_found_ = 0;
  furthest_sq_ =
      simd::kernels().measure_motion(anchors_.data(), positions.data(), positions.size(), max_coordinate).furthest_sq;
  if (least_square <= furthest_sq_ && furthest_sq_ <= most_sq) return 0;
  furthest_sq_ = 0;
  std::size_t far_count = 0;
  for (VertexId v = 0; v < positions.size(); ++v) {
    const double away_sq = distance_sq_up(positions[v], anchors_[v]);
    if (away_sq <= most_sq) {
      furthest_sq_ = std::max(furthest_sq_, away_sq);
      continue;
    }
    ++far_count;
    if (finds_vertices(mesh)) {
      anchor(mesh, v);
    } else {
      ++anchored_;
      changes_.add_all();
    }
    if (!changes_.is_most_of(tree_)) continue;
    // Everything is fitted in one pass; all others come along for nothing.
    anchor_all(mesh);
    return positions.size();
  }
  return far_count;
}

void Following::measure_again(const Mesh& mesh) {
  tree_.unit = tree::extent_of(mesh).unit();
  anchor_all(mesh);
}

double Following::repairs_ahead_ns() const {
  const std::size_t all = tree_.blocks.size();
  if (changes_.is_most_of(tree_)) return ns_of_refit_in_pass * static_cast<double>(all);
  return ns_of_refit * static_cast<double>(changes_.blocks(tree_.level_begin.size() - 2).size());
}

void Following::restructure_all(const Mesh& mesh) {
  tree::Restructuring sorting(tree_, mesh, tree::subtree_of(tree_, tree::root));
  sorting.finish();
  stop_worker();
  sorting_ = std::move(sorting);
  has_moved_ = true;
}

void Following::start_worker() {
  LIMBER_ASSERT(sorting_ && !sorted_.valid());
  stops_worker_ = false;
  bool has_started = false;
  try {
    sorted_ = std::async(std::launch::async, [this] { return sort_until_stopped(); });
    has_started = true;
  } catch (const std::system_error&) {  // there is no thread
  } catch (const std::bad_alloc&) {
  }
  // Commits sort instead, unless they may not: then another commit tries again.
  if (!has_started && restructuring_us_ == 0) sorting_.reset();
}

bool Following::sort_until_stopped() {
  const core::DefaultFloatEnvironment environment;
  while (!stops_worker_.load(std::memory_order_relaxed)) {
    if (sorting_->work(worker_slice)) return true;
  }
  return false;
}

void Following::stop_worker() {
  if (!sorted_.valid()) return;
  stops_worker_ = true;
  sorted_.wait();
  sorted_ = {};
}

bool Following::restructure(const Mesh& mesh) {
  if (!sorting_) return false;
  if (sorted_.valid()) {
    if (sorted_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return false;
    sorted_.get();
  } else {
    const double ns = restructuring_us_ == ModelOptions::automatic ? restructuring_share * repairs_ahead_ns()
                                                                   : 1000 * restructuring_us_;
    if (!sorting_->work(ns / ns_of_sorting)) return false;
  }
  const tree::Subtree& subtree = sorting_->subtree();
  before_ = tree::Quality::sum(tree_, subtree);
  sorting_->apply(tree_, mesh);
  changes_.forget_vertices();
  if (subtree.node == tree::root) {
    anchor_all(mesh);
  } else {
    changes_.add_leaves(tree_, subtree.first_leaf, subtree.end_leaf);
  }
  return true;
}

void Following::judge_restructuring(MaintenanceStats& stats) {
  const tree::Subtree subtree = sorting_->subtree();
  stats.restructured += std::uint64_t{subtree.end_leaf - subtree.first_leaf} * tree::width;
  quality_.set(tree_, subtree);
  const double gain = before_ / tree::Quality::sum(tree_, subtree);
  tolerated_ = gain > worthwhile_gain ? least_tolerated : std::min(1 + 2 * (tolerated_ - 1), most_tolerated);
  if (subtree.node == tree::root && passes_ >= least_interval) {
    const double change = std::clamp((wanted_gain - 1) / std::max(gain - 1, 0.01), 0.4, 1.6);
    interval_ = std::clamp(change * passes_, least_interval, most_interval);
  }
  if (subtree.node == tree::root) passes_ = 0;
  sorting_.reset();
}

bool Following::ends_pass(std::uint64_t refits) {
  const double passes = static_cast<double>(refits) / static_cast<double>(tree_.blocks.size());
  passes_ += passes;
  passes_to_look_ -= passes;
  if (passes_to_look_ > 0) return false;
  passes_to_look_ = 1;
  return true;
}

void Following::look_at_quality(const Mesh& mesh) {
  if (restructuring_ == Restructuring::off || sorting_) return;
  if (restructuring_ == Restructuring::in_commits && restructuring_us_ == 0) return;
  try {
    const std::optional<tree::Subtree> worst =
        passes_ >= interval_ ? tree::subtree_of(tree_, tree::root) : quality_.worst(tree_, tolerated_);
    if (!worst) return;
    sorting_.emplace(tree_, mesh, *worst);
  } catch (const std::bad_alloc&) {
    return;  // looks again after another pass
  }
  if (restructuring_ == Restructuring::on_worker) start_worker();
}

void Following::commit(const Mesh& mesh, MaintenanceStats& stats) {
  if (!has_moved_ && !tightens_) return;
  has_moved_ = true;  // until all is done
  if (tightens_ || (!anchors_.empty() && since_found_ > mesh.positions().size())) anchor_far(mesh);
  tightens_ = false;
  // Bounds may follow a vertex by as much as it has moved, and as it was away from where they were fitted.
  if (all_steps_ + tree_.slack > outgrown * tree_.unit) measure_again(mesh);
  const bool has_restructured = restructure(mesh);
  const bool in_pass = changes_.is_most_of(tree_);
  const std::size_t spared = changes_.spared_count();
  const std::uint64_t refits = tree::refit(tree_, anchored(mesh), changes_);
  if (has_restructured) judge_restructuring(stats);
  const bool ends_pass = this->ends_pass(refits);
  if (ends_pass) look_at_quality(mesh);
  tree_.motion = (tree_.motion + all_steps_) * outward;
  stats.refits += refits;
  stats.absorbed += absorbed_;
  double paid = 0;
  if (!anchors_.empty()) {
    tree_.slack = std::sqrt(furthest_sq_) * outward;
    paid = static_cast<double>(paid_.exchange(0, std::memory_order_relaxed)) * tree::part_of_step;
    stats.extra_steps += paid;
  }
  if (slack() == 0 && !anchors_.empty()) {
    // All have been caught up with.
    anchors_.clear();
    tree_.paid = nullptr;
  }
  if (is_tuned()) {
    const double before = tuner_.slack();
    const double pass = ns_of_refit_in_pass * static_cast<double>(tree_.blocks.size());
    const double repairs = in_pass ? pass : ns_of_refit * static_cast<double>(refits);
    std::optional<double> tight;
    if (spares_all_) tight = pass;
    if (!spares_all_ && counts_spared()) tight = std::min(pass, repairs + ns_of_refit * static_cast<double>(spared));
    tuner_.add({repairs, tight, paid * ns_of_step, longest_step_, !anchors_.empty() && anchored_ == 0});
    ++tuned_commits_;
    if (ends_pass) tuner_.set_most(most_worthwhile_slack());
    tightens_ = tuner_.slack() < before;
    if (anchors_.empty() && tuner_.slack() > 0) {
      try {
        start_anchors(mesh);
      } catch (const std::bad_alloc&) {
        LIMBER_ASSERT(anchors_.empty());  // another commit tries again; until then there is no slack
      }
    }
  }
  LIMBER_ASSERT(!anchors_.empty() || tree_.slack == 0);
  has_moved_ = spares_all_ = false;
  longest_step_ = all_steps_ = 0;
  absorbed_ = anchored_ = 0;
}

}  // namespace limber

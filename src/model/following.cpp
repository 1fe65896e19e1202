// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/following.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/check.h"
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

// Of the leaves' mean radius.
constexpr double worthwhile_part = 0.5;

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
  if (slack == ModelOptions::automatic && !is_tuned()) {
    tuner_ = SlackTuner(most_worthwhile_slack());
    tuned_commits_ = 0;
  }
  chosen_slack_ = slack;
  if (anchors_.empty() && this->slack() > 0) start_anchors(mesh);
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

void Following::note_step(double length_sq) {
  LIMBER_ASSERT(std::isfinite(length_sq));
  const double step = std::sqrt(length_sq);
  longest_step_ = std::max(longest_step_, step);
  all_steps_ = (all_steps_ + step) * (1 + 0x1p-50);
  has_moved_ = true;
}

void Following::list(const Mesh& mesh, std::span<const VertexId> ids) {
  // Where a good part of all vertices moves, finding out which blocks they are in costs more than fitting all.
  if (4 * ids.size() >= mesh.positions().size()) return changes_.add_all();
  if (!changes_.knows_vertices()) changes_.find_vertices(tree_, mesh.positions().size());
  for (const VertexId id : ids) {
    if (changes_.is_most_of(tree_)) return changes_.add_all();
    changes_.add(id);
  }
}

void Following::absorb_or_anchor(const Mesh& mesh, VertexId vertex) {
  const double away_sq = length_sq(mesh.positions()[vertex] - anchors_[vertex]), most = slack();
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
  if (!changes_.knows_vertices()) changes_.find_vertices(tree_, mesh.positions().size());
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
  far_.clear();
  since_found_ = 0;
  furthest_sq_ =
      simd::kernels().measure_motion(anchors_.data(), positions.data(), positions.size(), max_coordinate).furthest_sq;
  if (furthest_sq_ <= most_sq) return 0;
  furthest_sq_ = 0;
  for (VertexId v = 0; v < positions.size(); ++v) {
    const double away_sq = length_sq(positions[v] - anchors_[v]);
    if (away_sq > most_sq) {
      far_.push_back(v);
    } else {
      furthest_sq_ = std::max(furthest_sq_, away_sq);
    }
  }
  if (!far_.empty() && !changes_.knows_vertices()) changes_.find_vertices(tree_, mesh.positions().size());
  for (const VertexId v : far_) {
    anchor(mesh, v);
    if (changes_.is_most_of(tree_)) {
      // Everything is fitted in one pass; all others come along for nothing.
      anchors_ = positions;
      changes_.add_all();
      furthest_sq_ = 0;
      return positions.size();
    }
  }
  return far_.size();
}

void Following::measure_again(const Mesh& mesh) {
  tree_.unit = tree::extent_of(mesh).unit();
  changes_.add_all();
  if (!anchors_.empty()) anchors_ = mesh.positions(), furthest_sq_ = 0;
}

double Following::repairs_ahead_ns() const {
  const std::size_t all = tree_.blocks.size();
  if (changes_.is_most_of(tree_)) return ns_of_refit_in_pass * static_cast<double>(all);
  return ns_of_refit * static_cast<double>(changes_.blocks(tree_.level_begin.size() - 2).size());
}

void Following::restructure_all(const Mesh& mesh) {
  if (sorted_.valid()) sorted_.get();
  sorting_.emplace(tree_, mesh, tree::subtree_of(tree_, tree::root));
  sorting_->finish();
  has_moved_ = true;
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
    changes_.add_all();
    if (!anchors_.empty()) anchors_ = mesh.positions(), furthest_sq_ = 0;
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
  const std::optional<tree::Subtree> worst =
      passes_ >= interval_ ? tree::subtree_of(tree_, tree::root) : quality_.worst(tree_, tolerated_);
  if (!worst) return;
  sorting_.emplace(tree_, mesh, *worst);
  if (restructuring_ == Restructuring::on_worker) {
    sorted_ =
        std::async(std::launch::async, [this] { return sorting_->work(std::numeric_limits<double>::infinity()); });
  }
}

void Following::commit(const Mesh& mesh, MaintenanceStats& stats) {
  if (!has_moved_ && !tightens_) return;
  if (tightens_ || (!anchors_.empty() && since_found_ > mesh.positions().size())) anchor_far(mesh);
  tightens_ = false;
  if (all_steps_ > outgrown * tree_.unit) measure_again(mesh);
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
    if (anchors_.empty() && tuner_.slack() > 0) start_anchors(mesh);
  }
  LIMBER_ASSERT(!anchors_.empty() || tree_.slack == 0);
  has_moved_ = spares_all_ = false;
  longest_step_ = all_steps_ = 0;
  absorbed_ = anchored_ = 0;
}

}  // namespace limber

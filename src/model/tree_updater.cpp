// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/tree_updater.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/costs.h"
#include "bvh/partition.h"
#include "bvh/refit.h"
#include "mesh/updates.h"

namespace limber::model {
namespace {

using bvh::ns_per_refit, bvh::ns_per_refit_in_pass, bvh::ns_per_step;

// Vertices that have moved that many units may be where float32 has no numbers in the unit of the tree.
constexpr double outgrown = 0x1p40;

// What a move costs beside refits, in ns.
constexpr double ns_per_move = 10;

// A margin above this part of the mean radius of the leaves makes queries more expensive than the refits it avoids.
constexpr double useful_part_of_radius = 0.5;

// A batch that names at least 1 / this of the vertices is cheaper to treat as one that moves all.
constexpr std::size_t vertices_per_id_for_all = 4;

// Avoided refits are counted in one commit of these: counting costs as much as a tenth of a refit.
constexpr std::uint64_t counted_commits = 4;

}  // namespace

TreeUpdater::TreeUpdater(bvh::Tree& tree, const Mesh& mesh, const ModelOptions& options)
    : tree_(tree),
      dirty_(tree),
      tuner_(useful_part_of_radius * bvh::TreeCost::mean_leaf_radius(tree)),
      rebuilds_(tree, options.rebuild_policy, options.rebuild_budget_us),
      chosen_margin_(options.motion_margin) {
  if (motion_margin() > 0) start_margin(mesh);
  if (!options.preallocate) return;
  bvh::VertexIndex& index = dirty_.vertex_index();
  index.reserve(mesh.positions().size(), mesh.triangles().size());
  dirty_.try_index_vertices(tree, mesh.positions().size());
  rebuilds_.reserve(tree, mesh);
  if (is_automatic()) margin_.reserve(mesh.positions().size());
}

void TreeUpdater::start_margin(const Mesh& mesh) {
  margin_.start(mesh.positions());
  ++whole_passes_;
  tree_.margin_cost = &margin_cost_;
}

bool TreeUpdater::counts_avoided() const { return is_automatic() && tuned_commits_ % counted_commits == 0; }

void TreeUpdater::set_motion_margin(const Mesh& mesh, std::optional<double> margin) {
  LIMBER_ASSERT(!margin || *margin >= 0);
  const bool starts_tuning = !margin && !is_automatic();
  const MarginTuner tuner =
      starts_tuning ? MarginTuner(useful_part_of_radius * bvh::TreeCost::mean_leaf_radius(tree_)) : tuner_;
  // The only step that may fail comes first.
  if (!margin_.is_on() && margin.value_or(tuner.margin()) > 0) start_margin(mesh);
  tuner_ = tuner;
  if (starts_tuning) tuned_commits_ = 0;
  chosen_margin_ = margin;
  must_check_all_ = margin_.is_on();
}

void TreeUpdater::note_displacement(double length_sq) {
  LIMBER_ASSERT(std::isfinite(length_sq));
  longest_displacement_ = std::max(longest_displacement_, std::sqrt(length_sq));
  // The square of a tiny displacement may vanish.
  const double at_least = std::sqrt(std::max(length_sq, smallest_square));
  sum_of_displacements_ = (sum_of_displacements_ + at_least) * base::sum_up;
  has_moved_ = true;
}

bool TreeUpdater::has_vertex_index(const Mesh& mesh) {
  if (dirty_.has_vertex_index()) return true;
  ++whole_passes_;
  return dirty_.try_index_vertices(tree_, mesh.positions().size());
}

void TreeUpdater::mark(const Mesh& mesh, std::span<const VertexId> ids) {
  if (vertices_per_id_for_all * ids.size() >= mesh.positions().size() || !has_vertex_index(mesh)) {
    return dirty_.add_all();
  }
  for (const VertexId id : ids) {
    if (dirty_.covers_most_of(tree_)) return dirty_.add_all();
    dirty_.add(id);
  }
}

void TreeUpdater::move(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions) {
  // Measured from the positions before the batch, however often an id is in it.
  double farthest_sq = 0;
  constexpr std::size_t prefetched = 32;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + prefetched < ids.size()) __builtin_prefetch(&mesh.positions()[ids[i + prefetched]]);
    farthest_sq = std::max(farthest_sq, length_sq(positions[i] - mesh.positions()[ids[i]]));
  }
  MeshWriter::set_positions(mesh, ids, positions);
  note_displacement(farthest_sq);
  moves_ += ids.size();
  if (!margin_.is_on()) return mark(mesh, ids);
  if (!has_vertex_index(mesh)) {
    margin_.count_refitted(ids.size());
    return margin_.refit_all(mesh, dirty_);
  }
  margin_.absorb(mesh, ids, motion_margin(), dirty_, counts_avoided());
}

void TreeUpdater::move_all(Mesh& mesh, std::span<const Vec3> positions, double farthest_sq) {
  MeshWriter::set_positions(mesh, positions);
  note_displacement(farthest_sq);
  moves_ += positions.size();
  if (!margin_.is_on()) return dirty_.add_all();
  ++whole_passes_;
  margin_.count_absorbed(positions.size() - margin_.absorb_all(mesh, motion_margin(), tree_, dirty_));
  moved_all_ = true;
}

void TreeUpdater::rebuild_all(const Mesh& mesh) {
  bvh::Tree built = bvh::build(mesh);
  bvh::TreeCost cost(built);
  // From here on nothing fails.
  rebuilds_.start_over(dirty_, std::move(cost));
  tree_.exchange(built);
  const bool had_index = dirty_.has_vertex_index();
  dirty_.vertex_index().drop();
  if (had_index) dirty_.try_index_vertices(tree_, mesh.positions().size());
  margin_.refit_all(mesh, dirty_);
  has_moved_ = true;
}

/// What a commit is expected to take but for rebuilding.
double TreeUpdater::expected_ns() const {
  const double ns_of_moves = ns_per_move * static_cast<double>(moves_);
  if (dirty_.covers_most_of(tree_)) {
    return ns_of_moves + ns_per_refit_in_pass * static_cast<double>(tree_.nodes.size());
  }
  return ns_of_moves + ns_per_refit * static_cast<double>(dirty_.nodes(tree_.level_begin.size() - 2).size());
}

void TreeUpdater::commit(const Mesh& mesh, MaintenanceStats& stats) {
  if (!has_moved_ && !must_check_all_) return;
  has_moved_ = true;  // in case a step throws
  update_margin(mesh);
  adapt_unit(mesh);
  rebuilds_.advance(tree_, mesh, margin_.fitted(mesh), dirty_, expected_ns(), stats);
  const Refits refits = refit(mesh);
  const bool is_surveyed = rebuilds_.count_refits(tree_, mesh, refits.count);
  const double margin_cost = publish(refits, stats);
  // An animation that stands still says nothing about how it moves.
  if (is_automatic() && longest_displacement_ > 0) tune(mesh, refits, margin_cost, is_surveyed);
  begin_next_interval();
}

void TreeUpdater::update_margin(const Mesh& mesh) {
  if (must_check_all_ || margin_.is_stale()) {
    if (margin_.is_on()) {
      ++whole_passes_;
      margin_.absorb_all(mesh, motion_margin(), tree_, dirty_);
    }
  }
  must_check_all_ = false;
}

void TreeUpdater::adapt_unit(const Mesh& mesh) {
  // Bounds may follow a vertex by as much as it has moved, and as it was away from its position at the last refit.
  if (sum_of_displacements_ + tree_.slack <= outgrown * tree_.unit) return;
  tree_.unit = bvh::bounding_box_of(mesh).unit();
  margin_.refit_all(mesh, dirty_);
}

TreeUpdater::Refits TreeUpdater::refit(const Mesh& mesh) {
  const bool is_full = dirty_.covers_most_of(tree_);
  const std::size_t avoided = dirty_.avoided_count();
  return {bvh::refit(tree_, margin_.fitted(mesh), dirty_), avoided, is_full};
}

/// Returns the steps that queries have spent on the margin since the last commit.
double TreeUpdater::publish(const Refits& refits, MaintenanceStats& stats) {
  tree_.displacement = (tree_.displacement + sum_of_displacements_) * base::outward;
  stats.refits += refits.count;
  if (refits.count >= tree_.nodes.size()) ++whole_passes_;
  stats.whole_passes += std::exchange(whole_passes_, 0);
  stats.absorbed += margin_.absorbed_count();
  double margin_cost = 0;
  if (margin_.is_on()) {
    tree_.slack = margin_.largest_displacement();
    margin_cost = static_cast<double>(margin_cost_.exchange(0, std::memory_order_relaxed)) * bvh::margin_cost_unit;
    stats.margin_steps += margin_cost;
  }
  if (motion_margin() == 0 && margin_.is_on()) {
    // All positions at the last refit are the present ones.
    margin_.stop();
    tree_.margin_cost = nullptr;
  }
  return margin_cost;
}

void TreeUpdater::tune(const Mesh& mesh, const Refits& refits, double margin_cost, bool is_surveyed) {
  const double margin_before = tuner_.margin();
  const double pass_ns = ns_per_refit_in_pass * static_cast<double>(tree_.nodes.size());
  const double refit_ns = refits.is_full ? pass_ns : ns_per_refit * static_cast<double>(refits.count);
  std::optional<double> without_margin_ns;
  if (moved_all_) {
    without_margin_ns = pass_ns;
  } else if (counts_avoided()) {
    without_margin_ns = std::min(pass_ns, refit_ns + ns_per_refit * static_cast<double>(refits.avoided));
  }
  const bool all_absorbed = margin_.is_on() && margin_.refitted_count() == 0;
  tuner_.add({refit_ns, without_margin_ns, margin_cost * ns_per_step, longest_displacement_, all_absorbed});
  ++tuned_commits_;
  if (is_surveyed) tuner_.set_largest(useful_part_of_radius * rebuilds_.surveyed_leaf_radius());
  must_check_all_ = tuner_.margin() < margin_before;
  if (margin_.is_on() || tuner_.margin() == 0) return;
  try {
    start_margin(mesh);
  } catch (const std::bad_alloc&) {
    LIMBER_ASSERT(!margin_.is_on());  // a later commit tries again; until then there is no margin
  }
}

void TreeUpdater::begin_next_interval() {
  LIMBER_ASSERT(margin_.is_on() || tree_.slack == 0);
  has_moved_ = moved_all_ = false;
  longest_displacement_ = sum_of_displacements_ = 0;
  moves_ = 0;
  margin_.clear_counts();
}

}  // namespace limber::model

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

using bvh::ns_per_refit, bvh::ns_per_refit_in_pass;

// Vertices that have moved that many units may be where float32 has no numbers in the unit of the tree.
constexpr double outgrown = 0x1p40;

// What a move costs beside refits, in ns.
constexpr double ns_per_move = 10;

// A batch that names at least 1 / this of the vertices is cheaper to treat as one that moves all.
constexpr std::size_t vertices_per_id_for_all = 4;

}  // namespace

TreeUpdater::TreeUpdater(bvh::Tree& tree, const Mesh& mesh, const ModelOptions& options)
    : tree_(tree),
      dirty_(tree),
      rebuilds_(tree, options.rebuild_policy, options.rebuild_budget_us),
      motion_margin_(options.motion_margin) {
  if (motion_margin_ > 0) start_margin(mesh);
  if (!options.preallocate) return;
  bvh::VertexIndex& index = dirty_.vertex_index();
  index.reserve(mesh.positions().size(), mesh.triangles().size());
  dirty_.try_index_vertices(tree, mesh.positions().size());
  rebuilds_.reserve(tree, mesh);
}

void TreeUpdater::start_margin(const Mesh& mesh) {
  margin_.start(mesh.positions());
  ++whole_passes_;
}

void TreeUpdater::set_motion_margin(const Mesh& mesh, double margin) {
  LIMBER_ASSERT(margin >= 0);
  if (!margin_.is_on() && margin > 0) start_margin(mesh);  // the only step that may fail comes first
  motion_margin_ = margin;
  must_check_all_ = margin_.is_on();
}

void TreeUpdater::note_displacement(double length_sq) {
  LIMBER_ASSERT(std::isfinite(length_sq));
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
  if (!has_vertex_index(mesh)) return margin_.refit_all(mesh, dirty_);
  margin_.absorb(mesh, ids, motion_margin_, dirty_);
}

void TreeUpdater::move_all(Mesh& mesh, std::span<const Vec3> positions, double farthest_sq) {
  MeshWriter::set_positions(mesh, positions);
  note_displacement(farthest_sq);
  moves_ += positions.size();
  if (!margin_.is_on()) return dirty_.add_all();
  ++whole_passes_;
  margin_.count_absorbed(positions.size() - margin_.absorb_all(mesh, motion_margin_, tree_, dirty_));
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
  const std::uint64_t refits = bvh::refit(tree_, margin_.fitted(mesh), dirty_);
  rebuilds_.count_refits(tree_, mesh, refits);
  publish(refits, stats);
  begin_next_interval();
}

void TreeUpdater::update_margin(const Mesh& mesh) {
  if (must_check_all_ || margin_.is_stale()) {
    if (margin_.is_on()) {
      ++whole_passes_;
      margin_.absorb_all(mesh, motion_margin_, tree_, dirty_);
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

void TreeUpdater::publish(std::uint64_t refits, MaintenanceStats& stats) {
  tree_.displacement = (tree_.displacement + sum_of_displacements_) * base::outward;
  stats.refits += refits;
  if (refits >= tree_.nodes.size()) ++whole_passes_;
  stats.whole_passes += std::exchange(whole_passes_, 0);
  stats.absorbed += margin_.absorbed_count();
  if (margin_.is_on()) tree_.slack = margin_.largest_displacement();
  if (motion_margin_ == 0) margin_.stop();  // all positions at the last refit are the present ones
}

void TreeUpdater::begin_next_interval() {
  LIMBER_ASSERT(margin_.is_on() || tree_.slack == 0);
  has_moved_ = false;
  sum_of_displacements_ = 0;
  moves_ = 0;
  margin_.clear_counts();
}

}  // namespace limber::model

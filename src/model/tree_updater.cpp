// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Moves only note what has to be done: displacements, and which nodes are dirty:
//
//                                without a motion margin             with one
//   move()                       the lowest nodes of its vertices    those of its vertices beyond the margin
//     of very many vertices      all nodes                           those of its vertices beyond the margin
//     no memory for the index    all nodes                           all nodes
//   move_all()                   all nodes                           the lowest nodes of vertices beyond the margin
//   rebuild_all(), a new unit    all nodes                           all nodes
//
// A commit does the rest:
//   1. check_margin()   marks all vertices beyond the margin, if that has changed or slack may be far too large;
//   2. adapt_unit()     changes the unit of length in which the tree stores bounds, if necessary;
//   3. goes on with a rebuild, refits what is dirty, and publishes the result.
#include "model/tree_updater.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "mesh/updates.h"
#include "simd/kernels.h"

namespace limber::model {
namespace {

/// The squared distance of two points up to rounding; at least `smallest_square` unless the points are equal, because
/// squares of tiny distances may underflow.
double floored_distance_sq(const Vec3& p, const Vec3& q) {
  const double d_sq = length_sq(p - q);
  return d_sq >= smallest_square || p == q ? d_sq : smallest_square;
}

// What a moved vertex costs in move() and move_all(), where nothing is refitted, in ns. An estimate, as those of
// bvh/refit.h, from which the time that is left for a rebuild follows.
constexpr double ns_per_move = 10;

// How many vertices ahead a position is fetched. Trades waiting for filling the cache; no answer depends on it.
constexpr std::size_t prefetched = 32;

}  // namespace

void MotionMargin::start(std::span<const Vec3> positions) {
  fitted_.assign(positions.begin(), positions.end());
  farthest_sq_ = 0;
  moves_since_exact_ = 0;
}

double MotionMargin::slack() const { return std::sqrt(farthest_sq_) * base::outward; }

void MotionMargin::mark(const Mesh& mesh, VertexId vertex, bvh::DirtySet& dirty) {
  fitted_[vertex] = mesh.positions()[vertex];
  dirty.add(vertex);
}

void MotionMargin::mark_everything(const Mesh& mesh, bvh::DirtySet& dirty) {
  dirty.add_all();
  if (!is_on()) return;
  LIMBER_ASSERT(fitted_.size() == mesh.positions().size());
  std::copy(mesh.positions().begin(), mesh.positions().end(), fitted_.begin());
  farthest_sq_ = 0;
  moves_since_exact_ = 0;
}

void MotionMargin::mark_beyond(const Mesh& mesh, std::span<const VertexId> ids, double margin, bvh::DirtySet& dirty) {
  for (const VertexId id : ids) {
    const double distance_sq = floored_distance_sq(mesh.positions()[id], fitted_[id]);
    if (distance_sq > margin * margin) {  // any that has moved if the margin's square underflows: safe
      mark(mesh, id, dirty);
      continue;
    }
    farthest_sq_ = std::max(farthest_sq_, distance_sq);  // never shrinks here, so it may become stale
    ++absorbed_;
  }
  moves_since_exact_ += ids.size();
}

std::size_t MotionMargin::mark_all_beyond(const Mesh& mesh, double margin, const bvh::Tree& tree,
                                          bvh::DirtySet& dirty) {
  const std::vector<Vec3>& positions = mesh.positions();
  const double margin_sq = margin * margin;
  moves_since_exact_ = 0;
  farthest_sq_ =
      simd::kernels().max_displacement(fitted_.data(), positions.data(), positions.size(), max_coordinate).farthest_sq;
  // Below smallest_square the kernel cannot tell tiny distances from none. The slow loop can; so little motion is rare.
  if (smallest_square <= farthest_sq_ && farthest_sq_ <= margin_sq) return 0;
  farthest_sq_ = 0;
  std::size_t marked_count = 0;
  for (VertexId v = 0; v < positions.size(); ++v) {
    const double distance_sq = floored_distance_sq(positions[v], fitted_[v]);
    if (distance_sq <= margin_sq) {
      farthest_sq_ = std::max(farthest_sq_, distance_sq);
      continue;
    }
    ++marked_count;
    if (dirty.try_index_vertices(tree, positions.size())) {  // builds the index if there is none yet
      mark(mesh, v, dirty);
    } else {
      dirty.add_all();  // so covers_most_of() is true
    }
    if (!dirty.covers_most_of(tree)) continue;
    mark_everything(mesh, dirty);  // makes no more work: the whole tree is going to be fitted
    return positions.size();
  }
  return marked_count;
}

TreeUpdater::TreeUpdater(bvh::Tree& tree, const Mesh& mesh, const ModelOptions& options)
    : tree_(tree),
      dirty_(tree),
      rebuilds_(tree, options.rebuild_policy, options.rebuild_budget_us),
      margin_width_(options.motion_margin) {
  if (margin_width_ > 0) start_margin(mesh);
  if (!options.preallocate) return;
  dirty_.vertex_index().reserve(mesh.positions().size(), mesh.triangles().size());
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
  margin_width_ = margin;
  // Even if the new margin is 0: the next commit then marks all vertices that have moved, and stops the margin.
  must_check_all_ = margin_.is_on();
}

/// Notes that `count` vertices have moved, the farthest by the square root of `farthest_sq`.
void TreeUpdater::note_moves(std::size_t count, double farthest_sq) {
  LIMBER_ASSERT(std::isfinite(farthest_sq));
  moves_ += count;
  // Squares below `smallest_square` may have underflowed. With u = 2^-53, the squared length is off by 5 u, so its root
  // by 3.5 u, and the sum by u: sum_up covers 8 u.
  const double upper_bound = std::sqrt(std::max(farthest_sq, smallest_square));
  sum_of_displacements_ = (sum_of_displacements_ + upper_bound) * base::sum_up;
  has_moved_ = true;
}

bool TreeUpdater::ensure_vertex_index(const Mesh& mesh) {
  if (dirty_.has_vertex_index()) return true;
  ++whole_passes_;  // even if it fails, as memory may be missing only after a look at all nodes
  return dirty_.try_index_vertices(tree_, mesh.positions().size());
}

void TreeUpdater::mark_without_margin(const Mesh& mesh, std::span<const VertexId> ids) {
  // For a quarter of the vertices or more it is cheaper to fit the whole tree.
  if (4 * ids.size() >= mesh.positions().size() || !ensure_vertex_index(mesh)) return dirty_.add_all();
  for (const VertexId id : ids) {
    if (dirty_.covers_most_of(tree_)) return dirty_.add_all();
    dirty_.add(id);
  }
}

void TreeUpdater::move(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions) {
  // All displacements are measured before any vertex moves. The batch may have an id several times, of which the
  // last counts: so each is measured from where the vertex was before the batch.
  double farthest_sq = 0;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (i + prefetched < ids.size()) __builtin_prefetch(&mesh.positions()[ids[i + prefetched]]);
    farthest_sq = std::max(farthest_sq, length_sq(positions[i] - mesh.positions()[ids[i]]));
  }
  MeshWriter::set_positions(mesh, ids, positions);
  note_moves(ids.size(), farthest_sq);
  if (!margin_.is_on()) {
    mark_without_margin(mesh, ids);
  } else if (ensure_vertex_index(mesh)) {
    margin_.mark_beyond(mesh, ids, margin_width_, dirty_);
  } else {
    margin_.mark_everything(mesh, dirty_);  // without the index no node of a vertex is known
  }
}

void TreeUpdater::move_all(Mesh& mesh, std::span<const Vec3> positions, double farthest_sq) {
  MeshWriter::set_positions(mesh, positions);
  note_moves(positions.size(), farthest_sq);
  if (!margin_.is_on()) return dirty_.add_all();
  ++whole_passes_;
  const std::size_t marked = margin_.mark_all_beyond(mesh, margin_width_, tree_, dirty_);
  margin_.count_absorbed(positions.size() - marked);
}

void TreeUpdater::rebuild_all(const Mesh& mesh) {
  bvh::Tree built = bvh::build(mesh);
  bvh::TreeCost cost(built);
  // From here on nothing throws.
  rebuilds_.start_over(dirty_, std::move(cost));  // gives up a partial rebuild
  tree_.exchange(built);                          // tree_.displacement becomes 0
  const bool had_index = dirty_.has_vertex_index();
  dirty_.vertex_index().drop();
  if (had_index) dirty_.try_index_vertices(tree_, mesh.positions().size());  // if it fails, the next move tries again
  // The new bounds are right already, but dirty_ and tree_.slack are those of the old tree. mark_everything() makes all
  // nodes dirty, so the next commit refits them and publishes a slack that is right.
  margin_.mark_everything(mesh, dirty_);
  has_moved_ = true;
}

/// What the moves since the last commit, and this commit, are expected to take; rebuilding is left out.
double TreeUpdater::expected_ns() const {
  const double ns_of_moves = ns_per_move * static_cast<double>(moves_);
  if (dirty_.covers_most_of(tree_)) {
    return ns_of_moves + bvh::ns_per_refit_in_pass * static_cast<double>(tree_.nodes.size());
  }
  return ns_of_moves + bvh::ns_per_refit * static_cast<double>(dirty_.nodes(tree_.lowest_level()).size());
}

// The order matters. The margin decides what is dirty. A unit has to suit the positions before anything is fitted in
// it. A rebuild may exchange the tree and the dirty nodes, so the refit follows it.
void TreeUpdater::commit(const Mesh& mesh, MaintenanceStats& stats) {
  if (!has_moved_ && !must_check_all_) return;
  has_moved_ = true;  // until the end: if a step throws, the next commit does the rest
  check_margin(mesh);
  adapt_unit(mesh);
  rebuilds_.advance(tree_, mesh, margin_.fitted_mesh(mesh), dirty_, expected_ns(), stats);
  const std::uint64_t refits = bvh::refit(tree_, margin_.fitted_mesh(mesh), dirty_);
  rebuilds_.count_refits(tree_, mesh, refits);
  publish(refits, stats);
  LIMBER_ASSERT(margin_.is_on() || tree_.slack == 0);
  has_moved_ = false;
  sum_of_displacements_ = 0;
  moves_ = 0;
  margin_.clear_counts();
}

void TreeUpdater::check_margin(const Mesh& mesh) {
  if (margin_.is_on() && (must_check_all_ || margin_.is_stale())) {
    ++whole_passes_;
    margin_.mark_all_beyond(mesh, margin_width_, tree_, dirty_);
  }
  must_check_all_ = false;
}

/// Chooses another unit, from the present positions, if the next refit might write bounds too many units away from the
/// old ones: float32 could not represent them (bvh/tree.h). Between two refits a vertex moves at most by its
/// displacements since the last commit, plus its slack then; tree_.slack is still that of the last commit.
void TreeUpdater::adapt_unit(const Mesh& mesh) {
  if (sum_of_displacements_ + tree_.slack <= bvh::units_moved_until_fit * tree_.unit) return;
  tree_.unit = bvh::bounding_box_of(mesh).unit();
  margin_.mark_everything(mesh, dirty_);
}

/// Tells queries, by members of the tree, and the statistics what the commit has done. Stops a margin that is 0 now.
/// Tree::displacement is all motion since the tree was built, Tree::slack how far vertices are now from where they were
/// fitted. `outward` is more than a sum to which one number is added at each commit needs.
void TreeUpdater::publish(std::uint64_t refits, MaintenanceStats& stats) {
  tree_.displacement = (tree_.displacement + sum_of_displacements_) * base::outward;
  stats.refits += refits;
  if (refits >= tree_.nodes.size()) ++whole_passes_;
  stats.whole_passes += std::exchange(whole_passes_, 0);
  stats.absorbed += margin_.absorbed_count();
  if (margin_.is_on()) tree_.slack = margin_.slack();
  // check_margin() has looked at all vertices since the margin became 0, and a margin of 0 absorbs no vertex that has
  // moved. So all are where they were refitted.
  if (margin_width_ == 0) margin_.stop();
}

}  // namespace limber::model

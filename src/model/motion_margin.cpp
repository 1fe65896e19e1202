// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/motion_margin.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/error_bounds.h"
#include "simd/kernels.h"

namespace limber::model {
namespace {

/// The squared distance of two points up to rounding; at least `smallest_square` unless the points are equal, because
/// squares of tiny distances may underflow.
double floored_distance_sq(const Vec3& p, const Vec3& q) {
  const double d_sq = length_sq(p - q);
  return d_sq >= smallest_square || p == q ? d_sq : smallest_square;
}

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

}  // namespace limber::model

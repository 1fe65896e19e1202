// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The closest point of a model: depth first, the nearest child first. Triangles that may be the closest are collected,
// so that their vertices are fetched from memory meanwhile, and compared when there are enough. For points so far away
// that float32 cannot tell distances apart, kernels compare heights along the direction to the point ("along") instead.
#include "point/closest_point.h"
#include "limber/distance.h"

#include <algorithm>
#include <bit>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "base/rounding.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"

namespace limber::point {
namespace {

// Stands for infinity among squared bounds: more than any bound of a child, but finite, as kernels need it.
constexpr float most_bound = 3e38F;

}  // namespace

NearestTriangles::NearestTriangles(const PlacedModel& model)
    : model_(model), tree_(model.tree()), kernels_(simd::kernels()) {}

void NearestTriangles::start(const Vec3& point, double limit, double enough) {
  in_frame_ = model_.in_frame(point);
  enough_ = enough;
  set_limit(limit);
  waiting_.start(limit_bound_);
}

std::span<const NearestTriangles::Candidate> NearestTriangles::next(QueryStats& stats) {
  count_ = 0;
  for (bvh::SlotStack::Entry next; waiting_.take(limit_bound_, next);) {
    if (!bvh::has_leaf_or_coincides(tree_, next.slot)) {
      expand(next.slot, stats);
    } else if (compare_leaf(next.slot)) {
      break;
    }
  }
  Candidate* const end = candidates_ + count_;
  Candidate* const nearest =
      std::min_element(candidates_, end, [](const Candidate& a, const Candidate& b) { return a.lower < b.lower; });
  if (nearest != end) std::swap(*nearest, candidates_[0]);
  return {candidates_, count_};
}

void NearestTriangles::set_limit(double limit) {
  limit_ = limit;
  limit_bound_ = bound_of(limit);
}

/// Converts a distance to what kernels compare bounds with. For far points that is a height, rounded up. For others it
/// is a square, rounded to the nearest: bounds of children are lowered by more than that (base::point_error). It is
/// above 0, so children with a bound of 0 are never pruned.
float NearestTriangles::bound_of(double distance) const {
  const simd::QueryPoint& p = in_frame_;
  if (p.is_far) {
    return base::float_up(std::clamp((distance - p.height) * p.per_unit, -base::max_units, base::max_units));
  }
  const double units = distance * p.per_unit;
  const auto squared = static_cast<float>(std::min(units * units, double{most_bound}));
  return std::max(squared, std::numeric_limits<float>::min());
}

void NearestTriangles::expand(bvh::SlotId slot, QueryStats& stats) {
  const std::uint32_t n = bvh::child_of(tree_, slot);
  const bvh::Node& node = tree_.nodes[n];
  stats.node_tests += node.child_count;
  simd::ChildrenInOrder found;
  const auto kernel = in_frame_.is_far ? kernels_.bound_children_along : kernels_.bound_children_to_point;
  kernel(node, in_frame_, limit_bound_, found);
  const double upper = static_cast<double>(found.upper) * in_frame_.unit;
  lower_limit(upper);
  waiting_.add(n, found);
}

/// Adds the triangles of a leaf that may be the closest. Returns whether candidates are to be compared now.
bool NearestTriangles::compare_leaf(bvh::SlotId slot) {
  LIMBER_ASSERT(count_ + bvh::width <= capacity);
  const bvh::LeafInNode at = bvh::first_leaf(tree_, slot);
  const bvh::Leaf& leaf = at.leaf;
  simd::TriangleIntervals found;
  const auto kernel = in_frame_.is_far ? kernels_.bound_triangles_along : kernels_.bound_triangles_to_point;
  kernel(at.node, at.slot, leaf.corners, in_frame_, limit_, found);
  for (; found.kept != 0; found.kept &= found.kept - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(found.kept));
    candidates_[count_++] = {static_cast<double>(found.lower[k]) * found.step, &leaf, k};
    for (const VertexId v : leaf.vertices[k]) __builtin_prefetch(&model_.mesh().positions[v]);
  }
  const double upper = static_cast<double>(found.upper) * found.step;
  lower_limit(upper);
  // For far points the kernel gives no upper bound, so triangles are compared now, to lower the limit.
  return count_ > 0 && (in_frame_.is_far || upper <= enough_ || count_ + bvh::width > capacity);
}

std::optional<SurfacePoint> ClosestPointSearch::find(const Vec3& point, double max_distance, QueryStats& stats,
                                                     double enough) {
  best_.reset();
  nearest_.start(point, max_distance, enough);
  for (auto found = nearest_.next(stats); !found.empty(); found = nearest_.next(stats)) {
    for (const NearestTriangles::Candidate& candidate : found) {
      if (!nearest_.matters(candidate)) continue;
      ++stats.primitive_tests;
      compare(candidate, point, max_distance);
    }
    if (best_ && best_->distance <= enough) break;
  }
  return best_;
}

void ClosestPointSearch::compare(const NearestTriangles::Candidate& candidate, const Vec3& point, double max_distance) {
  const Triangle triangle = model_.triangle(candidate.vertices());
  const TriangleId id = candidate.id();
  const geometry::PointOnTriangle closest = geometry::closest_on(triangle, point);
  if (closest.distance > max_distance) return;
  if (best_) {
    if (closest.distance > best_->distance) return;
    if (closest.distance == best_->distance && id >= best_->triangle) return;
  }
  const Vec3& w = closest.weights;
  best_ = SurfacePoint{closest.distance, geometry::point_at(triangle, w), id, {w.x, w.y, w.z}, geometry::feature_of(w)};
  nearest_.lower_limit(closest.distance);
}

}  // namespace limber::point

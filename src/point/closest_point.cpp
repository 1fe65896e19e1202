// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of a point and a model: a search, and three kinds of public functions.
//   NearestTriangles, ClosestPointSearch: depth first, the nearest child first. Triangles that may be the closest are
//      collected, so that their vertices are fetched from memory meanwhile, and compared when there are enough. For
//      points so far away that float32 cannot tell distances apart, kernels compare heights along the direction to the
//      point ("along") instead.
//   closest_point(), closest_point_many(): the search alone.
//   ClosedSurface: also whether points are inside, by winding numbers (placed_model.h).
//   generalized_winding_number(): of any mesh, as a sum over all triangles.
#include "point/closest_point.h"

#include <algorithm>
#include <bit>
#include <limits>
#include <numbers>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "base/rounding.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/winding.h"
#include "limber/distance.h"
#include "mesh/adjacency.h"
#include "model/model_impl.h"

namespace limber::point {

std::span<const NearestTriangles::Candidate> NearestTriangles::next(QueryStats& stats) {
  count_ = 0;
  for (bvh::SlotStack::Entry next; waiting_.take(limit_bound_, next);) {
    if (!bvh::has_leaf_or_coincides(tree_, next.slot)) {
      expand(next.slot, stats);
    } else if (collect_from_leaf(next.slot)) {
      break;
    }
  }
  Candidate* const end = candidates_ + count_;
  Candidate* const nearest =
      std::min_element(candidates_, end, [](const Candidate& a, const Candidate& b) { return a.lower < b.lower; });
  if (nearest != end) std::swap(*nearest, candidates_[0]);
  return {candidates_, count_};
}

/// Converts a distance to what kernels compare bounds with. For far points that is a height, rounded up. For others it
/// is a square, rounded to the nearest: bounds of children are lowered by more than that (base::point_error). It is
/// above 0, so children with a bound of 0 are never pruned.
float NearestTriangles::bound_of(double distance) const {
  const simd::QueryPoint& p = in_frame_;
  if (p.is_far) {
    return base::float_up(std::clamp((distance - p.height) * p.per_unit, -base::max_units, base::max_units));
  }
  constexpr double most_bound = 3e38F;  // for infinity: more than any bound of a child, but finite, as kernels need it
  const double units = distance * p.per_unit;
  const auto squared = static_cast<float>(std::min(units * units, most_bound));
  return std::max(squared, std::numeric_limits<float>::min());
}

void NearestTriangles::expand(bvh::SlotId slot, QueryStats& stats) {
  const std::uint32_t n = bvh::child_of(tree_, slot);
  const bvh::Node& node = tree_.nodes[n];
  stats.node_tests += node.child_count;
  simd::ChildrenInOrder found;
  const auto kernel = in_frame_.is_far ? kernels_.bound_children_along : kernels_.bound_children_to_point;
  kernel(node, in_frame_, limit_bound_, found);
  lower_limit(static_cast<double>(found.upper) * in_frame_.unit);
  waiting_.add(n, found);
}

/// Adds the triangles of a leaf that may be the closest. Returns whether candidates are to be compared now.
bool NearestTriangles::collect_from_leaf(bvh::SlotId slot) {
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

namespace limber {

PointResult closest_point(const Placed& model, const Vec3& point, const PointOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::closest_point");
  base::check_point(point, "limber::closest_point");
  base::check_has_no_radius(model, "limber::closest_point");
  const point::PlacedModel placed(model);
  point::ClosestPointSearch search(placed);
  PointResult result;
  result.closest = search.find(point, options.max_distance, result.stats);
  return result;
}

void closest_point_many(const Placed& model, std::span<const Vec3> points, std::span<PointResult> results,
                        const PointOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::closest_point_many");
  base::check_points(points, results.size(), "limber::closest_point_many");
  base::check_has_no_radius(model, "limber::closest_point_many");
  const point::PlacedModel placed(model);
  base::parallel_for_ranges(points.size(), point::points_per_task, [&](std::size_t begin, std::size_t end) {
    point::ClosestPointSearch search(placed);
    for (std::size_t i = begin; i < end; ++i) {
      results[i].stats = {};
      results[i].closest = search.find(points[i], options.max_distance, results[i].stats);
    }
  });
}

namespace {

SignedDistance signed_distance_of(const point::PlacedModel& placed, point::ClosestPointSearch& search,
                                  const Vec3& point, double max_distance) {
  SignedDistance result;
  result.closest = search.find(point, max_distance, result.stats);
  result.is_inside = point::surrounding_of(placed, point, result.stats).is_inside_or_on();
  return result;
}

}  // namespace

Result<ClosedSurface> ClosedSurface::create(const Model& model) {
  if (auto closed = mesh::check_closed(model.mesh()); !closed) return closed.error();
  return ClosedSurface(model);
}

ClosedSurface::ClosedSurface(const Model& model) : model_(&model), surface_id_(Access::impl(model).surface_id) {}

Placed ClosedSurface::placed(const Transform& world_from_model) const {
  LIMBER_REQUIRE(model_->is_valid(), "limber::ClosedSurface: the model has been moved from");
  LIMBER_REQUIRE(Access::impl(*model_).surface_id == surface_id_,
                 "limber::ClosedSurface: the model has been reset, so whether it is closed must be checked again");
  return {*model_, world_from_model};
}

bool ClosedSurface::contains(const Vec3& point, const Transform& world_from_model) const {
  return winding_number(point, world_from_model).value_or(1) != 0;  // a point on the surface counts as inside
}

std::optional<int> ClosedSurface::winding_number(const Vec3& point, const Transform& world_from_model) const {
  const base::DefaultFloatEnvironment environment;
  base::check_point(point, "limber::ClosedSurface");
  const point::PlacedModel model(placed(world_from_model));
  QueryStats stats;
  const point::Surrounding surrounding = point::surrounding_of(model, point, stats);
  if (surrounding.is_on) return std::nullopt;
  return surrounding.winding_number;
}

SignedDistance ClosedSurface::signed_distance(const Vec3& point, const Transform& world_from_model,
                                              const PointOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::ClosedSurface::signed_distance");
  base::check_point(point, "limber::ClosedSurface::signed_distance");
  const point::PlacedModel model(placed(world_from_model));
  point::ClosestPointSearch search(model);
  return signed_distance_of(model, search, point, options.max_distance);
}

void ClosedSurface::signed_distance_many(std::span<const Vec3> points, std::span<SignedDistance> results,
                                         const Transform& world_from_model, const PointOptions& options) const {
  const base::DefaultFloatEnvironment environment;
  constexpr const char* name = "limber::ClosedSurface::signed_distance_many";
  base::check_options(options, name);
  base::check_points(points, results.size(), name);
  const point::PlacedModel model(placed(world_from_model));
  base::parallel_for_ranges(points.size(), point::points_per_task, [&](std::size_t begin, std::size_t end) {
    point::ClosestPointSearch search(model);
    for (std::size_t i = begin; i < end; ++i) {
      results[i] = signed_distance_of(model, search, points[i], options.max_distance);
    }
  });
}

double generalized_winding_number(const Placed& model, const Vec3& point) {
  const base::DefaultFloatEnvironment environment;
  base::check_point(point, "limber::generalized_winding_number");
  base::check_has_no_radius(model, "limber::generalized_winding_number");
  const point::PlacedModel placed(model);
  const std::span<const Corners> triangles = placed.mesh().triangles;
  // Sums of ranges that do not depend on threads, added up in their order. More ranges share work better, smaller ones
  // cost more to start: guesses, which the last bits of the sum depend on.
  constexpr std::size_t most_ranges = 256, least_size = 512;
  const std::size_t size = std::max(least_size, (triangles.size() + most_ranges - 1) / most_ranges);
  double sums[most_ranges] = {};
  base::parallel_for_ranges(triangles.size(), size, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t t = begin; t < end; ++t) {
      sum += geometry::half_solid_angle(point, placed.triangle(triangles[t]));
    }
    sums[begin / size] = sum;
  });
  double sum = 0;
  for (const double part : sums) sum += part;
  // The product must not move behind the end of `environment`: base/float_environment.h.
  return environment.computed_before_restore(sum * (0.5 * std::numbers::inv_pi));
}

}  // namespace limber

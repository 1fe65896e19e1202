// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// ClosedSurface.
#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "limber/points.h"
#include "mesh/adjacency.h"
#include "model/model_impl.h"
#include "point/closest_point.h"
#include "point/ray_crossings.h"

namespace limber {
namespace {

SignedDistance signed_distance_of(const point::PlacedModel& placed, point::ClosestPointSearch& search,
                                  const Vec3& point, double max_distance) {
  SignedDistance result;
  result.closest = search.find(point, max_distance, result.stats);
  const point::Surrounding surrounding = point::surrounding_of(placed, point, result.stats);
  result.is_inside = surrounding.is_inside_or_on();
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
  return winding_number(point, world_from_model).value_or(1) != 0;
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
  const SignedDistance result = signed_distance_of(model, search, point, options.max_distance);
  return result;
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

}  // namespace limber

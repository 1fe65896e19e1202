// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries about points: each checks its arguments, and searches.
#include "core/float_environment.h"
#include "core/parallel.h"
#include "limber/points.h"
#include "query/closest_point.h"
#include "query/options.h"

namespace limber {

PointResult closest_point(const Placed& model, const Vec3& point, const PointOptions& options) {
  const core::DefaultFloatEnvironment environment;
  query::check_options(options, "limber::closest_point");
  query::check_point(point, "limber::closest_point");
  const query::PlacedModel placed(model);
  query::ClosestPointSearch search(placed);
  PointResult result;
  result.closest = search.find(point, options.max_distance, result.stats);
  placed.add_margin_cost(search.margin_cost());
  return result;
}

void closest_points(const Placed& model, std::span<const Vec3> points, std::span<PointResult> results,
                    const PointOptions& options) {
  const core::DefaultFloatEnvironment environment;
  query::check_options(options, "limber::closest_points");
  query::check_points(points, results.size(), "limber::closest_points");
  const query::PlacedModel placed(model);
  core::parallel_for_ranges(points.size(), query::points_per_task, [&](std::size_t begin, std::size_t end) {
    query::ClosestPointSearch search(placed);
    for (std::size_t i = begin; i < end; ++i) {
      results[i].stats = {};
      results[i].closest = search.find(points[i], options.max_distance, results[i].stats);
    }
    placed.add_margin_cost(search.margin_cost());
  });
}

}  // namespace limber

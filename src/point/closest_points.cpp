// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries about points: each checks its arguments, and searches.
#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "limber/points.h"
#include "point/closest_point.h"

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

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The generalized winding number, as a sum over all triangles.
#include <algorithm>
#include <numbers>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/winding.h"
#include "limber/points.h"
#include "point/placed_model.h"

namespace limber {

double generalized_winding_number(const Placed& model, const Vec3& point) {
  const base::DefaultFloatEnvironment environment;
  base::check_point(point, "limber::generalized_winding_number");
  base::check_has_no_radius(model, "limber::generalized_winding_number");
  const point::PlacedModel placed(model);
  const std::span<const Corners> triangles = placed.mesh().triangles;
  // Sums of ranges that do not depend on threads, added up in their order.
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
  return environment.computed_before_restore(sum * (0.5 * std::numbers::inv_pi));
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point/ray_crossings.h"

#include "geometry/winding.h"
#include "limber/distance.h"

namespace limber::point {

Surrounding surrounding_of(const PlacedModel& model, const Vec3& point, QueryStats& stats) {
  Surrounding surrounding;
  ++stats.node_tests;
  const std::optional<AxisRay> ray = model.ray_from(point);
  if (!ray) return surrounding;
  const bool is_off = visit_crossed(model, *ray, stats, [&](const Triangle& triangle) {
    if (geometry::lies_on(point, triangle)) return false;
    surrounding.winding_number += geometry::winding_along(point, triangle, ray->axis, ray->is_upward);
    return true;
  });
  if (!is_off) return {.is_on = true};
  return surrounding;
}

}  // namespace limber::point

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <numbers>
#include <vector>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "geometry/winding.h"
#include "reference/place.h"
#include "reference/reference.h"

namespace limber::reference {

PointResult closest_point(const Placed& mesh, const Vec3& point, const PointOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::reference::closest_point");
  base::check_point(point, "limber::reference::closest_point");
  PointResult result;
  const std::vector<Triangle> triangles = place(mesh);
  for (TriangleId t = 0; t < triangles.size(); ++t) {
    ++result.stats.primitive_tests;
    const geometry::PointOnTriangle closest = geometry::closest_on(triangles[t], point);
    if (closest.distance > (result.closest ? result.closest->distance : options.max_distance)) continue;
    if (result.closest && closest.distance == result.closest->distance) continue;
    const Vec3& w = closest.weights;
    result.closest = SurfacePoint{
        closest.distance, geometry::point_at(triangles[t], w), t, {w.x, w.y, w.z}, geometry::feature_of(w)};
  }
  return result;
}

bool contains(const Placed& mesh, const Vec3& point) {
  const base::DefaultFloatEnvironment environment;
  base::check_point(point, "limber::reference::contains");
  int winding_number = 0;
  for (const Triangle& triangle : place(mesh)) {
    if (geometry::lies_on(point, triangle)) return true;
    winding_number += geometry::winding_along(point, triangle, 0, true);
  }
  return winding_number != 0;
}

double winding_number(const Placed& mesh, const Vec3& point) {
  const base::DefaultFloatEnvironment environment;
  base::check_point(point, "limber::reference::winding_number");
  double sum = 0;
  for (const Triangle& triangle : place(mesh)) sum += geometry::half_solid_angle(point, triangle);
  return environment.computed_before_restore(sum * (0.5 * std::numbers::inv_pi));
}

}  // namespace limber::reference

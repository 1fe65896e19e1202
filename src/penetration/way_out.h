// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/local_frame.h"
#include "limber/math.h"
#include "limber/points.h"
#include "point/placed_model.h"

namespace limber::penetration {

/// The direction of a vector, of length 1. Pre: it is not 0.
inline Vec3 unit(const Vec3& v) {
  const Vec3 scaled = geometry::near_unit(v);
  return scaled * (1 / length(scaled));
}

/// A vector of length 1 perpendicular to a direction.
inline Vec3 perpendicular_to(const Vec3& direction) {
  const Vec3 a = abs(direction);
  const Vec3 axis = a.x <= a.y && a.x <= a.z ? Vec3{1, 0, 0} : a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return unit(cross(direction, axis));
}

/// The shortest way out of a solid, of length 1, from a position in it to the closest point of its surface: as
/// DeepestVertex::direction says.
Vec3 way_out(const point::PlacedModel& solid, const Vec3& position, const SurfacePoint& closest);

}  // namespace limber::penetration

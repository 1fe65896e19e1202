// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "penetration/way_out.h"

#include <algorithm>

#include "base/check.h"

namespace limber::penetration {

Vec3 way_out(const point::PlacedModel& solid, const Vec3& position, const SurfacePoint& closest) {
  LIMBER_ASSERT(closest.triangle < solid.mesh().triangles.size());
  // Closest points are off by 2^-50 of the extent, so directions between points that are farther apart than this part
  // of it are off by less than 2^-23.
  constexpr double hardly_apart = 0x1p-26;
  const Triangle t = solid.triangle(solid.mesh().triangles[closest.triangle]);
  const Vec3 edge = t.v1 - t.v0, other = t.v2 - t.v0, out = closest.position - position;
  const double extent = std::max({max_abs(t.v0 - position), max_abs(t.v1 - position), max_abs(t.v2 - position)});
  if (max_abs(out) > hardly_apart * extent) return unit(out);
  if (max_abs(edge) > 0 && max_abs(other) > 0) {
    const Vec3 normal = cross(geometry::near_unit(edge), geometry::near_unit(other));
    if (max_abs(normal) > 0) return unit(normal);
  }
  return max_abs(out) > 0 ? unit(out) : Vec3{0, 0, 1};
}

}  // namespace limber::penetration

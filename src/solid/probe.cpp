// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "solid/probe.h"

#include "base/check.h"
#include "geometry/collinear.h"
#include "geometry/primitives.h"

namespace limber::solid {

std::optional<AxisDirection> direction_off(const Triangle& triangle, int side) {
  LIMBER_ASSERT(side == 1 || side == -1);
  const Vec3 normal = abs(cross(triangle.v1 - triangle.v0, triangle.v2 - triangle.v0));
  std::size_t axis = normal.x >= normal.y ? (normal.x >= normal.z ? 0 : 2) : (normal.y >= normal.z ? 1 : 2);
  int turn = geometry::orient2d(triangle.v0, triangle.v1, triangle.v2, axis);
  if (turn == 0) {  // rounding has hidden the shape
    const std::optional<std::size_t> faithful = geometry::faithful_axis(triangle.v0, triangle.v1, triangle.v2);
    if (!faithful) return std::nullopt;
    axis = *faithful;
    turn = geometry::orient2d(triangle.v0, triangle.v1, triangle.v2, axis);
  }
  return AxisDirection{axis, turn == side};
}

int CornerProbe::side_of_line(const Vec3& a, const Vec3& b) const {
  // Where the probe's base is on the line, the side is that to which the first direction leads, and so on.
  for (const Vec3& corner : corners_) {
    if (const int side = geometry::orient2d(a, b, corner, off_.axis); side != 0) return side;
  }
  return 0;
}

int CornerProbe::side_of_plane(const Triangle& t) const {
  for (const Vec3& corner : corners_) {
    if (const int side = geometry::orient3d(t.v0, t.v1, t.v2, corner); side != 0) return side;
  }
  return 0;
}

int CutProbe::side_of_line(const Vec3& a, const Vec3& b) const {
  if (const int side = base_.side_of_line(a, b, off_.axis); side != 0) return side;
  if (const int side = side_of_direction(a, b, along_, off_.axis); side != 0) return side;
  return geometry::orient2d(a, b, corner_, off_.axis);
}

int CutProbe::side_of_plane(const Triangle& t) const {
  if (const int side = base_.side_of_plane(t); side != 0) return side;
  if (const int side = side_of_direction(t, along_); side != 0) return side;
  return geometry::orient3d(t.v0, t.v1, t.v2, corner_);
}

}  // namespace limber::solid

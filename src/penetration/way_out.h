// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/local_frame.h"
#include "limber/math.h"
#include "limber/points.h"
#include "point/placed_model.h"

namespace limber::penetration {

using geometry::perpendicular_to;
using geometry::unit;

/// The shortest way out of a solid, of length 1, from a position in it to the closest point of its surface: as
/// DeepestVertex::direction says.
Vec3 way_out(const point::PlacedModel& solid, const Vec3& position, const SurfacePoint& closest);

}  // namespace limber::penetration

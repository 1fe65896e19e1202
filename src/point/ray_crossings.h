// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "bvh/tree.h"
#include "limber/distance.h"
#include "point/placed_model.h"
#include "simd/kernels.h"

namespace limber::point {

/// How a closed surface lies around a point.
struct Surrounding {
  bool is_on = false;  ///< whether the point lies on a triangle; then the winding number means nothing
  int winding_number = 0;
};

/// Counts how a ray from a point along an axis of the world crosses a closed surface.
///
/// Differs   From rays for pictures: triangles are judged exactly, for the placed corners, and the ray is moved aside
///           by an infinitesimal amount, so it never meets an edge (geometry/winding.h). Of the six directions it takes
///           the one in which it is soonest beyond the model's box.
///
/// Pre      The surface is closed and oriented. The point is finite and at most `max_coordinate` in size.
Surrounding surrounding_of(const PlacedModel& model, const Vec3& point, QueryStats& stats);

}  // namespace limber::point

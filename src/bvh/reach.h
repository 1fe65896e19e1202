// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error_bounds.h"
#include "bvh/tree.h"

namespace limber::bvh {

/// At least the distance from a point of anything in a volume, in units, up to rounding in float64: by its sphere; by
/// its slab and the sphere across that. The kernel merge_bounds has the same for eight volumes at once.
struct Reach {
  double by_sphere, by_slab;
};

/// The reach of the volume of a slot whose center is at `d` from the point.
inline Reach reach_of(const ChildBounds& n, std::uint32_t slot, const Vec3& d) {
  const double radius = n.radius[slot], low = n.low[slot], high = n.high[slot];
  const double height = dot(Vec3{n.normal_x[slot], n.normal_y[slot], n.normal_z[slot]}, d), d_sq = length_sq(d);
  const double along = std::max(std::abs(height + low), std::abs(height + high));
  const double across_sq = std::max(0.0, d_sq - height * height) + d_sq * double{base::across_error};
  const double across = std::sqrt(across_sq) + radius;
  return {std::sqrt(d_sq) + radius, std::sqrt(along * along + across * across)};
}

}  // namespace limber::bvh

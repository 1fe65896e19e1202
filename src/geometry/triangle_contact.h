// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/primitives.h"

namespace limber::geometry {

/// Closest features, and what a normal is made of.
struct DirectedFeatures {
  ClosestFeatures closest;
  Vec3 between;           ///< from point_a to point_b, in any unit, with digits that the points may not have
  bool are_proven_apart;  ///< `between` is the normal of a plane that separates the triangles, beyond rounding
};

DirectedFeatures directed_features(const Triangle& a, const Triangle& b);

}  // namespace limber::geometry

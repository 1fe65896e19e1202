// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "geometry/primitives.h"

namespace limber::geometry {

/// Closest features, and what a normal is made of.
struct FeaturesAndDirection {
  ClosestFeatures closest;
  Vec3 a_to_b;            ///< from point_a to point_b in a frame of any scale, with digits that the points may not have
  bool are_proven_apart;  ///< `a_to_b` is the normal of a plane that separates the triangles, beyond rounding
};

/// `a_to_b` is 0 where an edge crosses the middle of a face.
FeaturesAndDirection features_and_direction(const Triangle& a, const Triangle& b);

}  // namespace limber::geometry

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "limber/geometry.h"
#include "limber/math.h"

namespace limber::penetration {

/// When two triangles meet last, if the second one moves along z: an interval of how far it has moved then.
struct LastContact {
  static constexpr double never = -std::numeric_limits<double>::infinity();

  double upper = never;  ///< having moved by more than this, they do not meet
  double lower = never;  ///< having moved by this, they meet, up to the tolerance; `never` if no such move was found
  Vec3 normal;           ///< of the plane that keeps them apart from `upper` on, towards the second one
  Vec3 weights_a, weights_b;  ///< of the corners, for the points that meet at `lower`
};

/// Bounds how far b has to move along z to leave a. Fills all but `lower` and the weights. Ends early once the bound is
/// not above `least`.
///
/// Promise  `upper` holds for all triangles whose corners are within `error` of these. It exceeds the truth by little
///          more than that, also where the triangles are segments or points.
/// Pre      Coordinates are at most about 1 in size, and `error` is at least 2^-46.
LastContact bound_last_contact(const Triangle& a, const Triangle& b, double error, double least = LastContact::never);

/// Fills `lower` and the weights: finds the last points that meet within a tolerance across z.
void find_last_contact(const Triangle& a, const Triangle& b, double tolerance, LastContact& contact);

}  // namespace limber::penetration

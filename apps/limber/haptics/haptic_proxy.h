// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/distance.h"

namespace limber::program {

/// The tool as the user is to feel it: it follows the device, but stops in front of the tissue, and a spring between
/// the two gives the force, as in [Zilles1995] and [Ruspini1997]. It only translates; it is turned as the device is.
///
/// What it concludes from the interval [lower, upper] of the distance between the tissue and the tool at its place:
///
/// - No point of either is closer than `lower`. A step shorter than that cannot make the tool touch, whatever its
///   direction and however the query ended. A step takes at most half of `lower`, unless it leads back from the
///   witness: the other half is left to what the tissue moves, and the tool turns, before the next query.
/// - The witness points are truly `upper` apart. They give a direction in which tissue is in the way and where to stop,
///   never whether there is room elsewhere.
/// - `beyond_limit` has no witness and needs none: nothing is in the way as far as the step may go.
/// - `interrupted` is no contact. Its `lower` holds like any other; only its witness need not be the closest pair.
/// - With lower == 0, which is contact or says nothing, no step is known to be safe. The proxy goes back a little, in
///   the direction that last led away from the closest point; so it does where `lower` is too small to step back by.
///   Where budgets are too small it so floats at a distance at which they suffice, instead of being caught by tissue
///   that comes up.
///
/// Differs   Both sources find the constraints that stop a point or a sphere, and go to the place nearest to the device
///           that they allow. Here the tool is a mesh, there is one constraint a tick, the plane through the witness,
///           and the step is limited by what the query has certified.
class Proxy {
 public:
  /// `retreat_mm` is how far the proxy goes back in a tick where no step is known to be safe: at least as far as tissue
  /// comes up.
  Proxy(const Vec3& place, double retreat_mm) : place_(place), retreat_(retreat_mm) {}

  /// Where the tool's center is.
  const Vec3& place() const { return place_; }

  /// Moves towards the device and returns the force on the user, in N.
  ///
  /// Pre      `found` is the distance of the tissue (a) and the tool at place() (b).
  Vec3 follow(const Vec3& device, const DistanceResult& found);

 private:
  Vec3 step_towards(const Vec3& device, const DistanceResult& found);

  Vec3 place_;
  double retreat_;
  Vec3 away_{0, 0, 1};  // from the tissue, of length 1, as the last query that was not interrupted has found it
};

inline constexpr double standoff_mm = 0.3;         ///< at which the proxy stops
inline constexpr double stiffness_n_per_mm = 0.5;  ///< of the spring between proxy and device

}  // namespace limber::program

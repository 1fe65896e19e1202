// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "limber/path.h"

namespace limber::motion {

/// Two bodies and how they move. Refers to the motions.
struct MovingBodies {
  Body a;
  const RigidMotion& motion_a;
  Body b;
  const RigidMotion& motion_b;
};

/// How fast the points of a body's core move as seen from the body's center, which turns about itself.
double turning_speed(const Body& body, const RigidMotion& motion);

/// Shadows of two bodies: their images under a map that makes no distance longer, and their relative motion shorter. So
/// the distance of the shadows at one time shows for long that the bodies stay apart, however closely they pass each
/// other: it changes as fast as they approach, not as fast as they move.
///
/// The map shortens straight motion along itself. Or, about the axis of a body that turns, it takes each point to its
/// distance from the axis and its place along it, which turning does not change; what moves along it is shortened.
class Shadow {
 public:
  /// Chooses the map that leaves least of the motion. Of straight motion it leaves at most the speed that is given.
  ///
  /// Pre      0 <= time <= 1, and the speed is above 0.
  /// Alias    Keeps a pointer to the bodies.
  Shadow(const MovingBodies& bodies, double time, double straight_speed);

  /// The distance of the shadows changes by at most so much in a unit of time, before the time and after.
  double speed() const { return speed_; }

  /// A lower bound of the distance of the shadows of both cores at the time, and so of the cores. Nothing where
  /// coordinates are too large or too small for it.
  ///
  /// Throws   As distance(); std::bad_alloc.
  /// Cost     Two models are built: of as many triangles, or of up to four times as many if seen about an axis.
  std::optional<double> distance(const DistanceOptions& options, QueryStats& stats) const;

 private:
  /// Maps about an axis, or along one, if that leaves less of the motion.
  void prefer(bool is_about_axis, const Vec3& origin, const Vec3& axis, double others_speed, double straight_speed);
  std::optional<Model> image(const Body& body, const Transform& pose, double& size) const;

  const MovingBodies* bodies_;
  double time_;
  Vec3 straight_;  ///< the motion of b's center relative to a's
  double speed_ = std::numeric_limits<double>::infinity();
  bool is_about_axis_ = false;
  Vec3 origin_, axis_;
  double shortened_ = 1;  ///< what is left of a length along the axis, as a part of it
};

}  // namespace limber::motion

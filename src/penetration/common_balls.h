// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "limber/math.h"
#include "pair/budget_meter.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::penetration {

/// A point that two bodies have in common, and the largest balls about it in each.
struct CommonBalls {
  Vec3 center;
  double radii = 0;   ///< the sum of both radii
  Vec3 out_a, out_b;  ///< the shortest ways out of both bodies, of length 1
};

/// Looks for balls about a common point of two bodies, as large as possible. Each translation that parts the bodies
/// parts the two balls, so it is at least as long as their radii together.
class CommonBallsSearch {
 public:
  CommonBallsSearch(const point::PlacedModel& a, const point::PlacedModel& b);

  /// The balls about a point; nothing if it is not in both bodies.
  std::optional<CommonBalls> at(const Vec3& point, pair::Meter& meter);

  /// Goes uphill from a point while that makes the balls larger. The first step is at most `reach` long.
  void climb(const Vec3& start, double reach, pair::Meter& meter);

  const std::optional<CommonBalls>& best() const { return best_; }

 private:
  const point::PlacedModel &a_, &b_;
  point::ClosestPointSearch closest_a_, closest_b_;
  std::optional<CommonBalls> best_;
};

}  // namespace limber::penetration

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "limber/math.h"
#include "limber/model.h"
#include "limber/penetration.h"
#include "pair/budget_meter.h"
#include "penetration/common_balls.h"
#include "penetration/sweep.h"
#include "point/placed_model.h"

namespace limber::penetration {

/// Looks for a short translation of a body that makes it apart from another one, and for a lower bound of all of them.
class ShortestTranslation {
 public:
  /// Starts with a translation that parts the bounding spheres.
  ShortestTranslation(const Placed& a, const Placed& b, double relative_error, pair::Meter& meter);

  /// Pre: the bodies have a common point. `deepest` are their deepest vertices.
  void run(const DeepestPair& deepest);

  /// Moved by this, b is apart from a.
  const Vec3& translation() const { return translation_; }
  double upper() const { return upper_; }  ///< at least its length
  double lower() const { return lower_; }  ///< no translation that makes them apart is shorter

 private:
  bool is_done() const;
  bool accept(const Vec3& translation);
  void raise_lower(const DeepestPair& deepest);
  void look_at_contacts();
  void add_directions(const DeepestPair& deepest);
  bool shorten_along(const Vec3& direction, SweepResult& found);
  void refine(Vec3 direction, SweepResult found);
  void look_around();
  void push_out(DeepestPair deepest);

  Placed a_, b_;
  point::PlacedModel placed_a_, placed_b_;
  double relative_error_;
  pair::Meter& meter_;
  Sweep sweep_;
  CommonBallsSearch balls_;
  std::vector<Vec3> starts_, directions_;
  Vec3 translation_;
  double upper_, lower_ = 0;
};

/// The deepest vertices of two placed bodies.
DeepestPair find_deepest(const point::PlacedModel& a, const point::PlacedModel& b, pair::Meter& meter);

}  // namespace limber::penetration

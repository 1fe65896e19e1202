// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "geometry/local_frame.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/model.h"

namespace limber::pair {

/// What the radii of two bodies make of the distances and points of their cores, the triangles. Searches are about
/// cores: what matters at a distance does so at core_limit() of it. Without radii, everything stays as it is, to the
/// bit.
class Radii {
 public:
  Radii(double radius_a, double radius_b) : radius_a_(radius_a), radius_b_(radius_b), radius_(radius_a + radius_b) {
    LIMBER_ASSERT(radius_a >= 0 && radius_b >= 0 && radius_ <= 2 * max_coordinate);
  }
  Radii(const Placed& a, const Placed& b) : Radii(a.body().radius(), b.body().radius()) {}

  /// Both radii together.
  double radius() const { return radius_; }
  bool has_radius() const { return radius_ > 0; }

  /// The distance of bodies whose cores are that far apart.
  double distance(double of_cores) const { return std::max(0.0, of_cores - radius_); }
  /// The largest distance of cores whose bodies are at most `distance` apart, as distance() computes it.
  double core_limit(double distance) const {
    if (!has_radius() || distance == 0 || distance >= std::numeric_limits<double>::max()) return radius_ + distance;
    double limit = radius_ + distance;
    while (this->distance(limit) > distance) limit = std::nextafter(limit, 0);
    for (;;) {
      const double next = std::nextafter(limit, std::numeric_limits<double>::infinity());
      if (this->distance(next) > distance) return limit;
      limit = next;
    }
  }

  /// Points of the bodies, for the closest points of their cores and the distance of these. Where the bodies meet, it
  /// is one common point, which divides the way from one core to the other as the radii do.
  template <typename Points>
  void move_points(Points& points, double of_cores) const {
    const Vec3 between = points.point_b - points.point_a;
    if (of_cores <= radius_) {
      points.point_a += between * (has_radius() ? radius_a_ / radius_ : 0);
      points.point_b = points.point_a;
      return;
    }
    if (!has_radius() || max_abs(between) == 0) return;  // cores that rounding has put in one place
    const Vec3 near = geometry::near_unit(between), direction = near * (1 / length(near));
    points.point_a += radius_a_ * direction, points.point_b -= radius_b_ * direction;
  }

  /// The contact of two swept triangles, for that of the triangles.
  template <typename Contact>
  Contact contact(Contact of_cores) const {
    const double distance = of_cores.distance;
    if (!has_radius()) return of_cores;
    of_cores.distance = this->distance(distance);
    if (distance <= radius_) of_cores.depth += radius_ - distance;
    move_points(of_cores, distance);
    return of_cores;
  }

 private:
  double radius_a_, radius_b_, radius_;
};

}  // namespace limber::pair

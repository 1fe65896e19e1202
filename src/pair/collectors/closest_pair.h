// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "base/check.h"
#include "geometry/primitives.h"
#include "limber/distance.h"
#include "pair/collectors/collector.h"

namespace limber::pair {

/// The collector of distance() and within(): the closest pair of triangles, or one that is close enough.
class ClosestPair {
 public:
  static constexpr Hits hits = Hits::closest;
  static constexpr bool is_self = false;

  /// A pair at most `close_enough` apart ends the query. Errors are those of the distance less the radius; they prune
  /// no pair that is at most the radius apart.
  ClosestPair(const DistanceOptions& options, double close_enough, double radius = 0)
      : options_(options), close_enough_(close_enough), radius_(radius) {
    LIMBER_ASSERT(radius >= 0 && radius <= close_enough);
  }

  /// Just above the limit: a pair exactly max_distance apart is an answer.
  double initial_cutoff() const { return std::nextafter(options_.max_distance, infinity); }
  double close_enough() const { return close_enough_; }
  bool is_done() const { return upper <= close_enough_; }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    const ClosestPoints closest = geometry::closest_points(a.corners, b.corners);
    LIMBER_ASSERT(closest.distance >= 0);
    return take(closest.distance, {closest.point_a, closest.point_b, a.id, b.id});
  }

  /// Two points that are so far apart.
  std::optional<BoundUpdate> take(double distance, const Witness& points) {
    if (distance >= upper) return std::nullopt;
    upper = distance;
    witness = points;
    BoundUpdate update{upper, infinity, points.point_b - points.point_a};
    // A pair beyond the limit is no answer, so nothing may be pruned for its sake.
    if (upper <= options_.max_distance) {
      const double gap = upper - radius_, relative = gap / (1 + options_.relative_error) * down_factor();
      const double wanted = std::min(relative, gap - options_.absolute_error);
      update.cutoff = wanted == gap ? upper : std::max(radius_ + wanted, least_cutoff());
    }
    return update;
  }

  double upper = infinity;
  std::optional<Witness> witness;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  double least_cutoff() const { return radius_ > 0 ? std::nextafter(radius_, infinity) : -infinity; }
  double down_factor() const { return options_.relative_error == 0 ? 1 : 1 - 0x1p-51; }

  DistanceOptions options_;
  double close_enough_, radius_;
};

}  // namespace limber::pair

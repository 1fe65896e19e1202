// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "penetration/common_balls.h"

#include <limits>

#include "base/check.h"
#include "geometry/local_frame.h"
#include "point/ray_crossings.h"

namespace limber::penetration {
namespace {

/// A direction of length 1, or 0 for a vector of 0.
Vec3 unit_or_zero(const Vec3& v) {
  if (max_abs(v) == 0) return {};
  const Vec3 scaled = geometry::near_unit(v);
  return scaled * (1 / length(scaled));
}

}  // namespace

CommonBallsSearch::CommonBallsSearch(const point::PlacedModel& a, const point::PlacedModel& b)
    : a_(a), b_(b), closest_a_(a), closest_b_(b) {}

std::optional<CommonBalls> CommonBallsSearch::at(const Vec3& point, Meter& meter) {
  for (const point::PlacedModel* model : {&a_, &b_}) {
    const point::Surrounding surrounding = point::surrounding_of(*model, point, meter.stats);
    if (!surrounding.is_on && surrounding.winding_number == 0) return std::nullopt;
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::optional<SurfacePoint> a = closest_a_.find(point, infinity, meter.stats);
  const std::optional<SurfacePoint> b = closest_b_.find(point, infinity, meter.stats);
  LIMBER_ASSERT(a && b);
  return CommonBalls{point, a->distance + b->distance, a->position, b->position};
}

void CommonBallsSearch::climb(const Vec3& start, Meter& meter) {
  if (meter.is_spent()) return;
  std::optional<CommonBalls> here = at(start, meter);
  if (!here) return;
  // Steps below this part of the radii gain less than twice as much.
  constexpr double least_step = 0x1p-8;
  for (double step = 0.5 * here->radii; step > least_step * here->radii && !meter.is_spent();) {
    const Vec3& p = here->center;
    const Vec3 uphill = unit_or_zero(unit_or_zero(p - here->exit_a) + unit_or_zero(p - here->exit_b));
    const std::optional<CommonBalls> next = at(p + step * uphill, meter);
    if (next && next->radii > here->radii * (1 + 0.1 * least_step)) {
      here = next;
    } else {
      step *= 0.5;
    }
  }
  if (!best_ || here->radii > best_->radii) best_ = here;
}

}  // namespace limber::penetration

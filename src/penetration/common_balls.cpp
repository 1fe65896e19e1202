// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "penetration/common_balls.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "penetration/way_out.h"
#include "point/ray_crossings.h"

namespace limber::penetration {
CommonBallsSearch::CommonBallsSearch(const point::PlacedModel& a, const point::PlacedModel& b)
    : a_(a), b_(b), closest_a_(a), closest_b_(b) {}

std::optional<CommonBalls> CommonBallsSearch::at(const Vec3& point, pair::Meter& meter) {
  for (const point::PlacedModel* model : {&a_, &b_}) {
    if (!point::surrounding_of(*model, point, meter.stats).is_inside_or_on()) return std::nullopt;
  }
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const std::optional<SurfacePoint> a = closest_a_.find(point, infinity, meter.stats);
  const std::optional<SurfacePoint> b = closest_b_.find(point, infinity, meter.stats);
  LIMBER_ASSERT(a && b);
  return CommonBalls{point, a->distance + b->distance, way_out(a_, point, *a), way_out(b_, point, *b)};
}

void CommonBallsSearch::climb(const Vec3& start, double reach, pair::Meter& meter) {
  if (meter.is_spent()) return;
  std::optional<CommonBalls> here = at(start, meter);
  if (!here) return;
  // A step makes the radii larger by twice its length at most. Shorter ones than these gain too little.
  constexpr double least_step = 0x1p-8, least_part_of_reach = 0x1p-16;
  double step = std::min(reach, std::max(here->radii, 0.125 * reach));
  while (step > std::max(least_step * here->radii, least_part_of_reach * reach) && !meter.is_spent()) {
    const Vec3 uphill = -(here->out_a + here->out_b);
    if (length_sq(uphill) < least_step * least_step) break;
    const std::optional<CommonBalls> next = at(here->center + step * unit(uphill), meter);
    if (next && next->radii > here->radii + 0.125 * step) {
      here = next;
    } else {
      step *= 0.5;
    }
  }
  if (!best_ || here->radii > best_->radii) best_ = here;
}

}  // namespace limber::penetration

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions of motion.h for elements.
#include "motion/element_impact.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "motion/exact_impact.h"
#include "motion/impact_filter.h"
#include "motion/moving_elements.h"
#include "motion/moving_vectors.h"
#include "motion/precise_volume.h"
#include "motion/separation_search.h"

namespace limber {
namespace motion {
namespace {

bool are_in_range(const MovingElements& e) {
  const auto is_in_range = [](const Vec3& p) { return is_finite(p) && max_abs(p) <= max_coordinate; };
  return std::all_of(std::begin(e.corners[0]), std::end(e.corners[0]), is_in_range) &&
         std::all_of(std::begin(e.corners[1]), std::end(e.corners[1]), is_in_range);
}

/// narrow_exactly(), with as few digits as are needed. Pre: as there, and both signs are certain in float64.
void narrow(const MovingElements& elements, double time_error, double& lower, double& upper) {
  constexpr int most_guesses = 6;  // the first is nearly always right
  const double wanted = std::max(time_error, time_resolution);
  const PreciseVolume volume(elements);
  double at_lower = volume.at(lower), at_upper = volume.at(upper);
  LIMBER_ASSERT(at_lower * at_upper < 0);
  // Makes a time between the ends one of them. Returns one step towards the root; 0 if its side is not certain.
  const auto split_at = [&](double time) {
    if (time <= lower) return time_resolution;
    if (time >= upper) return -time_resolution;
    const double value = volume.at(time);
    if (value == 0) return 0.0;
    const bool is_before = (value < 0) == (at_lower < 0);
    (is_before ? lower : upper) = time, (is_before ? at_lower : at_upper) = value;
    return is_before ? time_resolution : -time_resolution;
  };
  for (int guesses = 0; upper - lower > wanted; ++guesses) {
    // Where the line through both values is 0, then beside it.
    const double guess = lower + (upper - lower) * (at_lower / (at_lower - at_upper));
    const double time = std::round(guess / time_resolution) * time_resolution;
    const double step = split_at(time);
    if (guesses == most_guesses || step == 0 || split_at(time + step) == 0) {
      return narrow_exactly(elements, time_error, lower, upper);
    }
  }
}

}  // namespace

void check(const ElementImpactOptions& options, const char* function) {
  const auto require = [&](bool holds, const char* what) {
    LIMBER_REQUIRE(holds, (std::string(function) + ": " + what).c_str());
  };
  require(options.max_time >= 0 && options.max_time <= 1, "max_time is not in [0, 1]");
  require(options.time_error >= 0, "time_error is negative or not a number");
  require(options.min_separation >= 0 && options.min_separation <= max_coordinate,
          "min_separation is not in [0, 2^200]");
}

ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options) {
  if (options.min_separation > 0) return separation_impact(elements, options);
  FilterResult found = filter_impact(elements, options);
  switch (found.verdict) {
    case FilterResult::Verdict::clear:
      return {};
    case FilterResult::Verdict::contact:
      if (found.upper - found.lower > std::max(options.time_error, time_resolution)) {
        narrow(elements, options.time_error, found.lower, found.upper);
      }
      return {ImpactStatus::contact, found.lower, found.upper};
    case FilterResult::Verdict::unknown:
      break;
  }
  // The filter looks at signs of volumes, which say nothing of elements that stay in one plane.
  if (are_certainly_apart(elements, options.max_time)) return {};
  return exact_impact(elements, options);
}

namespace {

ElementImpact checked_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  LIMBER_REQUIRE(are_in_range(elements), "limber::time_of_impact: a coordinate is not finite, or above 2^200 in size");
  check(options, "limber::time_of_impact");
  return impact_of(elements, options);
}

}  // namespace
}  // namespace motion

ElementImpact time_of_impact(const MovingPoint& point, const MovingTriangle& triangle,
                             const ElementImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return environment.computed_before_restore(
      motion::checked_impact(motion::MovingElements::of(point, triangle), options));
}

ElementImpact time_of_impact(const MovingSegment& a, const MovingSegment& b, const ElementImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return environment.computed_before_restore(motion::checked_impact(motion::MovingElements::of(a, b), options));
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions of motion.h for elements.
#include "motion/element_impact.h"

#include <algorithm>
#include <iterator>
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "motion/exact_impact.h"
#include "motion/impact_filter.h"
#include "motion/moving_elements.h"
#include "motion/precise_root.h"
#include "motion/separation_search.h"

namespace limber {
namespace motion {
namespace {

bool are_in_range(const MovingElements& e) {
  const auto is_in_range = [](const Vec3& p) { return is_finite(p) && max_abs(p) <= max_coordinate; };
  return std::all_of(std::begin(e.corners[0]), std::end(e.corners[0]), is_in_range) &&
         std::all_of(std::begin(e.corners[1]), std::end(e.corners[1]), is_in_range);
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
        if (const auto root = narrow_precisely(elements, found.lower, found.upper)) return *root;
        narrow_exactly(elements, options.time_error, found.lower, found.upper);
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

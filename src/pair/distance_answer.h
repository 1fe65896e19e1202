// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "limber/distance.h"
#include "pair/collectors/closest_pair.h"
#include "pair/radii.h"
#include "pair/search.h"

namespace limber::pair {

inline DistanceStatus status_of(const DistanceResult& result) {
  if (result.upper == 0) return DistanceStatus::collision;
  if (result.stopped_by != StoppedBy::nothing) return DistanceStatus::interrupted;
  return result.lower == result.upper ? DistanceStatus::exact : DistanceStatus::within_error;
}

/// Whether an interval is as narrow as the errors allow. One that begins at 0 is not, whatever the errors: it leaves
/// open whether the models meet.
inline bool is_narrow_enough(const DistanceResult& result, const DistanceOptions& options) {
  if (result.lower == 0 && result.upper > 0) return false;
  return result.upper / (1 + options.relative_error) <= result.lower ||
         result.upper - result.lower <= options.absolute_error;
}

/// Writes what a search for the closest pair of the cores has found. A budget may be spent just when the errors are
/// met; then the query has its answer.
inline void set_answer(DistanceResult& result, const ClosestPair& collector, const Unsearched& unsearched,
                       const DistanceOptions& options, const Radii& radii = {0, 0}) {
  result.stopped_by = unsearched.stopped_by;
  const bool is_beyond = !collector.witness || radii.distance(collector.upper) > options.max_distance;
  if (is_beyond && unsearched.stopped_by == StoppedBy::nothing) {
    result.upper = std::numeric_limits<double>::infinity();
    result.lower = options.max_distance;
    result.status = DistanceStatus::beyond_limit;
    return;
  }
  result.upper = radii.distance(collector.upper);
  result.lower = radii.distance(std::min(collector.upper, unsearched.distance));
  result.witness = collector.witness;
  if (result.witness) radii.move_points(*result.witness, collector.upper);
  if (result.upper <= options.max_distance && is_narrow_enough(result, options)) result.stopped_by = StoppedBy::nothing;
  result.status = status_of(result);
}

}  // namespace limber::pair

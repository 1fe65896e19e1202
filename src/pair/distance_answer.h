// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <limits>

#include "limber/distance.h"
#include "pair/collectors/closest_pair.h"
#include "pair/search.h"

namespace limber::pair {

inline Status status_of(const DistanceResult& result) {
  if (result.upper == 0) return Status::collision;
  if (result.stopped_by != StoppedBy::nothing) return Status::interrupted;
  return result.lower == result.upper ? Status::exact : Status::within_error;
}

/// Writes what a search for the closest pair has found.
inline void set_answer(DistanceResult& result, const ClosestPair& collector, const Unsearched& unsearched,
                       double max_distance) {
  result.stopped_by = unsearched.stopped_by;
  if ((!collector.witness || collector.upper > max_distance) && unsearched.stopped_by == StoppedBy::nothing) {
    result.upper = std::numeric_limits<double>::infinity();
    result.lower = max_distance;
    result.status = Status::beyond_limit;
    return;
  }
  result.upper = collector.upper;
  result.lower = std::min(collector.upper, unsearched.distance);
  result.witness = collector.witness;
  result.status = status_of(result);
}

}  // namespace limber::pair

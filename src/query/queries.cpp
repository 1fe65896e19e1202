// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries: each checks its arguments, and searches with a goal.
#include <algorithm>
#include <limits>

#include "core/float_environment.h"
#include "limber/model.h"
#include "query/goals/any_contact.h"
#include "query/goals/closest_pair.h"
#include "query/options.h"
#include "query/search.h"

namespace limber {
namespace {

CollideResult collide(const Placed& a, const Placed& b, QueryCache* cache) {
  const core::DefaultFloatEnvironment environment;
  const query::PlacedModels placed(a, b);
  CollideResult result;
  query::AnyContact goal;
  query::search(placed, cache, goal, result.stats);
  result.collision = goal.witness.has_value();
  result.witness = goal.witness;
  if (goal.witness) query::remember(cache, *goal.witness);
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, QueryCache* cache) {
  const core::DefaultFloatEnvironment environment;
  query::check_options(options);
  const query::PlacedModels placed(a, b);
  DistanceResult result;
  query::ClosestPair goal(options, 0);
  const double prune_distance = query::search(placed, cache, goal, result.stats);
  if (goal.upper > options.max_distance) {
    result.upper = std::numeric_limits<double>::infinity();
    result.lower = options.max_distance;
    result.status = Status::beyond_limit;
    return result;
  }
  query::remember(cache, *goal.witness);
  result.upper = goal.upper;
  result.lower = std::min(goal.upper, prune_distance);
  result.witness = goal.witness;
  if (result.upper == 0) {
    result.status = Status::collision;
  } else {
    result.status = result.lower == result.upper ? Status::exact : Status::within_error;
  }
  return result;
}

WithinResult within(const Placed& a, const Placed& b, double max_distance, QueryCache* cache) {
  const core::DefaultFloatEnvironment environment;
  query::check_max_distance(max_distance);
  const query::PlacedModels placed(a, b);
  WithinResult result;
  query::ClosestPair goal({.max_distance = max_distance}, max_distance);
  query::search(placed, cache, goal, result.stats);
  result.within = goal.upper <= max_distance;
  if (!result.within) return result;
  result.witness = goal.witness;
  query::remember(cache, *goal.witness);
  return result;
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) { return collide(a, b, nullptr); }
CollideResult collide(const Placed& a, const Placed& b, QueryCache& cache) { return collide(a, b, &cache); }

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  return distance(a, b, options, nullptr);
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, QueryCache& cache) {
  return distance(a, b, options, &cache);
}

WithinResult within(const Placed& a, const Placed& b, double max_distance) {
  return within(a, b, max_distance, nullptr);
}
WithinResult within(const Placed& a, const Placed& b, double max_distance, QueryCache& cache) {
  return within(a, b, max_distance, &cache);
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries: each checks its arguments, and searches with a collector.
#include <algorithm>
#include <limits>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/collectors/any_contact.h"
#include "pair/collectors/closest_pair.h"
#include "pair/distance_answer.h"
#include "pair/search.h"

namespace limber {
namespace {

using pair::BudgetMeter;

/// The answer of a search that has stopped with this witness, or with none.
CollideResult answer_of(const std::optional<Witness>& witness, StoppedBy stopped_by, const QueryStats& stats) {
  if (witness) return {Answer::yes, witness, StoppedBy::nothing, stats};
  return {stopped_by == StoppedBy::nothing ? Answer::no : Answer::unknown, std::nullopt, stopped_by, stats};
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  BudgetMeter meter(options.budget);
  QueryStats stats;
  pair::AnyContact collector;
  const StoppedBy stopped_by = pair::search(placed, options.cache, collector, meter, stats).stopped_by;
  if (collector.witness) pair::remember(options.cache, *collector.witness);
  return answer_of(collector.witness, stopped_by, stats);
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::distance");
  const pair::PlacedPair placed(a, b);
  BudgetMeter meter(options.budget);
  DistanceResult result;
  pair::ClosestPair collector(options, 0);
  const pair::Unsearched unsearched = pair::search(placed, options.cache, collector, meter, result.stats);
  pair::set_answer(result, collector, unsearched, options);
  if (result.witness) pair::remember(options.cache, *result.witness);
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  const pair::PlacedPair placed(a, b);
  BudgetMeter meter(options.budget);
  QueryStats stats;
  pair::ClosestPair collector({.max_distance = max_distance}, max_distance);
  // So that the answer is that of comparing all pairs, whatever comes first.
  const StoppedBy stopped_by =
      pair::search(placed, options.cache, collector, meter, stats, pair::Ties::compared).stopped_by;
  if (collector.upper > max_distance) return answer_of(std::nullopt, stopped_by, stats);
  pair::remember(options.cache, *collector.witness);
  return answer_of(collector.witness, stopped_by, stats);
}

}  // namespace limber

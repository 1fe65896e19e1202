// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries: each checks its arguments, and searches with a collector.
#include <algorithm>
#include <limits>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "limber/model.h"
#include "pair/collectors/any_contact.h"
#include "pair/collectors/closest_pair.h"
#include "pair/distance_answer.h"
#include "pair/search.h"

namespace limber {
namespace {

using pair::BudgetMeter;

/// Looks for a contact: there is a witness exactly if one was found.
StoppedBy find_contact(const Placed& a, const Placed& b, BudgetMeter& meter, QueryCache* cache,
                       std::optional<Witness>& witness, QueryStats& stats) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  pair::AnyContact collector;
  const StoppedBy stopped_by = pair::search(placed, cache, collector, meter, stats).stopped_by;
  if (collector.witness) pair::remember(cache, *collector.witness);
  witness = collector.witness;
  return stopped_by;
}

/// Looks for a pair of points at most so far apart: there is a witness exactly if one was found.
StoppedBy find_within(const Placed& a, const Placed& b, double max_distance, BudgetMeter& meter, QueryCache* cache,
                      std::optional<Witness>& witness, QueryStats& stats) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  const pair::PlacedPair placed(a, b);
  pair::ClosestPair collector({.max_distance = max_distance}, max_distance);
  // So that the answer is that of comparing all pairs, whatever comes first.
  const StoppedBy stopped_by = pair::search(placed, cache, collector, meter, stats, pair::Ties::compared).stopped_by;
  if (collector.upper > max_distance) return stopped_by;
  pair::remember(cache, *collector.witness);
  witness = collector.witness;
  return stopped_by;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, BudgetMeter& meter,
                        QueryCache* cache) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::distance");
  const pair::PlacedPair placed(a, b);
  DistanceResult result;
  pair::ClosestPair collector(options, 0);
  const pair::Unsearched unsearched = pair::search(placed, cache, collector, meter, result.stats);
  pair::set_answer(result, collector, unsearched, options.max_distance);
  if (result.witness) pair::remember(cache, *result.witness);
  return result;
}

CollideResult collide(const Placed& a, const Placed& b, QueryCache* cache) {
  CollideResult result;
  BudgetMeter meter;
  find_contact(a, b, meter, cache, result.witness, result.stats);
  result.collision = result.witness.has_value();
  return result;
}

WithinResult within(const Placed& a, const Placed& b, double max_distance, QueryCache* cache) {
  WithinResult result;
  BudgetMeter meter;
  find_within(a, b, max_distance, meter, cache, result.witness, result.stats);
  result.within = result.witness.has_value();
  return result;
}

Answer answer_of(const BudgetedAnswer& result) {
  if (result.witness) return Answer::yes;
  return result.stopped_by == StoppedBy::nothing ? Answer::no : Answer::unknown;
}

BudgetedAnswer collide(const Placed& a, const Placed& b, const QueryBudget& budget, QueryCache* cache) {
  BudgetedAnswer result;
  BudgetMeter meter(budget);
  result.stopped_by = find_contact(a, b, meter, cache, result.witness, result.stats);
  result.answer = answer_of(result);
  return result;
}

BudgetedAnswer within(const Placed& a, const Placed& b, double max_distance, const QueryBudget& budget,
                      QueryCache* cache) {
  BudgetedAnswer result;
  BudgetMeter meter(budget);
  result.stopped_by = find_within(a, b, max_distance, meter, cache, result.witness, result.stats);
  result.answer = answer_of(result);
  return result;
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b) { return collide(a, b, nullptr); }
CollideResult collide(const Placed& a, const Placed& b, QueryCache& cache) { return collide(a, b, &cache); }
BudgetedAnswer collide(const Placed& a, const Placed& b, const QueryBudget& budget) {
  return collide(a, b, budget, nullptr);
}
BudgetedAnswer collide(const Placed& a, const Placed& b, const QueryBudget& budget, QueryCache& cache) {
  return collide(a, b, budget, &cache);
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  BudgetMeter meter;
  return distance(a, b, options, meter, nullptr);
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, QueryCache& cache) {
  BudgetMeter meter;
  return distance(a, b, options, meter, &cache);
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, const QueryBudget& budget) {
  BudgetMeter meter(budget);
  return distance(a, b, options, meter, nullptr);
}
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, const QueryBudget& budget,
                        QueryCache& cache) {
  BudgetMeter meter(budget);
  return distance(a, b, options, meter, &cache);
}

WithinResult within(const Placed& a, const Placed& b, double max_distance) {
  return within(a, b, max_distance, nullptr);
}
WithinResult within(const Placed& a, const Placed& b, double max_distance, QueryCache& cache) {
  return within(a, b, max_distance, &cache);
}
BudgetedAnswer within(const Placed& a, const Placed& b, double max_distance, const QueryBudget& budget) {
  return within(a, b, max_distance, budget, nullptr);
}
BudgetedAnswer within(const Placed& a, const Placed& b, double max_distance, const QueryBudget& budget,
                      QueryCache& cache) {
  return within(a, b, max_distance, budget, &cache);
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for all pairs, and those of one model with itself: each checks its arguments, and searches with a
// collector.
#include <algorithm>
#include <atomic>
#include <limits>

#include "base/access.h"
#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/span_filler.h"
#include "limber/contacts.h"
#include "pair/collectors/all_intersections.h"
#include "pair/collectors/closest_pairs.h"
#include "pair/collectors/pairs_within.h"
#include "pair/collectors/self_pairs.h"
#include "pair/distance_answer.h"
#include "pair/parts.h"
#include "pair/placed_self_intersections.h"
#include "pair/search.h"

namespace limber {
namespace {

using pair::PairsOfOne;
using pair::PairsOfTwo;

/// A model twice in the same place.
pair::PlacedPair with_itself(const Model& model) { return {Placed{model}, Placed{model}}; }

template <typename Pairs>
PairCount visit_intersections(const pair::PlacedPair& placed, const Pairs& pairs, TrianglePairVisitor visit,
                              const PairOptions& options) {
  using Collector = pair::AllIntersections<Pairs>;
  const auto make = [&](TrianglePairVisitor visitor) { return Collector(pairs, visitor); };
  return pair::visit_all<Collector, TrianglePair>(placed, make, visit, options);
}

template <typename Pairs>
PairCount visit_contacts(const pair::PlacedPair& placed, const Pairs& pairs, double margin, ContactVisitor visit,
                         const PairOptions& options) {
  using Collector = pair::PairsWithin<Pairs>;
  const auto make = [&](ContactVisitor visitor) { return Collector(pairs, margin, visitor); };
  return pair::visit_all<Collector, Contact>(placed, make, visit, options);
}

template <typename Pairs>
PairCount closest_pairs(const pair::PlacedPair& placed, const Pairs& pairs, std::span<Contact> closest,
                        const ClosestPairsOptions& options) {
  pair::ClosestPairs<Pairs> collector(pairs, closest, options.max_distance);
  PairCount result;
  pair::BudgetMeter meter(options.budget);
  if constexpr (Pairs::is_self) {
    result.stopped_by = pair::search_self(placed, nullptr, collector, meter, result.stats).stopped_by;
  } else {
    result.stopped_by = pair::search(placed, nullptr, collector, meter, result.stats).stopped_by;
  }
  result.count = collector.count;
  result.is_complete = result.stopped_by == StoppedBy::nothing;
  if (options.budget.abandon == nullptr || !*options.budget.abandon) collector.sort();
  return result;
}

/// The collector of intersect_in_parts(): all parts end when one has found a pair.
template <typename Pairs>
class AnyIntersection {
 public:
  static constexpr pair::Hits hits = pair::Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  AnyIntersection(const Pairs& pairs, std::atomic<bool>& has_found) : pairs_(pairs), has_found_(has_found) {}

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return has_found_.load(std::memory_order_relaxed); }

  void compare(const pair::PlacedTriangle& a, const pair::PlacedTriangle& b) {
    if (pairs_.meet(a, b)) has_found_.store(true, std::memory_order_relaxed);
  }

 private:
  const Pairs& pairs_;
  std::atomic<bool>& has_found_;
};

template <typename Pairs>
bool any_in_parts(const pair::PlacedPair& placed, const Pairs& pairs, const QueryBudget& budget, QueryStats& stats) {
  struct Nothing {};
  using Collector = AnyIntersection<Pairs>;
  std::atomic<bool> has_found = false;
  pair::search_all_in_parts<Collector, Nothing>(
      placed, [&](Nothing&) { return Collector(pairs, has_found); }, budget, stats);
  return has_found;
}

PairOptions pair_options(const ClosestPairsOptions& options) {
  return {.filter = options.filter, .oriented_faces = options.oriented_faces};
}

}  // namespace

StoppedBy pair::visit_placed_self_intersections(const Placed& model, TrianglePairVisitor visit,
                                                const QueryBudget& budget, QueryStats& stats) {
  AllIntersections<PairsOfOne> collector(PairsOfOne(model.model().mesh(), {}), visit);
  BudgetMeter meter(budget);
  return search_all(PlacedPair(model, model), collector, meter, stats);
}

bool pair::intersect_in_parts(const Placed& a, const Placed& b, bool is_self, const QueryBudget& budget,
                              QueryStats& stats) {
  if (!is_self) return any_in_parts(PlacedPair(a, b), PairsOfTwo(a, b, {}), budget, stats);
  const Placed model{a.model()};
  return any_in_parts(PlacedPair(model, model), PairsOfOne(a.model().mesh(), {}), budget, stats);
}

PairCount visit_intersections(const Placed& a, const Placed& b, TrianglePairVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  const PairsOfTwo pairs(a, b, options);
  if (!pair::Radii(a, b).has_radius()) return visit_intersections(placed, pairs, visit, options);
  const auto visit_pair = [&](const Contact& contact) { return visit({contact.triangle_a, contact.triangle_b}); };
  return visit_contacts(placed, pairs, 0, visit_pair, options);
}

PairCount intersections(const Placed& a, const Placed& b, std::span<TrianglePair> pairs, const PairOptions& options) {
  base::SpanFiller<TrianglePair> fill(pairs);
  return visit_intersections(a, b, fill, options);
}

PairCount visit_contacts(const Placed& a, const Placed& b, double margin, ContactVisitor visit,
                         const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_contacts");
  return visit_contacts(pair::PlacedPair(a, b), PairsOfTwo(a, b, options), margin, visit, options);
}

PairCount contacts(const Placed& a, const Placed& b, double margin, std::span<Contact> contacts,
                   const PairOptions& options) {
  base::SpanFiller<Contact> fill(contacts);
  return visit_contacts(a, b, margin, fill, options);
}

PairCount closest_pairs(const Placed& a, const Placed& b, std::span<Contact> closest,
                        const ClosestPairsOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_limit(options.max_distance, "limber::closest_pairs");
  const PairsOfTwo pairs(a, b, pair_options(options));
  return closest_pairs(pair::PlacedPair(a, b), pairs, closest, options);
}

CollideResult self_collide(const Model& model, const SelfQueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed = with_itself(model);
  pair::AnySelfContact collector(PairsOfOne(model.mesh(), {.filter = options.filter}));
  CollideResult result;
  const QueryCache::Impl* const last = options.cache == nullptr ? nullptr : &Access::impl(*options.cache);
  if (pair::has_self_pair(last, placed)) {
    ++result.stats.primitive_tests;
    collector.compare(pair::placed_triangle(placed, pair::Side::a, last->triangle_a),
                      pair::placed_triangle(placed, pair::Side::b, last->triangle_b));
  }
  pair::BudgetMeter meter(options.budget);
  if (!collector.is_done()) pair::search_all(placed, collector, meter, result.stats);
  if (collector.witness) pair::remember(options.cache, *collector.witness);
  if (!collector.witness) result.stopped_by = meter.stopped_by();
  const bool is_undecided = result.stopped_by != StoppedBy::nothing;
  result.answer = collector.witness ? Answer::yes : is_undecided ? Answer::undecided : Answer::no;
  result.witness = collector.witness;
  return result;
}

DistanceResult self_distance(const Model& model, const SelfDistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const DistanceOptions errors{options.relative_error, options.absolute_error, options.max_distance};
  base::check_options(errors, "limber::self_distance");
  const pair::PlacedPair placed = with_itself(model);
  pair::ClosestSelfPair collector(PairsOfOne(model.mesh(), {.filter = options.filter}), errors);
  DistanceResult result;
  const QueryCache::Impl* const last = options.cache == nullptr ? nullptr : &Access::impl(*options.cache);
  pair::BudgetMeter meter(options.budget);
  const pair::Unsearched unsearched = pair::search_self(placed, last, collector, meter, result.stats);
  pair::set_answer(result, collector.closest, unsearched, errors);
  if (result.witness) pair::remember(options.cache, *result.witness);
  return result;
}

PairCount visit_self_intersections(const Model& model, TrianglePairVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return visit_intersections(with_itself(model), PairsOfOne(model.mesh(), options), visit, options);
}

PairCount self_intersections(const Model& model, std::span<TrianglePair> pairs, const PairOptions& options) {
  base::SpanFiller<TrianglePair> fill(pairs);
  return visit_self_intersections(model, fill, options);
}

PairCount visit_self_contacts(const Model& model, double margin, ContactVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_self_contacts");
  return visit_contacts(with_itself(model), PairsOfOne(model.mesh(), options), margin, visit, options);
}

PairCount self_contacts(const Model& model, double margin, std::span<Contact> contacts, const PairOptions& options) {
  base::SpanFiller<Contact> fill(contacts);
  return visit_self_contacts(model, margin, fill, options);
}

PairCount self_closest_pairs(const Model& model, std::span<Contact> closest, const ClosestPairsOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_limit(options.max_distance, "limber::self_closest_pairs");
  return closest_pairs(with_itself(model), PairsOfOne(model.mesh(), pair_options(options)), closest, options);
}

}  // namespace limber

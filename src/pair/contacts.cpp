// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for all pairs, and those of one model with itself: each checks its arguments, and searches with a
// collector.
#include <algorithm>
#include <limits>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/span_filler.h"
#include "limber/contacts.h"
#include "pair/collectors/all_intersections.h"
#include "pair/collectors/closest_pairs.h"
#include "pair/collectors/pairs_within.h"
#include "pair/collectors/self_pairs.h"
#include "pair/distance_answer.h"
#include "pair/search.h"

namespace limber {
namespace {

using pair::PairsOfOne;
using pair::PairsOfTwo;

/// A model twice in the same place.
pair::PlacedPair with_itself(const Model& model) { return {Placed{model}, Placed{model}}; }

template <typename Collector>
PairCount count_all(const pair::PlacedPair& placed, Collector& collector) {
  PairCount result;
  pair::search_all(placed, collector, result.stats);
  result.count = collector.count;
  result.is_complete = !collector.is_done();
  return result;
}

template <typename Pairs>
PairCount visit_intersections(const pair::PlacedPair& placed, const Pairs& pairs, TrianglePairVisitor visit) {
  pair::AllIntersections<Pairs> collector(pairs, visit);
  return count_all(placed, collector);
}

template <typename Pairs>
PairCount visit_contacts(const pair::PlacedPair& placed, const Pairs& pairs, double margin, ContactVisitor visit) {
  pair::PairsWithin<Pairs> collector(pairs, margin, visit);
  return count_all(placed, collector);
}

template <typename Pairs>
PairCount closest_pairs(const pair::PlacedPair& placed, const Pairs& pairs, std::span<Contact> closest) {
  pair::ClosestPairs<Pairs> collector(pairs, closest);
  PairCount result;
  if constexpr (Pairs::is_self) {
    pair::search_self(placed, nullptr, collector, result.stats);
  } else {
    pair::BudgetMeter meter;  // without limits
    pair::search(placed, nullptr, collector, meter, result.stats);
  }
  result.count = collector.count;
  collector.sort();
  return result;
}

}  // namespace

PairCount visit_intersections(const Placed& a, const Placed& b, TrianglePairVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return visit_intersections(pair::PlacedPair(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), visit);
}

PairCount intersections(const Placed& a, const Placed& b, std::span<TrianglePair> pairs, const PairOptions& options) {
  base::SpanFiller<TrianglePair> fill(pairs);
  return visit_intersections(a, b, fill, options);
}

PairCount visit_contacts(const Placed& a, const Placed& b, double margin, ContactVisitor visit,
                         const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_contacts");
  return visit_contacts(pair::PlacedPair(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), margin, visit);
}

PairCount contacts(const Placed& a, const Placed& b, double margin, std::span<Contact> contacts,
                   const PairOptions& options) {
  base::SpanFiller<Contact> fill(contacts);
  return visit_contacts(a, b, margin, fill, options);
}

PairCount closest_pairs(const Placed& a, const Placed& b, std::span<Contact> closest, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return closest_pairs(pair::PlacedPair(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), closest);
}

CollideResult self_collide(const Model& model, const SelfQueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed = with_itself(model);
  pair::AnySelfContact collector(PairsOfOne(model.mesh(), {.filter = options.filter}));
  CollideResult result;
  const QueryCache::Impl* const last = options.cache == nullptr ? nullptr : &options.cache->impl();
  if (pair::has_self_pair(last, placed)) {
    ++result.stats.triangle_tests;
    collector.compare(pair::placed_triangle(placed, pair::Side::a, last->triangle_a),
                      pair::placed_triangle(placed, pair::Side::b, last->triangle_b));
  }
  if (!collector.is_done()) pair::search_all(placed, collector, result.stats);
  if (collector.witness) pair::remember(options.cache, *collector.witness);
  result.answer = collector.witness ? Answer::yes : Answer::no;
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
  const QueryCache::Impl* const last = options.cache == nullptr ? nullptr : &options.cache->impl();
  const pair::Unsearched unsearched = pair::search_self(placed, last, collector, result.stats);
  pair::set_answer(result, collector.closest, unsearched, errors);
  if (result.witness) pair::remember(options.cache, *result.witness);
  return result;
}

PairCount visit_self_intersections(const Model& model, TrianglePairVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return visit_intersections(with_itself(model), PairsOfOne(model.mesh(), options), visit);
}

PairCount self_intersections(const Model& model, std::span<TrianglePair> pairs, const PairOptions& options) {
  base::SpanFiller<TrianglePair> fill(pairs);
  return visit_self_intersections(model, fill, options);
}

PairCount visit_self_contacts(const Model& model, double margin, ContactVisitor visit, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_self_contacts");
  return visit_contacts(with_itself(model), PairsOfOne(model.mesh(), options), margin, visit);
}

PairCount self_contacts(const Model& model, double margin, std::span<Contact> contacts, const PairOptions& options) {
  base::SpanFiller<Contact> fill(contacts);
  return visit_self_contacts(model, margin, fill, options);
}

PairCount self_closest_pairs(const Model& model, std::span<Contact> closest, const PairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return closest_pairs(with_itself(model), PairsOfOne(model.mesh(), options), closest);
}

}  // namespace limber

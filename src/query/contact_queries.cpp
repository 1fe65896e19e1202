// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for all pairs, and those of one model with itself: each checks its arguments, and searches with a
// collector.
#include <algorithm>
#include <limits>

#include "core/float_environment.h"
#include "limber/contacts.h"
#include "query/collectors/all_intersections.h"
#include "query/collectors/closest_pairs.h"
#include "query/collectors/pairs_within.h"
#include "query/collectors/self_pairs.h"
#include "query/distance_answer.h"
#include "query/options.h"
#include "query/search.h"
#include "query/span_filler.h"

namespace limber {
namespace {

using query::PairsOfOne;
using query::PairsOfTwo;

/// A model twice in the same place.
query::PlacedModels with_itself(const Model& model) { return {Placed{model}, Placed{model}}; }

template <typename Collector>
PairCount count_all(const query::PlacedModels& placed, Collector& collector) {
  PairCount result;
  query::search_all(placed, collector, result.stats);
  result.count = collector.count;
  result.is_complete = !collector.is_done();
  return result;
}

template <typename Pairs>
PairCount visit_intersections(const query::PlacedModels& placed, const Pairs& pairs, TrianglePairVisitor visit) {
  query::AllIntersections<Pairs> collector(pairs, visit);
  return count_all(placed, collector);
}

template <typename Pairs>
PairCount visit_contacts(const query::PlacedModels& placed, const Pairs& pairs, double margin, ContactVisitor visit) {
  query::PairsWithin<Pairs> collector(pairs, margin, visit);
  return count_all(placed, collector);
}

template <typename Pairs>
PairCount closest_pairs(const query::PlacedModels& placed, const Pairs& pairs, std::span<Contact> closest) {
  query::ClosestPairs<Pairs> collector(pairs, closest);
  PairCount result;
  if constexpr (Pairs::is_self) {
    query::search_self(placed, nullptr, collector, result.stats);
  } else {
    query::BudgetMeter meter;  // without limits
    query::search(placed, nullptr, collector, meter, result.stats);
  }
  result.count = collector.count;
  collector.sort();
  return result;
}

CollideResult self_collide(const Model& model, const PairOptions& options, QueryCache* cache) {
  const core::DefaultFloatEnvironment environment;
  const query::PlacedModels placed = with_itself(model);
  query::AnySelfContact collector(PairsOfOne(model.mesh(), options));
  CollideResult result;
  const QueryCache::Impl* const last = cache == nullptr ? nullptr : &cache->impl();
  if (query::has_self_pair(last, placed)) {
    ++result.stats.triangle_tests;
    collector.compare(query::placed_triangle(placed, query::Side::a, last->triangle_a),
                      query::placed_triangle(placed, query::Side::b, last->triangle_b));
  }
  if (!collector.is_done()) query::search_all(placed, collector, result.stats);
  if (collector.witness) query::remember(cache, *collector.witness);
  result.collision = collector.witness.has_value();
  result.witness = collector.witness;
  return result;
}

DistanceResult self_distance(const Model& model, const DistanceOptions& distance_options, const PairOptions& options,
                             QueryCache* cache) {
  const core::DefaultFloatEnvironment environment;
  query::check_options(distance_options, "limber::self_distance");
  const query::PlacedModels placed = with_itself(model);
  query::ClosestSelfPair collector(PairsOfOne(model.mesh(), options), distance_options);
  DistanceResult result;
  const QueryCache::Impl* const last = cache == nullptr ? nullptr : &cache->impl();
  const query::Unsearched unsearched = query::search_self(placed, last, collector, result.stats);
  query::set_answer(result, collector.closest, unsearched, distance_options.max_distance);
  if (result.witness) query::remember(cache, *result.witness);
  return result;
}

}  // namespace

PairCount visit_intersections(const Placed& a, const Placed& b, TrianglePairVisitor visit, const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  return visit_intersections(query::PlacedModels(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), visit);
}

PairCount intersections(const Placed& a, const Placed& b, std::span<TrianglePair> pairs, const PairOptions& options) {
  query::SpanFiller<TrianglePair> fill(pairs);
  return visit_intersections(a, b, fill, options);
}

PairCount visit_contacts(const Placed& a, const Placed& b, double margin, ContactVisitor visit,
                         const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  query::check_margin(margin, "limber::visit_contacts");
  return visit_contacts(query::PlacedModels(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), margin,
                        visit);
}

PairCount contacts(const Placed& a, const Placed& b, double margin, std::span<Contact> contacts,
                   const PairOptions& options) {
  query::SpanFiller<Contact> fill(contacts);
  return visit_contacts(a, b, margin, fill, options);
}

PairCount closest_pairs(const Placed& a, const Placed& b, std::span<Contact> closest, const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  return closest_pairs(query::PlacedModels(a, b), PairsOfTwo(a.model().mesh(), b.model().mesh(), options), closest);
}

CollideResult self_collide(const Model& model, const PairOptions& options) {
  return self_collide(model, options, nullptr);
}

CollideResult self_collide(const Model& model, const PairOptions& options, QueryCache& cache) {
  return self_collide(model, options, &cache);
}

DistanceResult self_distance(const Model& model, const DistanceOptions& distance_options, const PairOptions& options) {
  return self_distance(model, distance_options, options, nullptr);
}

DistanceResult self_distance(const Model& model, const DistanceOptions& distance_options, const PairOptions& options,
                             QueryCache& cache) {
  return self_distance(model, distance_options, options, &cache);
}

PairCount visit_self_intersections(const Model& model, TrianglePairVisitor visit, const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  return visit_intersections(with_itself(model), PairsOfOne(model.mesh(), options), visit);
}

PairCount self_intersections(const Model& model, std::span<TrianglePair> pairs, const PairOptions& options) {
  query::SpanFiller<TrianglePair> fill(pairs);
  return visit_self_intersections(model, fill, options);
}

PairCount visit_self_contacts(const Model& model, double margin, ContactVisitor visit, const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  query::check_margin(margin, "limber::visit_self_contacts");
  return visit_contacts(with_itself(model), PairsOfOne(model.mesh(), options), margin, visit);
}

PairCount self_contacts(const Model& model, double margin, std::span<Contact> contacts, const PairOptions& options) {
  query::SpanFiller<Contact> fill(contacts);
  return visit_self_contacts(model, margin, fill, options);
}

PairCount self_closest_pairs(const Model& model, std::span<Contact> closest, const PairOptions& options) {
  const core::DefaultFloatEnvironment environment;
  return closest_pairs(with_itself(model), PairsOfOne(model.mesh(), options), closest);
}

}  // namespace limber

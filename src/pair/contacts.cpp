// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for all pairs, and those of one model with itself: each checks its arguments, and searches with a
// collector.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/span_filler.h"
#include "geometry/primitives.h"
#include "limber/contacts.h"
#include "limber/elements.h"
#include "limber/gradients.h"
#include "pair/collectors/elements.h"
#include "pair/collectors/pairs.h"
#include "pair/parts.h"
#include "pair/placed_pair.h"
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

/// The pairs of elements that a part of a search has found.
struct ElementLists {
  base::ListFiller<VertexFacePair> vertex_face;
  base::ListFiller<EdgeEdgePair> edge_edge;
};

/// The two models and the margin of a query for elements.
template <bool is_self>
struct ElementSearch {
  const pair::PlacedPair& placed;
  const MeshEdges &edges_a, &edges_b;
  double margin;

  using Collector = pair::ElementsWithin<is_self, pair::ElementVisitors>;
  Collector collector(VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge) const {
    return Collector(placed, edges_a, edges_b, margin, {visit_vertex_face, visit_edge_edge});
  }
};

template <bool is_self>
ElementPairCount count_elements_in_parts(const ElementSearch<is_self>& search, VertexFaceVisitor visit_vertex_face,
                                         EdgeEdgeVisitor visit_edge_edge, const QueryBudget& budget) {
  using Collector = typename ElementSearch<is_self>::Collector;
  ElementPairCount result;
  const std::vector<ElementLists> parts = pair::search_all_in_parts<Collector, ElementLists>(
      search.placed, [&](ElementLists& lists) { return search.collector(lists.vertex_face, lists.edge_edge); }, budget,
      result.stats);
  result.is_complete = pair::visit_found(parts, visit_vertex_face, result.vertex_face, &ElementLists::vertex_face) &&
                       pair::visit_found(parts, visit_edge_edge, result.edge_edge, &ElementLists::edge_edge);
  return result;
}

template <bool is_self>
ElementPairCount count_elements(const ElementSearch<is_self>& search, VertexFaceVisitor visit_vertex_face,
                                EdgeEdgeVisitor visit_edge_edge, const ElementPairOptions& options) {
  if (pair::runs_in_parallel(options)) {
    return count_elements_in_parts(search, visit_vertex_face, visit_edge_edge, options.budget);
  }
  typename ElementSearch<is_self>::Collector collector = search.collector(visit_vertex_face, visit_edge_edge);
  ElementPairCount result;
  pair::BudgetMeter meter(options.budget);
  result.stopped_by = pair::search_all(search.placed, collector, meter, result.stats);
  result.vertex_face = collector.vertex_face_count, result.edge_edge = collector.edge_edge_count;
  result.is_complete = !collector.is_done() && result.stopped_by == StoppedBy::nothing;
  return result;
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
  std::optional<Witness> witness;
  const auto take = [&](const TrianglePair& found) {
    const Vec3 shared =
        geometry::shared_point(placed.triangle(pair::Side::a, found.a), placed.triangle(pair::Side::b, found.b));
    witness = Witness{shared, shared, found.a, found.b};
    return false;
  };
  pair::AllIntersections<PairsOfOne> collector(PairsOfOne(model.mesh(), {.filter = options.filter}), take);
  QueryStats stats;
  const QueryCache::Impl* const last = options.cache == nullptr ? nullptr : &Access::impl(*options.cache);
  if (pair::has_self_pair(last, placed)) {
    ++stats.primitive_tests;
    collector.compare(pair::placed_triangle(placed, pair::Side::a, last->triangle_a),
                      pair::placed_triangle(placed, pair::Side::b, last->triangle_b));
  }
  pair::BudgetMeter meter(options.budget);
  if (!collector.is_done()) pair::search_all(placed, collector, meter, stats);
  if (witness) pair::remember(options.cache, *witness);
  return pair::answer_of(witness, meter.stopped_by(), stats);
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

TriangleContact contact_of(const Placed& a, const Placed& b, const Witness& witness) {
  using pair::Side;
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  LIMBER_REQUIRE(placed.has_triangle(Side::a, witness.triangle_a), "limber::contact_of: a has no such triangle");
  LIMBER_REQUIRE(placed.has_triangle(Side::b, witness.triangle_b), "limber::contact_of: b has no such triangle");
  const TriangleContact contact = geometry::contact(placed.triangle(Side::a, witness.triangle_a),
                                                    placed.triangle(Side::b, witness.triangle_b), OrientedFaces::none);
  return environment.computed_before_restore(pair::Radii(a, b).contact(contact));
}

ElementPairCount visit_element_pairs(const Placed& a, const Placed& b, double margin,
                                     VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge,
                                     const ElementPairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_element_pairs");
  for (const Placed& body : {a, b}) base::check_has_no_radius(body, "limber::visit_element_pairs");
  const pair::PlacedPair placed(a, b);
  const ElementSearch<false> search{placed, a.model().edges(), b.model().edges(), margin};
  return count_elements(search, visit_vertex_face, visit_edge_edge, options);
}

ElementPairCount element_pairs(const Placed& a, const Placed& b, double margin, std::span<VertexFacePair> vertex_face,
                               std::span<EdgeEdgePair> edge_edge, const ElementPairOptions& options) {
  base::SpanFiller<VertexFacePair> fill_vertex_face(vertex_face);
  base::SpanFiller<EdgeEdgePair> fill_edge_edge(edge_edge);
  return visit_element_pairs(a, b, margin, fill_vertex_face, fill_edge_edge, options);
}

ElementPairCount visit_self_element_pairs(const Model& model, double margin, VertexFaceVisitor visit_vertex_face,
                                          EdgeEdgeVisitor visit_edge_edge, const ElementPairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_self_element_pairs");
  const pair::PlacedPair placed = with_itself(model);
  const MeshEdges& edges = model.edges();
  const ElementSearch<true> search{placed, edges, edges, margin};
  return count_elements(search, visit_vertex_face, visit_edge_edge, options);
}

ElementPairCount self_element_pairs(const Model& model, double margin, std::span<VertexFacePair> vertex_face,
                                    std::span<EdgeEdgePair> edge_edge, const ElementPairOptions& options) {
  base::SpanFiller<VertexFacePair> fill_vertex_face(vertex_face);
  base::SpanFiller<EdgeEdgePair> fill_edge_edge(edge_edge);
  return visit_self_element_pairs(model, margin, fill_vertex_face, fill_edge_edge, options);
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for pairs of elements: each checks its arguments, and searches with one collector.
#include <cstddef>
#include <vector>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/span_filler.h"
#include "limber/elements.h"
#include "pair/collectors/elements_within.h"
#include "pair/parts.h"
#include "pair/search.h"

namespace limber {
namespace {

/// The pairs of elements that a part of a search has found.
struct ElementLists {
  base::ListFiller<VertexFacePair> vertex_face;
  base::ListFiller<EdgeEdgePair> edge_edge;
};

/// Visits one kind of pairs, part by part, and counts them. Returns whether the visitor wants to go on.
template <typename Pair>
bool visit_parts(const std::vector<ElementLists>& parts, base::ListFiller<Pair> ElementLists::*kind,
                 FunctionRef<bool(const Pair&)> visit, std::size_t& count) {
  for (const ElementLists& part : parts) {
    for (const Pair& found : (part.*kind).list()) {
      ++count;
      if (!visit(found)) return false;
    }
  }
  return true;
}

/// The two models and the margin of a query for elements.
template <bool is_self>
struct ElementSearch {
  const pair::PlacedPair& placed;
  const MeshEdges &edges_a, &edges_b;
  double margin;

  using Collector = pair::ElementsWithin<is_self>;
  Collector collector(VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge) const {
    return Collector(placed, edges_a, edges_b, margin, visit_vertex_face, visit_edge_edge);
  }
};

template <bool is_self>
ElementPairCount count_elements_in_parts(const ElementSearch<is_self>& search, VertexFaceVisitor visit_vertex_face,
                                         EdgeEdgeVisitor visit_edge_edge, const QueryBudget& budget) {
  using Collector = pair::ElementsWithin<is_self>;
  ElementPairCount result;
  const std::vector<ElementLists> parts = pair::search_all_in_parts<Collector, ElementLists>(
      search.placed, [&](ElementLists& lists) { return search.collector(lists.vertex_face, lists.edge_edge); }, budget,
      result.stats);
  result.is_complete = visit_parts(parts, &ElementLists::vertex_face, visit_vertex_face, result.vertex_face) &&
                       visit_parts(parts, &ElementLists::edge_edge, visit_edge_edge, result.edge_edge);
  return result;
}

template <bool is_self>
ElementPairCount count_elements(const ElementSearch<is_self>& search, VertexFaceVisitor visit_vertex_face,
                                EdgeEdgeVisitor visit_edge_edge, const ElementPairOptions& options) {
  if (pair::runs_in_parallel(options)) {
    return count_elements_in_parts(search, visit_vertex_face, visit_edge_edge, options.budget);
  }
  const pair::PlacedPair& placed = search.placed;
  pair::ElementsWithin<is_self> collector = search.collector(visit_vertex_face, visit_edge_edge);
  ElementPairCount result;
  pair::BudgetMeter meter(options.budget);
  result.stopped_by = pair::search_all(placed, collector, meter, result.stats);
  result.vertex_face = collector.vertex_face_count, result.edge_edge = collector.edge_edge_count;
  result.is_complete = !collector.is_done() && result.stopped_by == StoppedBy::nothing;
  return result;
}

}  // namespace

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
  const pair::PlacedPair placed(Placed{model}, Placed{model});
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries for pairs of elements: each checks its arguments, and searches with one collector.
#include <cstddef>
#include <string>

#include "base/arguments.h"
#include "base/float_environment.h"
#include "base/span_filler.h"
#include "limber/elements.h"
#include "pair/collectors/elements_within.h"
#include "pair/search.h"

namespace limber {
namespace {

void check_edges(const MeshEdges& edges, const Mesh& mesh, const char* function, const char* which) {
  LIMBER_REQUIRE(edges.triangle_count() == mesh.triangles().size() && edges.vertex_count() == mesh.positions().size(),
                 (std::string(function) + ": " + which + " must be made of the model's mesh").c_str());
}

template <bool is_self>
ElementPairCount count_elements(const pair::PlacedPair& placed, pair::ElementsWithin<is_self>& collector,
                                const ElementPairOptions& options) {
  ElementPairCount result;
  pair::BudgetMeter meter(options.budget);
  result.stopped_by = pair::search_all(placed, collector, meter, result.stats);
  if (!collector.is_done()) collector.compare_collected();
  result.vertex_face = collector.vertex_face_count, result.edge_edge = collector.edge_edge_count;
  result.is_complete = !collector.is_done() && result.stopped_by == StoppedBy::nothing;
  return result;
}

}  // namespace

ElementPairCount visit_element_pairs(const Placed& a, const MeshEdges& edges_a, const Placed& b,
                                     const MeshEdges& edges_b, double margin, VertexFaceVisitor visit_vertex_face,
                                     EdgeEdgeVisitor visit_edge_edge, const ElementPairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_element_pairs");
  const pair::PlacedPair placed(a, b);
  check_edges(edges_a, a.model().mesh(), "limber::visit_element_pairs", "edges_a");
  check_edges(edges_b, b.model().mesh(), "limber::visit_element_pairs", "edges_b");
  pair::ElementsWithin<false> collector(placed, edges_a, edges_b, margin, visit_vertex_face, visit_edge_edge);
  return count_elements(placed, collector, options);
}

ElementPairCount element_pairs(const Placed& a, const MeshEdges& edges_a, const Placed& b, const MeshEdges& edges_b,
                               double margin, std::span<VertexFacePair> vertex_face, std::span<EdgeEdgePair> edge_edge,
                               const ElementPairOptions& options) {
  base::SpanFiller<VertexFacePair> fill_vertex_face(vertex_face);
  base::SpanFiller<EdgeEdgePair> fill_edge_edge(edge_edge);
  return visit_element_pairs(a, edges_a, b, edges_b, margin, fill_vertex_face, fill_edge_edge, options);
}

ElementPairCount visit_self_element_pairs(const Model& model, const MeshEdges& edges, double margin,
                                          VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge,
                                          const ElementPairOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_margin(margin, "limber::visit_self_element_pairs");
  const pair::PlacedPair placed(Placed{model}, Placed{model});
  check_edges(edges, model.mesh(), "limber::visit_self_element_pairs", "edges");
  pair::ElementsWithin<true> collector(placed, edges, edges, margin, visit_vertex_face, visit_edge_edge);
  return count_elements(placed, collector, options);
}

ElementPairCount self_element_pairs(const Model& model, const MeshEdges& edges, double margin,
                                    std::span<VertexFacePair> vertex_face, std::span<EdgeEdgePair> edge_edge,
                                    const ElementPairOptions& options) {
  base::SpanFiller<VertexFacePair> fill_vertex_face(vertex_face);
  base::SpanFiller<EdgeEdgePair> fill_edge_edge(edge_edge);
  return visit_self_element_pairs(model, edges, margin, fill_vertex_face, fill_edge_edge, options);
}

}  // namespace limber

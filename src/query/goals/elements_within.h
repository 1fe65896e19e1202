// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "core/check.h"
#include "geometry/primitives.h"
#include "limber/elements.h"
#include "query/goals/improvement.h"

namespace limber::query {

/// The goal of visit_element_pairs() and visit_self_element_pairs(): all pairs of a vertex and a face, and of two edges,
/// that are at most a margin apart.
///
/// Only the owner of an element offers it. Elements within the margin have owners within the margin, and these are
/// different triangles unless the elements share a vertex. So each pair comes once.
template <bool self>
class ElementsWithin {
 public:
  static constexpr bool takes_any = true;
  static constexpr bool needs_all = true;
  static constexpr bool is_self = self;
  static constexpr bool compares_leaves = true;

  ElementsWithin(const PlacedModels& placed, const MeshEdges& edges_a, const MeshEdges& edges_b, double margin,
                 VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge)
      : placed_(placed),
        edges_{&edges_a, &edges_b},
        margin_(margin),
        visit_vertex_face_(visit_vertex_face),
        visit_edge_edge_(visit_edge_edge),
        kernels_(simd::kernels()) {}

  /// Just above the margin: a pair exactly that far apart counts.
  double initial_prune_distance() const { return std::nextafter(margin_, std::numeric_limits<double>::infinity()); }
  bool is_done() const { return is_stopped_; }

  void compare_leaves(const LeafPair& pair, QueryStats& stats) {
    simd::ElementCandidates found;
    const simd::SelfPair both{pair.a, pair.b};
    kernels_.find_close_elements(pair.node_a, pair.node_b, pair.transform, pair.pruning, owned(Side::a, pair.a),
                                 owned(Side::b, pair.b), is_self ? &both : nullptr, found);
    const std::uint32_t count = found.vertex_face.count + found.face_vertex.count + found.edge_edge.count;
    if (count == 0) return;
    stats.triangle_tests += count;
    PlacedLeaf a(placed_, Side::a, pair.a), b(placed_, Side::b, pair.b);
    for (std::uint32_t i = 0; i < found.vertex_face.count && !is_stopped_; ++i) {
      const auto [vertex, face] = found.vertex_face.pairs[i];
      compare_vertex_face({pair.a, a, vertex}, {pair.b, b, face}, false);
    }
    for (std::uint32_t i = 0; i < found.face_vertex.count && !is_stopped_; ++i) {
      const auto [face, vertex] = found.face_vertex.pairs[i];
      compare_vertex_face({pair.b, b, vertex}, {pair.a, a, face}, !is_self);
    }
    for (std::uint32_t i = 0; i < found.edge_edge.count && !is_stopped_; ++i) {
      const auto [edge_a, edge_b] = found.edge_edge.pairs[i];
      compare_edges({pair.a, a, edge_a}, {pair.b, b, edge_b});
    }
  }

  std::size_t vertex_face_count = 0, edge_edge_count = 0;

 private:
  /// An element of a leaf, as simd::ElementCandidate has it.
  struct Element {
    const bvh::Leaf& leaf;
    PlacedLeaf& placed;
    std::uint32_t code;

    std::uint32_t slot() const { return code / 4; }
    std::size_t corner() const { return code % 4; }
    TriangleId triangle() const { return leaf.triangle[slot()]; }
    const Triangle& face() const { return placed.at(slot()).corners; }
    VertexId vertex(std::size_t k) const { return leaf.vertices[slot()][k]; }
  };
  /// An edge, from the smaller vertex id to the larger.
  struct DirectedEdge {
    Segment segment;
    std::array<VertexId, 2> vertices;

    explicit DirectedEdge(const Element& e) {
      std::size_t from = e.corner(), to = geometry::after[from];
      if (e.vertex(to) < e.vertex(from)) std::swap(from, to);
      segment = {e.face()[from], e.face()[to]}, vertices = {e.vertex(from), e.vertex(to)};
    }
  };

  simd::OwnedElements owned(Side s, const bvh::Leaf& leaf) const {
    constexpr std::uint64_t is_in_use = 0x40;
    std::uint64_t of_slots = 0;
    for (std::uint32_t slot = 0; slot < bvh::width; ++slot) {
      if (slot > 0 && leaf.triangle[slot] == leaf.triangle[slot - 1]) break;  // the others repeat it
      of_slots |= (is_in_use | edges_[index(s)]->owned_by(leaf.triangle[slot])) << (8 * slot);
    }
    return {of_slots};
  }

  void compare_vertex_face(const Element& vertex, const Element& face, bool is_vertex_of_b) {
    const geometry::PointOnTriangle closest = geometry::closest_on(face.face(), vertex.face()[vertex.corner()]);
    if (!(closest.distance <= margin_)) return;
    ++vertex_face_count;
    is_stopped_ = !visit_vertex_face_(
        {vertex.vertex(vertex.corner()), face.triangle(), is_vertex_of_b, closest.distance, closest.weights});
  }

  void compare_edges(const Element& element_a, const Element& element_b) {
    const DirectedEdge a(element_a), b(element_b);
    // Edge ids are in the order of vertex ids, and the smaller comes first: the answer to the bit depends on the order.
    if (is_self && b.vertices < a.vertices) return compare_edges(element_b, b, element_a, a);
    compare_edges(element_a, a, element_b, b);
  }
  void compare_edges(const Element& element_a, const DirectedEdge& a, const Element& element_b, const DirectedEdge& b) {
    const geometry::PointsOnSegments closest = geometry::closest_on(a.segment, b.segment);
    if (!(closest.distance <= margin_)) return;
    const EdgeId id_a = edges_[0]->of_triangles()[element_a.triangle()][element_a.corner()];
    const EdgeId id_b = edges_[1]->of_triangles()[element_b.triangle()][element_b.corner()];
    LIMBER_ASSERT(edges_[0]->vertices()[id_a] == a.vertices && edges_[1]->vertices()[id_b] == b.vertices);
    ++edge_edge_count;
    is_stopped_ = !visit_edge_edge_({id_a, id_b, closest.distance, closest.s, closest.t});
  }

  const PlacedModels& placed_;
  const MeshEdges* edges_[2];
  double margin_;
  VertexFaceVisitor visit_vertex_face_;
  EdgeEdgeVisitor visit_edge_edge_;
  const simd::Kernels& kernels_;
  bool is_stopped_ = false;
};

}  // namespace limber::query

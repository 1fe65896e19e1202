// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "geometry/primitives.h"
#include "limber/elements.h"
#include "pair/collectors/collector.h"
#include "pair/placed_pair.h"

namespace limber::pair {

using EdgeVertices = std::array<VertexId, 2>;

/// The visitors of visit_element_pairs(), as ElementsWithin calls them.
struct ElementVisitors {
  VertexFaceVisitor visit_vertex_face;
  EdgeEdgeVisitor visit_edge_edge;

  bool take(const VertexFacePair& pair, const Corners&) const { return visit_vertex_face(pair); }
  bool take(const EdgeEdgePair& pair, const EdgeVertices&, const EdgeVertices&) const { return visit_edge_edge(pair); }
};

/// The collector of visit_element_pairs() and its like: all pairs of a vertex and a face, and of two edges, that are at
/// most a margin apart. The sink takes each with the vertices of the face, or of both edges, and returns whether to go
/// on.
///
/// A vertex or edge belongs to several triangles; only one of them, its representative (Access::represented_by()),
/// brings it into a comparison. Two elements within the margin have representatives within the margin, and AllPairs
/// offers every pair of triangles once, so each pair of elements is found once. In one model, elements with the same
/// representative share a vertex, and such pairs do not count.
///
/// Vertices and faces are compared one pair at a time, in compare_leaves(). Pairs of edges are collected until there
/// are enough for a kernel; finish() compares those that are left.
template <bool self, typename Sink>
class ElementsWithin {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = self;
  static constexpr bool compares_leaves = true;

  ElementsWithin(const PlacedPair& placed, const MeshEdges& edges_a, const MeshEdges& edges_b, double margin,
                 const Sink& sink)
      : placed_(placed), edges_{&edges_a, &edges_b}, margin_(margin), sink_(sink), kernels_(simd::kernels()) {}

  /// Just above the margin: pairs at the cutoff are pruned, and a pair exactly `margin` apart counts.
  double initial_cutoff() const { return std::nextafter(margin_, std::numeric_limits<double>::infinity()); }
  bool is_done() const { return is_stopped_; }

  void compare_leaves(const LeafPair& pair, QueryStats& stats) {
    simd::ElementCandidates found;
    const simd::SelfPair self_pair{pair.a, pair.b};
    kernels_.find_close_elements(pair.node_a, pair.node_b, pair.transform, pair.pruning, owned(Side::a, pair.a),
                                 owned(Side::b, pair.b), is_self ? &self_pair : nullptr, found);
    const std::uint32_t count = found.vertex_face.count + found.face_vertex.count + found.edge_edge.count;
    if (count == 0) return;
    stats.primitive_tests += count;  // pairs of elements count as pairs of triangles
    for (std::uint32_t i = 0; i < found.vertex_face.count && !is_stopped_; ++i) {
      const auto [vertex_code, face_code] = found.vertex_face.pairs[i];
      compare_vertex_face({Side::a, pair.a, vertex_code}, {Side::b, pair.b, face_code});
    }
    for (std::uint32_t i = 0; i < found.face_vertex.count && !is_stopped_; ++i) {
      const auto [face_code, vertex_code] = found.face_vertex.pairs[i];
      compare_vertex_face({Side::b, pair.b, vertex_code}, {Side::a, pair.a, face_code});
    }
    for (std::uint32_t i = 0; i < found.edge_edge.count && !is_stopped_; ++i) {
      const auto [code_a, code_b] = found.edge_edge.pairs[i];
      collect_edges({Side::a, pair.a, code_a}, {Side::b, pair.b, code_b});
    }
  }

  /// Compares the pairs of edges that have been collected.
  void finish() {
    simd::ClosestOfSegments found;
    kernels_.compare_segments(segments_, found);  // all places, also those that are not in use: they hold old pairs
    const std::uint32_t count = std::exchange(collected_, 0);
    for (std::uint32_t i = 0; i < count && !is_stopped_; ++i) {
      geometry::PointsOnSegments closest{found.distance[i], found.s[i], found.t[i]};
      if ((found.are_ordinary >> i & 1) == 0) {
        closest = geometry::closest_on(Segment{segments_.start_a[i], segments_.end_a[i]},
                                       Segment{segments_.start_b[i], segments_.end_b[i]});
      }
      if (!(closest.distance <= margin_)) continue;
      ++edge_edge_count;
      const auto& [a, b, of_a, of_b] = collected_edges_[i];
      is_stopped_ = !sink_.take(EdgeEdgePair{a, b, closest.distance, closest.s, closest.t}, of_a, of_b);
    }
  }

  std::size_t vertex_face_count = 0, edge_edge_count = 0;

 private:
  /// An element of a leaf; the code is corner * width + slot (simd::ElementCandidate).
  struct Element {
    Side side;
    const bvh::Leaf& leaf;
    std::uint32_t code;

    std::size_t corner() const { return code / bvh::width; }
    TriangleId triangle() const { return leaf.triangle[code % bvh::width]; }
    const Corners& vertices() const { return leaf.vertices[code % bvh::width]; }
  };
  /// Two edges that wait for the kernel, and their vertices.
  struct CollectedEdges {
    EdgeId a, b;
    EdgeVertices of_a, of_b;
  };
  /// The vertices of an edge, the smaller id first.
  static EdgeVertices vertices_of_edge(const Element& e) {
    const VertexId from = e.vertices()[e.corner()], to = e.vertices()[geometry::next_corner[e.corner()]];
    return {std::min(from, to), std::max(from, to)};
  }

  /// The position of a vertex: in the world, or in its own frame where one model is compared with itself.
  Vec3 position(Side s, VertexId v) const { return is_self ? placed_.local_position(s, v) : placed_.position(s, v); }

  /// The elements that the triangles of a leaf represent, a byte for each. Triangles that fill it up represent nothing.
  const simd::OwnedElements& owned(Side s, const bvh::Leaf& leaf) {
    simd::OwnedElements& elements = owned_by_last_[index(s)];
    if (std::exchange(last_leaf_[index(s)], &leaf) == &leaf) return elements;
    elements.of_slots = 0;
    for (std::uint32_t slot = 0; slot < bvh::width && leaf.is_in_use(slot); ++slot) {
      elements.of_slots |=
          (simd::OwnedElements::is_in_use | Access::represented_by(*edges_[index(s)], leaf.triangle[slot]))
          << (8 * slot);
    }
    return elements;
  }

  void compare_vertex_face(const Element& of_vertex, const Element& of_face) {
    const VertexId vertex = of_vertex.vertices()[of_vertex.corner()];
    const Corners& corners = of_face.vertices();
    const Triangle face{position(of_face.side, corners[0]), position(of_face.side, corners[1]),
                        position(of_face.side, corners[2])};
    const geometry::PointOnTriangle closest = geometry::closest_on(face, position(of_vertex.side, vertex));
    if (!(closest.distance <= margin_)) return;
    ++vertex_face_count;
    const bool is_vertex_of_b = !is_self && of_vertex.side == Side::b;
    const TriangleId triangle = of_face.triangle();
    is_stopped_ = !sink_.take({vertex, triangle, is_vertex_of_b, closest.distance, closest.weights}, corners);
  }

  void collect_edges(const Element& of_a, const Element& of_b) {
    const EdgeId id_a = edges_[0]->of_triangles()[of_a.triangle()][of_a.corner()];
    const EdgeId id_b = edges_[1]->of_triangles()[of_b.triangle()][of_b.corner()];
    const EdgeVertices a = vertices_of_edge(of_a), b = vertices_of_edge(of_b);
    LIMBER_ASSERT(edges_[0]->vertices()[id_a] == a && edges_[1]->vertices()[id_b] == b);
    const std::uint32_t i = collected_++;
    // The last bits of a distance depend on which edge comes first. So in one model it is the one of smaller id,
    // wherever the leaves are. Selected number by number, because a branch could not be predicted.
    const bool swaps = is_self && id_b < id_a;
    CollectedEdges& edges = collected_edges_[i];
    edges.a = swaps ? id_b : id_a, edges.b = swaps ? id_a : id_b;
    edges.of_a = {swaps ? b[0] : a[0], swaps ? b[1] : a[1]}, edges.of_b = {swaps ? a[0] : b[0], swaps ? a[1] : b[1]};
    segments_.start_a[i] = position(Side::a, edges.of_a[0]), segments_.end_a[i] = position(Side::a, edges.of_a[1]);
    segments_.start_b[i] = position(Side::b, edges.of_b[0]), segments_.end_b[i] = position(Side::b, edges.of_b[1]);
    if (collected_ == simd::SegmentPairs::room) finish();
  }

  const PlacedPair& placed_;
  const MeshEdges* edges_[2];
  double margin_;
  Sink sink_;
  const simd::Kernels& kernels_;
  const bvh::Leaf* last_leaf_[2] = {nullptr, nullptr};  // what owned() was asked about last, of either side
  simd::OwnedElements owned_by_last_[2];
  bool is_stopped_ = false;
  std::uint32_t collected_ = 0;  // pairs of edges
  CollectedEdges collected_edges_[simd::SegmentPairs::room];
  simd::SegmentPairs segments_;
};

}  // namespace limber::pair

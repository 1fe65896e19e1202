// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "geometry/triangle_contact.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/elements.h"
#include "pair/collectors/collector.h"
#include "pair/placed_pair.h"

namespace limber::pair {

/// The pairs of triangles of two models, as collectors that need several see them.
class PairsOfTwo {
 public:
  static constexpr bool is_self = false;

  PairsOfTwo(const Placed& a, const Placed& b, const PairOptions& options)
      : filter_(options.filter),
        oriented_(options.oriented_faces.value_or(closed(a.model().mesh(), b.model().mesh()))),
        radii_(a, b) {}

  /// How far apart the triangles of a pair are at most whose distance is at most `distance`.
  double core_limit(double distance) const { return radii_.core_limit(distance); }

  bool counts(const PlacedTriangle& a, const PlacedTriangle& b) const { return !filter_ || (*filter_)(a.id, b.id); }
  /// Whether the pair shares a vertex, so that only what it has in common beyond that matters.
  bool are_neighbors(const PlacedTriangle&, const PlacedTriangle&) const { return false; }
  bool meet(const PlacedTriangle& a, const PlacedTriangle& b) const {
    return geometry::intersects(a.corners, b.corners);
  }
  /// Which triangles of a pair have an outside.
  OrientedFaces oriented(bool /*are_neighbors*/) const { return oriented_; }
  /// The contact of the bodies, given that of two of their triangles.
  Contact of_bodies(const Contact& contact) const { return radii_.contact(contact); }

 private:
  static OrientedFaces closed(const Mesh& a, const Mesh& b) {
    if (a.is_closed()) return b.is_closed() ? OrientedFaces::both : OrientedFaces::of_a;
    return b.is_closed() ? OrientedFaces::of_b : OrientedFaces::none;
  }

  std::optional<TrianglePairFilter> filter_;
  OrientedFaces oriented_;
  Radii radii_;
};

/// The pairs of triangles of one model.
class PairsOfOne {
 public:
  static constexpr bool is_self = true;

  PairsOfOne(const Mesh& mesh, const PairOptions& options)
      : mesh_(mesh),
        filter_(options.filter),
        is_oriented_(options.oriented_faces ? *options.oriented_faces != OrientedFaces::none : mesh.is_closed()) {}

  double core_limit(double distance) const { return distance; }
  bool counts(const PlacedTriangle& a, const PlacedTriangle& b) const { return !filter_ || (*filter_)(a.id, b.id); }
  bool are_neighbors(const PlacedTriangle& a, const PlacedTriangle& b) const {
    LIMBER_ASSERT(a.id != b.id);
    const Corners &ids_a = mesh_.triangles[a.id], &ids_b = mesh_.triangles[b.id];
    for (const VertexId v : ids_a) {
      if (v == ids_b[0] || v == ids_b[1] || v == ids_b[2]) return true;
    }
    return false;
  }
  bool meet(const PlacedTriangle& a, const PlacedTriangle& b) const {
    return geometry::meets_elsewhere(a.corners, mesh_.triangles[a.id], b.corners, mesh_.triangles[b.id]);
  }
  /// Neighbors that meet have been folded, so their outsides do not tell how to part them.
  OrientedFaces oriented(bool are_neighbors) const {
    return is_oriented_ && !are_neighbors ? OrientedFaces::both : OrientedFaces::none;
  }
  Contact of_bodies(const Contact& contact) const { return contact; }

 private:
  MeshView mesh_;
  std::optional<TrianglePairFilter> filter_;
  bool is_oriented_;
};

/// The collector of visit_intersections() and self_collide(): all pairs of triangles that meet. `Pairs` is PairsOfTwo
/// or PairsOfOne.
template <typename Pairs>
class AllIntersections {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  AllIntersections(const Pairs& pairs, TrianglePairVisitor visit) : pairs_(pairs), visit_(visit) {}

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return is_stopped_; }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (pairs_.counts(a, b) && pairs_.meet(a, b)) ++count, is_stopped_ = !visit_({a.id, b.id});
  }

  std::size_t count = 0;

 private:
  Pairs pairs_;
  TrianglePairVisitor visit_;
  bool is_stopped_ = false;
};

/// The collector of visit_contacts(): all pairs of triangles that meet or are at most a margin apart. `Pairs` is
/// PairsOfTwo or PairsOfOne.
template <typename Pairs>
class PairsWithin {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  PairsWithin(const Pairs& pairs, double margin, ContactVisitor visit)
      : pairs_(pairs), margin_(margin), visit_(visit) {}

  /// Just above the margin: a pair exactly that far apart counts.
  double initial_cutoff() const { return std::nextafter(pairs_.core_limit(margin_), infinity); }
  bool is_done() const { return is_stopped_; }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b)) return;
    const bool are_neighbors = pairs_.are_neighbors(a, b);
    if (are_neighbors && !pairs_.meet(a, b)) return;
    ids_[batch_.size()] = {a.id, b.id};
    batch_.add(a.corners, b.corners, pairs_.oriented(are_neighbors));
    if (batch_.size() == geometry::ContactBatch::room) finish();
  }
  /// Visits what has been compared since the last time.
  void finish() {
    if (batch_.size() == 0) return;
    batch_.find_crossings();
    const double limit = pairs_.core_limit(margin_);
    for (std::uint32_t i = 0; i < batch_.size() && !is_stopped_; ++i) {
      const Contact contact = pairs_.of_bodies({batch_.contact(i, limit), ids_[i].a, ids_[i].b});
      LIMBER_ASSERT(contact.distance >= 0 && contact.depth >= 0);
      if (contact.distance <= margin_) ++count, is_stopped_ = !visit_(contact);
    }
    batch_.clear();
  }

  std::size_t count = 0;

 private:
  Pairs pairs_;
  double margin_;
  ContactVisitor visit_;
  geometry::ContactBatch batch_;
  TrianglePair ids_[geometry::ContactBatch::room];
  bool is_stopped_ = false;
};

/// The collector of closest_pairs(): the closest pairs of triangles at most a distance apart, as many as there is room
/// for.
template <typename Pairs>
class ClosestPairs {
 public:
  static constexpr Hits hits = Hits::k_closest;
  static constexpr bool is_self = Pairs::is_self;

  ClosestPairs(const Pairs& pairs, std::span<Contact> closest, double max_distance)
      : pairs_(pairs), closest_(closest), max_distance_(max_distance) {}

  /// Just above the limit: a pair exactly that far apart counts.
  double initial_cutoff() const { return std::nextafter(pairs_.core_limit(max_distance_), infinity); }
  /// Nothing is closer than a contact.
  bool is_done() const { return count == closest_.size() && (count == 0 || closest_.front().distance == 0); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b)) return std::nullopt;
    const bool are_neighbors = pairs_.are_neighbors(a, b);
    if (are_neighbors && !pairs_.meet(a, b)) return std::nullopt;
    const bool is_full = count == closest_.size();
    const double farthest = is_full ? closest_.front().distance : max_distance_;
    const Contact contact = pairs_.of_bodies(
        {geometry::contact(a.corners, b.corners, pairs_.oriented(are_neighbors), pairs_.core_limit(farthest)), a.id,
         b.id});
    if (is_full ? contact.distance >= farthest : contact.distance > farthest) return std::nullopt;
    LIMBER_ASSERT(count <= closest_.size());
    // A heap with the farthest pair first.
    if (is_full) {
      std::pop_heap(closest_.begin(), closest_.end(), is_closer);
      closest_.back() = contact;
    } else {
      closest_[count++] = contact;
    }
    std::push_heap(closest_.begin(), closest_.begin() + static_cast<std::ptrdiff_t>(count), is_closer);
    if (count < closest_.size()) return std::nullopt;
    const double cutoff = pairs_.core_limit(closest_.front().distance);
    return BoundUpdate{cutoff, cutoff, contact.point_b - contact.point_a};
  }

  /// Puts the nearest first.
  void sort() { std::sort_heap(closest_.begin(), closest_.begin() + static_cast<std::ptrdiff_t>(count), is_closer); }

  std::size_t count = 0;

 private:
  static bool is_closer(const Contact& a, const Contact& b) {
    return std::tie(a.distance, a.triangle_a, a.triangle_b) < std::tie(b.distance, b.triangle_a, b.triangle_b);
  }

  Pairs pairs_;
  std::span<Contact> closest_;
  double max_distance_;
};

/// The collector of self_distance(): the closest triangles of a model that are no neighbors, or that meet.
class ClosestSelfPair {
 public:
  static constexpr Hits hits = Hits::k_closest;
  static constexpr bool is_self = true;

  ClosestSelfPair(const PairsOfOne& pairs, const DistanceOptions& options) : closest(options, 0), pairs_(pairs) {}

  double initial_cutoff() const { return closest.initial_cutoff(); }
  bool is_done() const { return closest.is_done(); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b) || (pairs_.are_neighbors(a, b) && !pairs_.meet(a, b))) return std::nullopt;
    return closest.compare(a, b);
  }

  ClosestPair closest;

 private:
  PairsOfOne pairs_;
};

/// The collector of visit_element_pairs() and visit_self_element_pairs(): all pairs of a vertex and a face, and of two
/// edges, that are at most a margin apart.
///
/// A vertex or edge belongs to several triangles; only one of them, its representative (Access::represented_by()),
/// brings it into a comparison. Two elements within the margin have representatives within the margin, and AllPairs
/// offers every pair of triangles once, so each pair of elements is found once. In one model, elements with the same
/// representative share a vertex, and such pairs do not count.
///
/// Vertices and faces are compared one pair at a time, in compare_leaves(). Pairs of edges are collected until there
/// are enough for a kernel; finish() compares those that are left.
template <bool self>
class ElementsWithin {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = self;
  static constexpr bool compares_leaves = true;

  ElementsWithin(const PlacedPair& placed, const MeshEdges& edges_a, const MeshEdges& edges_b, double margin,
                 VertexFaceVisitor visit_vertex_face, EdgeEdgeVisitor visit_edge_edge)
      : placed_(placed),
        edges_{&edges_a, &edges_b},
        margin_(margin),
        visit_vertex_face_(visit_vertex_face),
        visit_edge_edge_(visit_edge_edge),
        kernels_(simd::kernels()) {}

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
      const auto [a, b] = collected_edges_[i];
      is_stopped_ = !visit_edge_edge_({a, b, closest.distance, closest.s, closest.t});
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
  /// The vertices of an edge, the smaller id first.
  static std::array<VertexId, 2> vertices_of_edge(const Element& e) {
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
    is_stopped_ = !visit_vertex_face_({vertex, of_face.triangle(), is_vertex_of_b, closest.distance, closest.weights});
  }

  void collect_edges(const Element& of_a, const Element& of_b) {
    const EdgeId id_a = edges_[0]->of_triangles()[of_a.triangle()][of_a.corner()];
    const EdgeId id_b = edges_[1]->of_triangles()[of_b.triangle()][of_b.corner()];
    const std::array<VertexId, 2> a = vertices_of_edge(of_a), b = vertices_of_edge(of_b);
    LIMBER_ASSERT(edges_[0]->vertices()[id_a] == a && edges_[1]->vertices()[id_b] == b);
    const std::uint32_t i = collected_++;
    // The last bits of a distance depend on which edge comes first. So in one model it is the one of smaller id,
    // wherever the leaves are. Selected number by number, because a branch could not be predicted.
    const bool swaps = is_self && id_b < id_a;
    collected_edges_[i] = {swaps ? id_b : id_a, swaps ? id_a : id_b};
    segments_.start_a[i] = position(Side::a, swaps ? b[0] : a[0]);
    segments_.end_a[i] = position(Side::a, swaps ? b[1] : a[1]);
    segments_.start_b[i] = position(Side::b, swaps ? a[0] : b[0]);
    segments_.end_b[i] = position(Side::b, swaps ? a[1] : b[1]);
    if (collected_ == simd::SegmentPairs::room) finish();
  }

  const PlacedPair& placed_;
  const MeshEdges* edges_[2];
  double margin_;
  VertexFaceVisitor visit_vertex_face_;
  EdgeEdgeVisitor visit_edge_edge_;
  const simd::Kernels& kernels_;
  const bvh::Leaf* last_leaf_[2] = {nullptr, nullptr};  // what owned() was asked about last, of either side
  simd::OwnedElements owned_by_last_[2];
  bool is_stopped_ = false;
  std::uint32_t collected_ = 0;  // pairs of edges
  std::array<EdgeId, 2> collected_edges_[simd::SegmentPairs::room];
  simd::SegmentPairs segments_;
};

}  // namespace limber::pair

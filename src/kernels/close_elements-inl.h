// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of elements of two leaves that are close, now or at some time of a motion.
//
// Leaves are given by their corners at one time; or at two, between which all corners move linearly. A gap along a
// fixed direction is then a concave function of time, the least of some linear ones. So it is at least the lesser of
// its values at both times: elements that one direction keeps apart at both are apart in between.

#if defined(LIMBER_SIMD_CLOSE_ELEMENTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_CLOSE_ELEMENTS_INL_H
#undef LIMBER_SIMD_CLOSE_ELEMENTS_INL_H
#else
#define LIMBER_SIMD_CLOSE_ELEMENTS_INL_H
#endif

#include <algorithm>
#include <cstdint>
#include <cstring>

#include "base/check.h"
#include "base/error_bounds.h"
#include "kernels/element_lists-inl.h"
#include "kernels/moving_neighbors-inl.h"
#include "kernels/project-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// In place of smaller denominators. All numbers here are about 1 or less.
inline constexpr float smallest_denominator = 1e-30F;
// Pairs of elements that are brought into packets at once.
inline constexpr std::uint32_t chunk = 64;

/// Ratios of numbers that may both be 0, brought to [0, 1].
LIMBER_KERNEL Packet clamped_ratio(Packet numerator, Packet denominator) {
  const Packet least = Packet::set(smallest_denominator);
  return min(max(numerator / max(denominator, least), zero()), Packet::set(1));
}

/// Whether the first `count` points, of one element, and the others are so far apart along w at all times that the pair
/// is pruned. w points from the first to the others. Points move linearly, so the gap along w is at least the least one
/// at the times that there are.
template <int count, std::uint32_t times>
LIMBER_KERNEL Mask are_apart(const Packet3& w, const Packet3 (&points)[times][4], Packet limit_sq) {
  Packet gap = Packet::set(far_off);
  for (const Packet3(&at)[4] : points) {
    Packet high = dot(w, at[0]), low = dot(w, at[count]);
    for (int i = 1; i < count; ++i) high = max(high, dot(w, at[i]));
    for (int i = count + 1; i < 4; ++i) low = min(low, dot(w, at[i]));
    gap = min(gap, low - high);
  }
  gap = max(gap, zero());
  return is_pruned(gap * gap, dot(w, w), limit_sq);
}

/// The direction between the closest points of edges p0 p1 and q0 q1. How well these are known does not matter.
LIMBER_KERNEL Packet3 between_edges(const Packet3 (&points)[4]) {
  const Packet3 &p0 = points[0], &p1 = points[1], &q0 = points[2], &q1 = points[3];
  const Packet3 u = p1 - p0, v = q1 - q0, d = q0 - p0;
  const Packet uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ud = dot(u, d), vd = dot(v, d);
  const Packet start = clamped_ratio(ud * vv - uv * vd, uu * vv - uv * uv);
  const Packet t = clamped_ratio(start * uv - vd, vv), s = clamped_ratio(t * uv + ud, uu);
  return d + v * t - u * s;
}

/// Lanes in which two edges are certainly apart at all times: along the direction between their closest points at one.
template <std::uint32_t times>
LIMBER_KERNEL unsigned edges_apart(const Packet3 (&points)[times][4], Packet limit_sq) {
  unsigned apart = 0;
  for (const Packet3(&at)[4] : points) apart |= bits(are_apart<2>(between_edges(at), points, limit_sq));
  return apart;
}

/// The direction from a vertex to the closest point of the edges of a face.
LIMBER_KERNEL Packet3 to_closest_edge(const Packet3 (&points)[4]) {
  const Packet3 &vertex = points[0], *const face = points + 1;
  const Packet3 r[3] = {face[0] - vertex, face[1] - vertex, face[2] - vertex};
  Packet3 w = r[0];
  Packet least_sq = Packet::set(far_off);
  for (int k = 0; k < 3; ++k) {
    const Packet3 edge = face[(k + 1) % 3] - face[k];
    const Packet t = clamped_ratio(zero() - dot(edge, r[k]), dot(edge, edge));
    const Packet3 to_edge = r[k] + edge * t;
    const Packet to_edge_sq = dot(to_edge, to_edge);
    w = select(to_edge_sq < least_sq, to_edge, w);
    least_sq = min(to_edge_sq, least_sq);
  }
  return w;
}

/// Lanes in which a vertex, the first point, and a face are certainly apart at all times: along the normal of the face
/// at one of them, or along the direction from the vertex to the closest point of the face's edges.
template <std::uint32_t times>
LIMBER_KERNEL unsigned vertex_face_apart(const Packet3 (&points)[times][4], Packet limit_sq) {
  unsigned apart = 0;
  for (const Packet3(&at)[4] : points) {
    const Packet3 n = cross(at[2] - at[1], at[3] - at[1]);
    // All three corners: in float32 the normal of a sliver is not perpendicular to it.
    Packet above = Packet::set(far_off), below = Packet::set(far_off);
    for (const Packet3(&p)[4] : points) {
      const Interval heights = interval(dot(n, p[1] - p[0]), dot(n, p[2] - p[0]), dot(n, p[3] - p[0]));
      above = min(above, heights.low), below = min(below, zero() - heights.high);
    }
    const Packet gap = max(max(above, below), zero());
    apart |= bits(are_apart<1>(to_closest_edge(at), points, limit_sq) | is_pruned(gap * gap, dot(n, n), limit_sq));
  }
  return apart;
}

/// The corners of the triangles of a leaf, four numbers each: [corner][slot]. The first corner follows the last.
struct alignas(64) CornerPoints {
  float v[4 * width][4];

  LIMBER_KERNEL void set(const LeafCorners& c) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        store_points3(corners(c, static_cast<int>(corner % 3), i), v[corner * width + i]);
      }
    }
  }
};

/// Four points of each of several pairs of elements: [time][point][pair].
template <std::uint32_t times>
struct alignas(64) PairPoints {
  float v[times][4][chunk][4];

  LIMBER_KERNEL void set(std::uint32_t point, std::uint32_t pair, const CornerPoints (&from)[times], std::uint32_t at) {
    for (std::uint32_t time = 0; time < times; ++time) {
      std::memcpy(v[time][point][pair], from[time].v[at], sizeof from[time].v[at]);
    }
  }
  LIMBER_KERNEL void load(std::uint32_t pair, Packet3 (&points)[times][4]) const {
    for (std::uint32_t time = 0; time < times; ++time) {
      for (std::uint32_t point = 0; point < 4; ++point) points[time][point] = load_points3(v[time][point][pair]);
    }
  }
};

/// How pairs of a vertex and a face are brought into packets and compared.
template <std::uint32_t times>
struct VertexFacePoints {
  const CornerPoints (&of_vertices)[times], (&of_faces)[times];

  LIMBER_KERNEL std::uint8_t element_b(std::uint8_t face) const { return face; }

  LIMBER_KERNEL void set(PairPoints<times>& points, std::uint32_t i, std::uint32_t vertex, std::uint32_t face) const {
    points.set(0, i, of_vertices, vertex);
    for (std::uint32_t k = 0; k < 3; ++k) points.set(1 + k, i, of_faces, face + k * width);
  }
  static LIMBER_KERNEL unsigned find_apart(const Packet3 (&points)[times][4], Packet limit_sq) {
    return vertex_face_apart(points, limit_sq);
  }
};
/// How pairs of edges are brought into packets and compared; the second edge is named by its place in OwnedEdges.
template <std::uint32_t times>
struct EdgePoints {
  const CornerPoints (&a)[times], (&b)[times];
  const OwnedEdges<times>& edges_b;

  LIMBER_KERNEL std::uint8_t element_b(std::uint8_t place) const { return edges_b.element[place]; }

  LIMBER_KERNEL void set(PairPoints<times>& points, std::uint32_t i, std::uint32_t edge_a,
                         std::uint32_t place_b) const {
    const std::uint32_t edge_b = edges_b.element[place_b];
    points.set(0, i, a, edge_a), points.set(1, i, a, edge_a + width);
    points.set(2, i, b, edge_b), points.set(3, i, b, edge_b + width);
  }
  static LIMBER_KERNEL unsigned find_apart(const Packet3 (&points)[times][4], Packet limit_sq) {
    return edges_apart(points, limit_sq);
  }
};

/// Takes over the pairs of a list that are not certainly apart; with `swaps` the two elements change places.
template <bool swaps, std::uint32_t times, template <std::uint32_t> typename Points, typename List, typename Kept>
LIMBER_KERNEL void keep_close(const List& list, Packet limit_sq, const Points<times>& elements, Kept& kept) {
  PairPoints<times> points;
  for (std::uint32_t first = 0; first < list.count; first += chunk) {
    const std::uint32_t count = std::min(chunk, list.count - first);
    // The last pair fills its packet.
    for (std::uint32_t i = 0; i < count || i % Packet::lanes != 0; ++i) {
      const std::uint32_t pair = std::min(first + i, list.count - 1);
      elements.set(points, i, list.a[pair], list.b[pair]);
    }
    for (std::uint32_t i = 0; i < count; i += Packet::lanes) {
      Packet3 of_pairs[times][4];
      points.load(i, of_pairs);
      const unsigned apart = Points<times>::find_apart(of_pairs, limit_sq);
      for (std::uint32_t lane = 0; lane < std::min(Packet::lanes, count - i); ++lane) {
        const std::uint8_t a = list.a[first + i + lane], b = elements.element_b(list.b[first + i + lane]);
        kept.pairs[kept.count] = swaps ? ElementCandidate{b, a} : ElementCandidate{a, b};
        kept.count += ~apart >> lane & 1;
      }
    }
  }
}

/// Finds the pairs of elements that are not pruned, from the corners of both leaves at some times. `limit` is the prune
/// distance with all errors, in the unit of the corners. The other arguments are those of find_close_elements().
template <std::uint32_t times>
LIMBER_KERNEL void find_elements(const LeafCorners (&a)[times], const LeafCorners (&b)[times], float limit,
                                 OwnedElements owned_by_a, OwnedElements owned_by_b, const SelfPair* self,
                                 ElementCandidates& found) {
  const Packet limit_sq = Packet::set(limit * limit * base::squares_up);
  // A byte for each kind of element, with a bit for each slot; the last kind is a slot in use.
  const std::uint64_t owned_a = transpose(owned_by_a.of_slots), owned_b = transpose(owned_by_b.of_slots);
  const bool is_same_leaf = self != nullptr && self->is_one_leaf();
  Boxes faces_a[times], faces_b[times];
  for (std::uint32_t time = 0; time < times; ++time) {
    find_boxes(a[time], faces_a[time]), find_boxes(b[time], faces_b[time]);
  }
  std::uint64_t near = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    Packet3 low[times], high[times];
    for (std::uint32_t time = 0; time < times; ++time) {
      low[time] = repeated(faces_a[time].low, row), high[time] = repeated(faces_a[time].high, row);
    }
    const unsigned of_row = near_boxes(low, high, faces_b, 0, limit_sq);
    near |= std::uint64_t{of_row & row_of(owned_b, 6) & (0U - (row_of(owned_a, 6) >> row & 1))} << (8 * row);
  }
  if (is_same_leaf) near &= bvh::each_pair_once;
  if (near == 0) return;

  const bvh::Leaf *const leaf_a = self != nullptr ? &self->a : nullptr, *const leaf_b =
                                                                            self != nullptr ? &self->b : nullptr;
  const LeafVertices vertices_a(leaf_a), vertices_b(leaf_b);
  if constexpr (times > 1) {
    const bool have_neighbors = self != nullptr && limit <= base::leaf_pair_error;
    near = may_meet(a, vertices_a, b, vertices_b, have_neighbors, limit_sq, near);
    if (near == 0) return;
  }
  ElementList<3 * width * width> vertex_face, vertex_face_swapped;
  ElementList<9 * width * width> edge_edge;
  list_vertices(a, vertices_in(owned_a), leaf_a, faces_b, vertices_b, near, limit_sq, vertex_face);
  list_vertices(b, vertices_in(owned_b), leaf_b, faces_a, vertices_a, transpose(near), limit_sq, vertex_face_swapped);
  const OwnedEdges<times> edges_b(b, vertices_b, edges_in(owned_b));
  list_edges(a, edges_in(owned_a), leaf_a, is_same_leaf ? near | transpose(near) : near, edges_b, is_same_leaf,
             limit_sq, edge_edge);

  if (vertex_face.count + vertex_face_swapped.count + edge_edge.count == 0) return;
  CornerPoints points_a[times], points_b[times];
  for (std::uint32_t time = 0; time < times; ++time) points_a[time].set(a[time]), points_b[time].set(b[time]);
  keep_close<false>(vertex_face, limit_sq, VertexFacePoints<times>{points_a, points_b}, found.vertex_face);
  keep_close<true>(vertex_face_swapped, limit_sq, VertexFacePoints<times>{points_b, points_a}, found.face_vertex);
  keep_close<false>(edge_edge, limit_sq, EdgePoints<times>{points_a, points_b, edges_b}, found.edge_edge);
}

// Kernels::find_close_elements.

LIMBER_KERNEL void find_close_elements(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                       const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                       const SelfPair* self, ElementCandidates& found) {
  LIMBER_ASSERT(!pruning.has_direction);
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  const ProjectedLeaves pair = self != nullptr ? project_leaves<true>(a, b, transform, pruning)
                                               : project_leaves<false>(a, b, transform, pruning);
  LeafCorners ca[1], cb[1];
  unpack(*a.triangles, pair.step_a, ca[0]);
  if (self != nullptr) {
    unpack(*b.triangles, pair.step_b, cb[0]);
    shift_corners(cb[0], pair.offset, cb[0]);
  } else {
    unpack(*b.triangles, pair.step_b, transform, pair.offset, cb[0]);
  }
  find_elements(ca, cb, pair.prune_distance + pair.error, owned_by_a, owned_by_b, self, found);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

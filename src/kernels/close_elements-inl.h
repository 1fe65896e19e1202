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

/// Elements of a leaf, one in each lane.
class ElementLanes {
 public:
  /// The codes are those of ElementCandidate.
  LIMBER_KERNEL explicit ElementLanes(const std::uint8_t* codes) : slots_(Slots::second_of(codes)) {
    alignas(64) static constexpr float numbers[width] = {0, 1, 2};
    const Packet corner = pick(numbers, Slots::first_of(codes));
    is_first_ = corner < Packet::set(1);
    is_last_ = corner > Packet::set(1);
  }
  LIMBER_KERNEL Packet3 vertex(const LeafCorners& c) const { return of(c, 0, 1, 2); }
  LIMBER_KERNEL void edge(const LeafCorners& c, Packet3& from, Packet3& to) const {
    from = of(c, 0, 1, 2), to = of(c, 1, 2, 0);
  }
  LIMBER_KERNEL void face(const LeafCorners& c, Packet3* corner) const {
    for (int k = 0; k < 3; ++k) corner[k] = corners(c, k, slots_);
  }

 private:
  LIMBER_KERNEL Packet3 of(const LeafCorners& c, int first, int second, int last) const {
    return select(is_first_, corners(c, first, slots_),
                  select(is_last_, corners(c, last, slots_), corners(c, second, slots_)));
  }

  Slots slots_;
  Mask is_first_, is_last_;  // which corner of its triangle the element is, or begins at
};

/// Takes over the pairs of a list that are not certainly apart, of vertices of a with faces of b, or of edges; with
/// `swaps` the two elements change places.
template <bool are_edges, bool swaps, std::uint32_t times, typename List, typename Kept>
LIMBER_KERNEL void keep_close(List& list, const LeafCorners (&a)[times], const LeafCorners (&b)[times], Packet limit_sq,
                              Kept& kept) {
  const std::uint32_t count = list.count;
  std::uint32_t n = 0;
  std::fill_n(list.a + count, width, std::uint8_t{0}), std::fill_n(list.b + count, width, std::uint8_t{0});
  for (std::uint32_t i = 0; i < count; i += Packet::lanes) {
    const ElementLanes of_a(list.a + i), of_b(list.b + i);
    Packet3 points[times][4];
    for (std::uint32_t time = 0; time < times; ++time) {
      if constexpr (are_edges) {
        of_a.edge(a[time], points[time][0], points[time][1]), of_b.edge(b[time], points[time][2], points[time][3]);
      } else {
        points[time][0] = of_a.vertex(a[time]), of_b.face(b[time], points[time] + 1);
      }
    }
    const unsigned apart = are_edges ? edges_apart(points, limit_sq) : vertex_face_apart(points, limit_sq);
    for (std::uint32_t lane = 0; lane < std::min(Packet::lanes, count - i); ++lane) {
      const std::uint8_t code_a = list.a[i + lane], code_b = list.b[i + lane];
      kept.pairs[n] = swaps ? ElementCandidate{code_b, code_a} : ElementCandidate{code_a, code_b};
      n += ~apart >> lane & 1;
    }
  }
  kept.count = n;
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
  const bvh::Leaf *const leaf_a = self != nullptr ? &self->a : nullptr, *const leaf_b =
                                                                            self != nullptr ? &self->b : nullptr;
  const LeafVertices vertices_a(leaf_a), vertices_b(leaf_b);
  // A byte for each triangle of a, with a bit for each of b with which it may have close elements.
  std::uint64_t faces = row_of(owned_b, 6) * in_each_byte & transpose(row_of(owned_a, 6) * in_each_byte);
  if (is_same_leaf) faces &= bvh::each_pair_once;
  if constexpr (times > 1) {
    faces = near_faces(faces_a, faces_b, limit_sq, faces);
    if (faces == 0) return;
    const bool have_neighbors = self != nullptr && limit <= base::leaf_pair_error;
    faces = may_meet(a, vertices_a, b, vertices_b, have_neighbors, limit_sq, faces);
    if (faces == 0) return;
  }
  LeafEdges<times> edges_a, edges_b;
  edges_a.set(a);
  std::uint32_t near_a = all_edges, near_b = all_edges;
  if (!is_same_leaf) {
    edges_b.set(b);
    near_a = edges_a.near(box_around(faces_b), limit_sq), near_b = edges_b.near(box_around(faces_a), limit_sq);
    // With edges of one leaf alone: a vertex may be near a face and far from the boxes of its edges.
    if ((near_a | near_b) == 0) return;
  }
  if constexpr (times > 1) {
    near_a &= in_rows_with_bits(is_same_leaf ? faces | transpose(faces) : faces);
    near_b &= in_rows_with_bits(is_same_leaf ? faces | transpose(faces) : transpose(faces));
  }
  ElementList<3 * width * width> vertex_face, vertex_face_swapped;
  ElementList<9 * width * width> edge_edge;
  list_vertices(a, vertices_in(owned_a) & between(near_a), leaf_a, faces_b, vertices_b, faces, limit_sq, vertex_face);
  list_vertices(b, vertices_in(owned_b) & between(near_b), leaf_b, faces_a, vertices_a, transpose(faces), limit_sq,
                vertex_face_swapped);
  const EdgeRow<times> row_b(is_same_leaf ? edges_a : edges_b, vertices_b, near_b & edges_in(owned_b));
  list_edges(edges_a, near_a & edges_in(owned_a), vertices_a, self != nullptr, row_b, is_same_leaf, limit_sq,
             edge_edge);

  keep_close<false, false>(vertex_face, a, b, limit_sq, found.vertex_face);
  keep_close<false, true>(vertex_face_swapped, b, a, limit_sq, found.face_vertex);
  keep_close<true, false>(edge_edge, a, b, limit_sq, found.edge_edge);
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

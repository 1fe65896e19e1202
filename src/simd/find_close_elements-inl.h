// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_close_elements.

#if defined(LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#undef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#else
#define LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#endif

#include <bit>
#include <cstdint>

#include "core/check.h"
#include "core/error_bounds.h"
#include "simd/find_candidates-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"
#include "simd/project-inl.h"
#include "simd/separated_neighbors-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// In place of smaller denominators. All numbers here are about 1 or less.
inline constexpr float smallest_denominator = 1e-30F;

/// The bounding boxes of all elements of a leaf: of its triangles, and of the edges that start at each corner.
struct ElementBoxes {
  Boxes faces, edges[3];
};

LIMBER_KERNEL void find_boxes(const LeafCorners& c, ElementBoxes& boxes) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 corners[3] = {c.at(0, i), c.at(1, i), c.at(2, i)};
    for (int k = 0; k < 3; ++k) {
      const Packet3 &p = corners[k], &q = corners[(k + 1) % 3];
      store3(min3(p, q), boxes.edges[k].low, i), store3(max3(p, q), boxes.edges[k].high, i);
    }
    store3(min3(min3(corners[0], corners[1]), corners[2]), boxes.faces.low, i);
    store3(max3(max3(corners[0], corners[1]), corners[2]), boxes.faces.high, i);
  }
}

/// Which boxes of `others` are near a box, whose corners every lane has: a bit for each slot.
LIMBER_KERNEL unsigned near_boxes(const Packet3& low, const Packet3& high, const float (*others_low)[width],
                                  const float (*others_high)[width], Packet limit_sq) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const auto gap = [&](int axis, Packet from, Packet to) {
      return max(max(Packet::load(others_low[axis] + i) - to, from - Packet::load(others_high[axis] + i)), zero());
    };
    const Packet x = gap(0, low.x, high.x), y = gap(1, low.y, high.y), z = gap(2, low.z, high.z);
    found |= bits(x * x + y * y + z * z < limit_sq) << i;
  }
  return found;
}

/// Quotients of numbers that may both be 0, brought to [0, 1].
LIMBER_KERNEL Packet clamped_quotient(Packet numerator, Packet denominator) {
  const Packet least = Packet::set(smallest_denominator);
  return min(max(numerator / max(denominator, least), zero()), Packet::set(1));
}

/// Whether two sets are so far apart along w, which points from a to b, that the pair is pruned. `high_a` and `low_b`
/// are their ends along w.
LIMBER_KERNEL Mask is_apart(const Packet3& w, Packet high_a, Packet low_b, Packet limit_sq) {
  const Packet gap = max(low_b - high_a, zero());
  return is_pruned(gap * gap, dot(w, w), limit_sq);
}

/// Of the `wanted` edges from `corner` of the triangles of b on, those that are near an edge, which every lane has. The
/// direction between the closest points decides: how well they are known does not matter.
LIMBER_KERNEL unsigned near_edges(const Packet3& p0, const Packet3& p1, const LeafCorners& b, int corner,
                                  Packet limit_sq, unsigned wanted) {
  const Packet3 u = p1 - p0;
  const Packet uu = dot(u, u);
  unsigned apart = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    if ((wanted >> i & ((1U << Packet::lanes) - 1)) == 0) continue;
    const Packet3 q0 = b.at(corner, i), q1 = b.at((corner + 1) % 3, i), v = q1 - q0, d = q0 - p0;
    const Packet vv = dot(v, v), uv = dot(u, v), ud = dot(u, d), vd = dot(v, d);
    const Packet start = clamped_quotient(ud * vv - uv * vd, uu * vv - uv * uv);
    const Packet t = clamped_quotient(start * uv - vd, vv), s = clamped_quotient(t * uv + ud, uu);
    const Packet3 w = d + v * t - u * s;
    apart |= bits(is_apart(w, max(dot(w, p0), dot(w, p1)), min(dot(w, q0), dot(w, q1)), limit_sq)) << i;
  }
  return wanted & ~apart;
}

/// Of the `wanted` lanes from slot i on, those in which a vertex and a face are not certainly apart: along the normal of
/// the face, and along the direction from the vertex to the closest point of the edges.
LIMBER_KERNEL unsigned apart_from_face(const Packet3& vertex, const Packet3 (&face)[3], Packet limit_sq) {
  const Packet3 r[3] = {face[0] - vertex, face[1] - vertex, face[2] - vertex};
  Packet3 w;
  Packet least_sq = Packet::set(far_off);
  for (int k = 0; k < 3; ++k) {
    const Packet3 edge = face[(k + 1) % 3] - face[k];
    const Packet t = clamped_quotient(zero() - dot(edge, r[k]), dot(edge, edge));
    const Packet3 to_edge = r[k] + edge * t;
    const Packet to_edge_sq = dot(to_edge, to_edge);
    w = k == 0 ? to_edge : select(to_edge_sq < least_sq, to_edge, w);
    least_sq = min(to_edge_sq, least_sq);
  }
  const Mask along_w =
      is_apart(w, dot(w, vertex), min(min(dot(w, face[0]), dot(w, face[1])), dot(w, face[2])), limit_sq);
  const Packet3 n = cross(face[1] - face[0], face[2] - face[0]);
  const Packet height = dot(n, r[0]);
  return bits(along_w | is_pruned(height * height, dot(n, n), limit_sq));
}

/// Of the `wanted` triangles of b, those whose face is near a vertex, which every lane has.
LIMBER_KERNEL unsigned near_faces(const Packet3& vertex, const LeafCorners& b, Packet limit_sq, unsigned wanted) {
  unsigned apart = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    if ((wanted >> i & ((1U << Packet::lanes) - 1)) == 0) continue;
    const Packet3 face[3] = {b.at(0, i), b.at(1, i), b.at(2, i)};
    apart |= apart_from_face(vertex, face, limit_sq) << i;
  }
  return wanted & ~apart;
}

/// Of the `wanted` triangles of b, those whose corner is near a face, which every lane has.
LIMBER_KERNEL unsigned near_vertices(const Packet3 (&face)[3], const LeafCorners& b, int corner, Packet limit_sq,
                                     unsigned wanted) {
  unsigned apart = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    if ((wanted >> i & ((1U << Packet::lanes) - 1)) == 0) continue;
    apart |= apart_from_face(b.at(corner, i), face, limit_sq) << i;
  }
  return wanted & ~apart;
}

LIMBER_KERNEL Packet3 repeated(const float (&v)[3][width], std::uint32_t slot) {
  return {Packet::set(v[0][slot]), Packet::set(v[1][slot]), Packet::set(v[2][slot])};
}

/// Which triangles of a leaf have which vertices of one triangle: a bit for each slot.
struct SharedVertices {
  unsigned same[3][3] = {};  // corner k of the triangle is corner l of that in the slot

  unsigned corner_of_b(std::uint32_t k) const { return same[k][0] | same[k][1] | same[k][2]; }
  unsigned corner_of_a(std::uint32_t l) const { return same[0][l] | same[1][l] | same[2][l]; }
  unsigned edges(std::uint32_t k, std::uint32_t l) const {
    const std::uint32_t k1 = (k + 1) % 3, l1 = (l + 1) % 3;
    return same[k][l] | same[k][l1] | same[k1][l] | same[k1][l1];
  }
};

LIMBER_KERNEL SharedVertices shared_vertices(const std::array<VertexId, 3>& a, const LeafVertices& b) {
  SharedVertices shared;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (std::size_t k = 0; k < 3; ++k) {
      for (std::size_t l = 0; l < 3; ++l) shared.same[k][l] |= bits(same_ids(b.id[l] + i, a[k])) << i;
    }
  }
  return shared;
}

LIMBER_KERNEL unsigned row_of(std::uint64_t m, std::uint32_t row) {
  return static_cast<unsigned>(m >> (8 * row)) & 0xff;
}

template <typename List>
LIMBER_KERNEL void add(List& list, std::uint32_t a, unsigned slots_of_b, std::uint32_t corner_b) {
  for (; slots_of_b != 0; slots_of_b &= slots_of_b - 1) {
    const auto slot = static_cast<std::uint32_t>(std::countr_zero(slots_of_b));
    list.pairs[list.count++] = {static_cast<std::uint8_t>(a), static_cast<std::uint8_t>(slot * 4 + corner_b)};
  }
}

LIMBER_KERNEL void find_close_elements(const OtherNode& a, const OtherNode& b, const FrameTransform& transform,
                                       const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                       const SelfPair* self, ElementCandidates& found) {
  LIMBER_ASSERT(!pruning.has_direction);
  const ProjectedLeaves pair = project_leaves(a, b, transform, pruning);
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  constexpr std::uint64_t later = 0x0080c0e0f0f8fcfe;  // triangles of a leaf with those after them
  std::uint64_t wanted = self != nullptr && &self->a == &self->b ? later : ~std::uint64_t{0};
  LeafCorners ca, cb;
  unpack(*a.triangles, pair.step_a, ca);
  unpack(*b.triangles, pair.step_b, transform, pair.offset, cb);
  const float limit = pair.prune_distance + pair.error;
  const Packet limit_sq = Packet::set(limit * limit * core::squares_up);
  ElementBoxes boxes_a, boxes_b;
  find_boxes(ca, boxes_a), find_boxes(cb, boxes_b);
  // A byte for each kind of element, with a bit for each slot.
  const std::uint64_t owned_a = transpose(owned_by_a.of_slots), owned_b = transpose(owned_by_b.of_slots);
  const unsigned in_use_a = row_of(owned_a, 6), in_use_b = row_of(owned_b, 6);
  LeafVertices vertices;
  if (self != nullptr) transpose_vertices(self->b, vertices);
  for (std::uint32_t row = 0; row < width; ++row) {
    unsigned near = (in_use_a >> row & 1) != 0 ? row_of(wanted, row) & in_use_b : 0;
    if (near == 0) continue;
    const Packet3 low = repeated(boxes_a.faces.low, row), high = repeated(boxes_a.faces.high, row);
    near &= near_boxes(low, high, boxes_b.faces.low, boxes_b.faces.high, limit_sq);
    if (near == 0) continue;
    SharedVertices shared;
    if (self != nullptr) shared = shared_vertices(self->a.vertices[row], vertices);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t element = row * 4 + k;
      if ((row_of(owned_a, k) >> row & 1) != 0) {
        unsigned those = near & ~shared.corner_of_b(k);
        if (those != 0) {
          const Packet3 point = ca.repeated(static_cast<int>(k), row);
          those &= near_boxes(point, point, boxes_b.faces.low, boxes_b.faces.high, limit_sq);
          if (those != 0) those = near_faces(point, cb, limit_sq, those);
          add(found.vertex_face, element, those, 0);
        }
      }
      unsigned those = near & row_of(owned_b, k) & ~shared.corner_of_a(k);
      if (those != 0) {
        those &= near_boxes(low, high, cb.v + 3 * k, cb.v + 3 * k, limit_sq);
        if (those != 0) {
          const Packet3 face[3] = {ca.repeated(0, row), ca.repeated(1, row), ca.repeated(2, row)};
          those = near_vertices(face, cb, static_cast<int>(k), limit_sq, those);
        }
        add(found.face_vertex, row * 4, those, k);
      }
      if ((row_of(owned_a, 3 + k) >> row & 1) == 0) continue;
      const Packet3 edge_low = repeated(boxes_a.edges[k].low, row), edge_high = repeated(boxes_a.edges[k].high, row);
      for (std::uint32_t l = 0; l < 3; ++l) {
        those = near & row_of(owned_b, 3 + l) & ~shared.edges(k, l);
        if (those == 0) continue;
        those &= near_boxes(edge_low, edge_high, boxes_b.edges[l].low, boxes_b.edges[l].high, limit_sq);
        if (those != 0) {
          those = near_edges(ca.repeated(static_cast<int>(k), row), ca.repeated(static_cast<int>((k + 1) % 3), row), cb,
                             static_cast<int>(l), limit_sq, those);
        }
        add(found.edge_edge, element, those, l);
      }
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

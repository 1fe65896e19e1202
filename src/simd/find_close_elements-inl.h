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
          add(found.vertex_face, element, those, 0);
        }
      }
      unsigned those = near & row_of(owned_b, k) & ~shared.corner_of_a(k);
      if (those != 0) {
        those &= near_boxes(low, high, cb.v + 3 * k, cb.v + 3 * k, limit_sq);
        add(found.face_vertex, row * 4, those, k);
      }
      if ((row_of(owned_a, 3 + k) >> row & 1) == 0) continue;
      const Packet3 edge_low = repeated(boxes_a.edges[k].low, row), edge_high = repeated(boxes_a.edges[k].high, row);
      for (std::uint32_t l = 0; l < 3; ++l) {
        those = near & row_of(owned_b, 3 + l) & ~shared.edges(k, l);
        if (those == 0) continue;
        those &= near_boxes(edge_low, edge_high, boxes_b.edges[l].low, boxes_b.edges[l].high, limit_sq);
        add(found.edge_edge, element, those, l);
      }
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

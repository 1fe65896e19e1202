// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Lists of the pairs of elements of two leaves whose boxes are close, at one time or between two.

#if defined(LIMBER_SIMD_ELEMENT_LISTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_ELEMENT_LISTS_INL_H
#undef LIMBER_SIMD_ELEMENT_LISTS_INL_H
#else
#define LIMBER_SIMD_ELEMENT_LISTS_INL_H
#endif

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/check.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/separated_neighbors-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Pairs of elements whose boxes are close.
template <std::uint32_t room>
struct ElementList {
  std::uint32_t count = 0;
  std::uint8_t a[room + width], b[room + width];

  /// Adds an element of a with some of b: those of a bit mask, of which the first is number `first`. Branches would not
  /// be predicted.
  LIMBER_KERNEL void add(std::uint32_t element_a, unsigned which_b, std::uint32_t first) {
    const std::uint64_t of_a = element_a * in_each_byte;
    const std::uint64_t of_b = std::bit_cast<std::uint64_t>(numbers_of_bits[which_b]) + first * in_each_byte;
    std::memcpy(a + count, &of_a, sizeof of_a), std::memcpy(b + count, &of_b, sizeof of_b);
    count += static_cast<std::uint32_t>(std::popcount(which_b));
    LIMBER_ASSERT(count <= room);
  }
};

/// Transposes a matrix of 8 by 8 bits.
LIMBER_KERNEL std::uint64_t transpose(std::uint64_t m) {
  std::uint64_t t = (m ^ (m >> 7)) & 0x00aa00aa00aa00aaU;
  m ^= t ^ (t << 7);
  t = (m ^ (m >> 14)) & 0x0000cccc0000ccccU;
  m ^= t ^ (t << 14);
  t = (m ^ (m >> 28)) & 0x00000000f0f0f0f0U;
  return m ^ t ^ (t << 28);
}
/// The bits of vertices and of edges in a transposed OwnedElements.
LIMBER_KERNEL std::uint32_t vertices_in(std::uint64_t owned) { return owned & 0xffffff; }
LIMBER_KERNEL std::uint32_t edges_in(std::uint64_t owned) { return owned >> 24 & 0xffffff; }
LIMBER_KERNEL unsigned row_of(std::uint64_t m, std::uint32_t row) {
  return static_cast<unsigned>(m >> (8 * row)) & 0xff;
}
/// A corner of one slot, in every lane.
LIMBER_KERNEL Packet3 repeated(const LeafCorners& c, std::uint32_t corner, std::uint32_t slot) {
  return {Packet::set(c.v[3 * corner][slot]), Packet::set(c.v[3 * corner + 1][slot]),
          Packet::set(c.v[3 * corner + 2][slot])};
}

/// The boxes `i` and following.
template <std::size_t room>
LIMBER_KERNEL Packet3 row3(const float (&v)[3][room], std::uint32_t i) {
  return {Packet::load(v[0] + i), Packet::load(v[1] + i), Packet::load(v[2] + i)};
}

/// Which of eight boxes from `first` on are near a box, which every lane has: a bit for each. Boxes move linearly, so a
/// gap along an axis is at least the least one at the times that there are.
template <std::uint32_t times, typename Boxes>
LIMBER_KERNEL unsigned near_boxes(const Packet3 (&low)[times], const Packet3 (&high)[times],
                                  const Boxes (&boxes)[times], std::uint32_t first, Packet limit_sq) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Packet3 above = row3(boxes[0].low, first + i) - high[0], below = low[0] - row3(boxes[0].high, first + i);
    for (std::uint32_t time = 1; time < times; ++time) {
      above = min3(above, row3(boxes[time].low, first + i) - high[time]);
      below = min3(below, low[time] - row3(boxes[time].high, first + i));
    }
    const Packet3 gaps = max3(above, below);
    const Packet x = max(gaps.x, zero()), y = max(gaps.y, zero()), z = max(gaps.z, zero());
    found |= bits(x * x + y * y + z * z < limit_sq) << i;
  }
  return found;
}

/// The vertices of the triangles of a leaf: [corner][slot].
struct alignas(64) LeafVertices {
  VertexId id[3][width];

  LIMBER_KERNEL explicit LeafVertices(const bvh::Leaf* leaf) {
    for (std::uint32_t i = 0; leaf != nullptr && i < width; i += Packet::lanes) {
      deinterleave(leaf->vertices[i].data(), id[0] + i, id[1] + i, id[2] + i);
    }
  }
};

/// The triangles of a leaf that have a vertex: a bit for each slot.
LIMBER_KERNEL unsigned faces_with(const LeafVertices& leaf, VertexId vertex) {
  const Ids wanted = Ids::set(vertex);
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    found |= bits((Ids::load(leaf.id[0] + i) == wanted) | (Ids::load(leaf.id[1] + i) == wanted) |
                  (Ids::load(leaf.id[2] + i) == wanted))
             << i;
  }
  return found;
}

/// The elements, as ElementCandidate has them, of the triangles whose rows in a matrix of 8 by 8 bits are not 0.
LIMBER_KERNEL std::uint32_t in_rows_with_bits(std::uint64_t m) {
  std::uint32_t rows = 0;
  for (std::uint32_t row = 0; row < width; ++row) rows |= (row_of(m, row) != 0 ? 1U : 0U) << row;
  return rows * 0x010101U;
}

/// Lists vertices and faces whose boxes are close: those of triangles whose boxes are, without those that share a
/// vertex. `near` has a byte for each triangle of a, with a bit for each of b; `vertices` are those that a owns.
template <std::uint32_t times, typename List>
LIMBER_KERNEL void list_vertices(const LeafCorners (&a)[times], std::uint32_t vertices, const bvh::Leaf* leaf_a,
                                 const Boxes (&faces_b)[times], const LeafVertices& vertices_b, std::uint64_t near,
                                 Packet limit_sq, List& list) {
  for (vertices &= in_rows_with_bits(near); vertices != 0; vertices &= vertices - 1) {
    const auto vertex = static_cast<std::uint32_t>(std::countr_zero(vertices));
    const std::uint32_t corner = vertex / width, slot = vertex % width;
    const unsigned shared = leaf_a != nullptr ? faces_with(vertices_b, leaf_a->vertices[slot][corner]) : 0;
    Packet3 point[times];
    for (std::uint32_t time = 0; time < times; ++time) point[time] = repeated(a[time], corner, slot);
    list.add(vertex, row_of(near, slot) & near_boxes(point, point, faces_b, 0, limit_sq) & ~shared, 0);
  }
}

/// The boxes of the edges that a leaf owns, one after the other, and their vertices.
template <std::uint32_t times>
struct alignas(64) OwnedEdges {
  static constexpr std::uint32_t room = 3 * width + width;
  struct EdgeBoxes {
    float low[3][room], high[3][room];
  };
  EdgeBoxes boxes[times];
  VertexId from[room], to[room];
  std::uint8_t element[room];  // as in ElementCandidate
  std::uint32_t count = 0;

  /// `edges` has a bit for each edge that is owned.
  LIMBER_KERNEL OwnedEdges(const LeafCorners (&c)[times], const LeafVertices& vertices, std::uint32_t edges) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t next = (corner + 1) % 3;
      const unsigned which = edges >> (corner * width) & 0xff;
      // All eight are written; those that do not count are overwritten by the next, or not used.
      for (std::uint32_t time = 0; time < times; ++time) add_boxes(c[time], corner, next, which, boxes[time]);
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        const Slots owned = Slots::second_of(numbers_of_bits[which].data() + i);
        pick(vertices.id[corner], owned).store(from + count + i);
        pick(vertices.id[next], owned).store(to + count + i);
      }
      const std::uint64_t elements =
          std::bit_cast<std::uint64_t>(numbers_of_bits[which]) + corner * width * in_each_byte;
      std::memcpy(element + count, &elements, sizeof elements);
      count += static_cast<std::uint32_t>(std::popcount(which));
    }
  }
  LIMBER_KERNEL void add_boxes(const LeafCorners& c, std::uint32_t corner, std::uint32_t next, unsigned which,
                               EdgeBoxes& added) const {
    Boxes all;
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet3 p = corners(c, static_cast<int>(corner), i), q = corners(c, static_cast<int>(next), i);
      store3(min3(p, q), all.low, i), store3(max3(p, q), all.high, i);
    }
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Slots owned = Slots::second_of(numbers_of_bits[which].data() + i);
      for (int axis = 0; axis < 3; ++axis) {
        pick(all.low[axis], owned).store(added.low[axis] + count + i);
        pick(all.high[axis], owned).store(added.high[axis] + count + i);
      }
    }
  }
  /// The edges, of eight from `first` on, that have one of two vertices: a bit for each.
  LIMBER_KERNEL unsigned with(VertexId v, VertexId w, std::uint32_t first) const {
    unsigned found = 0;
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Ids f = Ids::load(from + first + i), t = Ids::load(to + first + i);
      found |= bits((f == Ids::set(v)) | (f == Ids::set(w)) | (t == Ids::set(v)) | (t == Ids::set(w))) << i;
    }
    return found;
  }
};

/// Lists edges whose boxes are close, without those that share a vertex: those of a, by where they start, with those of
/// b, by their place in `owned_b`. Of a leaf and itself each edge comes with those after it.
template <std::uint32_t times, typename List>
LIMBER_KERNEL void list_edges(const LeafCorners (&a)[times], std::uint32_t edges_a, const bvh::Leaf* leaf_a,
                              std::uint64_t near, const OwnedEdges<times>& owned_b, bool is_same_leaf, Packet limit_sq,
                              List& list) {
  for (std::uint32_t edges = edges_a & in_rows_with_bits(near); edges != 0; edges &= edges - 1) {
    const auto edge = static_cast<std::uint32_t>(std::countr_zero(edges));
    const std::uint32_t corner = edge / width, slot = edge % width, next = (corner + 1) % 3;
    Packet3 low[times], high[times];
    for (std::uint32_t time = 0; time < times; ++time) {
      const Packet3 p = repeated(a[time], corner, slot), q = repeated(a[time], next, slot);
      low[time] = min3(p, q), high[time] = max3(p, q);
    }
    std::uint32_t wanted = (1U << owned_b.count) - 1;
    if (is_same_leaf) wanted &= ~((2U << std::popcount(edges_a & ((1U << edge) - 1))) - 1);
    for (std::uint32_t first = 0; first < owned_b.count; first += width) {
      unsigned found = wanted >> first & near_boxes(low, high, owned_b.boxes, first, limit_sq);
      if (leaf_a != nullptr) {
        found &= ~owned_b.with(leaf_a->vertices[slot][corner], leaf_a->vertices[slot][next], first);
      }
      list.add(edge, found, first);
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

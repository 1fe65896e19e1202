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
  alignas(64) std::uint8_t a[room + width], b[room + width];

  /// Writes an element of a with some of b behind the first `n` pairs: those of a bit mask, of which the first is
  /// number `first`. Branches would not be predicted. Returns how many pairs there are then: a count that is a member
  /// would go through memory, as bytes that are written could be any other.
  LIMBER_KERNEL std::uint32_t add_behind(std::uint32_t n, std::uint32_t element_a, unsigned which_b,
                                         std::uint32_t first) {
    const std::uint64_t of_a = element_a * in_each_byte;
    const std::uint64_t of_b = std::bit_cast<std::uint64_t>(numbers_of_bits[which_b]) + first * in_each_byte;
    std::memcpy(a + n, &of_a, sizeof of_a), std::memcpy(b + n, &of_b, sizeof of_b);
    n += static_cast<std::uint32_t>(std::popcount(which_b));
    LIMBER_ASSERT(n <= room);
    return n;
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

/// A box in every lane, at each of some times.
template <std::uint32_t times>
struct Region {
  Packet3 low[times], high[times];
};

/// Which boxes, of those from `i` on, are near a region. Boxes move linearly, so a gap along an axis is at least the
/// least one at the times that there are.
///
/// A smaller box, or a smaller region, never gets near by rounding: what is not near the whole has no part that is.
template <std::uint32_t times, typename Boxes>
LIMBER_KERNEL Mask near_mask(const Region<times>& region, const Boxes (&boxes)[times], std::uint32_t i,
                             Packet limit_sq) {
  Packet3 above = load3(boxes[0].low, i) - region.high[0], below = region.low[0] - load3(boxes[0].high, i);
  for (std::uint32_t time = 1; time < times; ++time) {
    above = min3(above, load3(boxes[time].low, i) - region.high[time]);
    below = min3(below, region.low[time] - load3(boxes[time].high, i));
  }
  return length_of_gaps_sq(max3(above, below)) < limit_sq;
}
/// Which of eight boxes, from `first` on, are near a region: a bit for each.
template <std::uint32_t times, typename Boxes>
LIMBER_KERNEL unsigned near_boxes(const Region<times>& region, const Boxes (&boxes)[times], std::uint32_t first,
                                  Packet limit_sq) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    found |= bits(near_mask(region, boxes, first + i, limit_sq)) << i;
  }
  return found;
}

/// The triangles of two leaves that are near, of those in `faces`: a byte for each of a, with a bit for each of b.
template <std::uint32_t times>
LIMBER_KERNEL std::uint64_t near_faces(const Boxes (&faces_a)[times], const Boxes (&faces_b)[times], Packet limit_sq,
                                       std::uint64_t faces) {
  std::uint64_t near = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    Region<times> face;
    for (std::uint32_t time = 0; time < times; ++time) {
      face.low[time] = repeated(faces_a[time].low, row), face.high[time] = repeated(faces_a[time].high, row);
    }
    near |= std::uint64_t{near_boxes(face, faces_b, 0, limit_sq)} << (8 * row);
  }
  return near & faces;
}

/// The box around all faces of a leaf.
template <std::uint32_t times>
LIMBER_KERNEL Region<times> box_around(const Boxes (&faces)[times]) {
  Region<times> box;
  const Packet3 none{zero(), zero(), zero()};
  for (std::uint32_t time = 0; time < times; ++time) {
    Packet3 low = load3(faces[time].low, 0), high = load3(faces[time].high, 0);
    for (std::uint32_t i = Packet::lanes; i < width; i += Packet::lanes) {
      low = min3(low, load3(faces[time].low, i)), high = max3(high, load3(faces[time].high, i));
    }
    const Packet3 back = none - low;
    box.low[time] = none - Packet3{largest_in_all(back.x), largest_in_all(back.y), largest_in_all(back.z)};
    box.high[time] = {largest_in_all(high.x), largest_in_all(high.y), largest_in_all(high.z)};
  }
  return box;
}

/// The vertices of the triangles of a leaf: [corner][slot].
struct alignas(64) LeafVertices {
  VertexId id[3][width];

  LIMBER_KERNEL explicit LeafVertices(const bvh::Leaf* leaf) {
    for (std::uint32_t i = 0; leaf != nullptr && i < width; i += Packet::lanes) {
      deinterleave(leaf->vertices[i].data(), id[0] + i, id[1] + i, id[2] + i);
    }
  }
  /// By a number as in ElementCandidate.
  LIMBER_KERNEL VertexId of_corner(std::uint32_t code) const { return id[code / width][code % width]; }
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

/// Lists vertices and faces whose boxes are close, without those that share a vertex. `faces` has a byte for each
/// triangle of a, with a bit for each of b that counts.
template <std::uint32_t times, typename List>
LIMBER_KERNEL void list_vertices(const LeafCorners (&a)[times], std::uint32_t vertices, const bvh::Leaf* leaf_a,
                                 const Boxes (&faces_b)[times], const LeafVertices& vertices_b, std::uint64_t faces,
                                 Packet limit_sq, List& list) {
  std::uint32_t n = 0;
  for (; vertices != 0; vertices &= vertices - 1) {
    const auto vertex = static_cast<std::uint32_t>(std::countr_zero(vertices));
    const std::uint32_t corner = vertex / width, slot = vertex % width;
    const unsigned shared = leaf_a != nullptr ? faces_with(vertices_b, leaf_a->vertices[slot][corner]) : 0;
    Region<times> point;
    for (std::uint32_t time = 0; time < times; ++time) {
      point.low[time] = point.high[time] = repeated(a[time], corner, slot);
    }
    n = list.add_behind(n, vertex, row_of(faces, slot) & near_boxes(point, faces_b, 0, limit_sq) & ~shared, 0);
  }
  list.count = n;
}

/// Boxes of edges, and room for eight more that are written and not used.
struct alignas(64) EdgeBoxes {
  static constexpr std::uint32_t room = 3 * width + width;
  float low[3][room], high[3][room];
};
inline constexpr std::uint32_t all_edges = (1U << (3 * width)) - 1;

/// The edges of a leaf and their boxes, by corner and slot.
template <std::uint32_t times>
struct LeafEdges {
  EdgeBoxes boxes[times];

  LIMBER_KERNEL void set(const LeafCorners (&c)[times]) {
    for (std::uint32_t time = 0; time < times; ++time) {
      for (std::uint32_t edge = 0; edge < 3 * width; edge += Packet::lanes) {
        const auto corner = static_cast<int>(edge / width);
        const Packet3 p = corners(c[time], corner, edge % width), q = corners(c[time], (corner + 1) % 3, edge % width);
        store3(min3(p, q), boxes[time].low, edge), store3(max3(p, q), boxes[time].high, edge);
      }
    }
  }
  /// The edges that are near a region: a bit for each.
  LIMBER_KERNEL std::uint32_t near(const Region<times>& region, Packet limit_sq) const {
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < 3 * width; i += width) found |= near_boxes(region, boxes, i, limit_sq) << i;
    return found;
  }
};

/// The corners at which two edges of a mask meet.
LIMBER_KERNEL std::uint32_t between(std::uint32_t edges) { return edges & (edges << width | edges >> (2 * width)); }

/// Some edges of a leaf, one after the other: their boxes and vertices.
template <std::uint32_t times>
struct alignas(64) EdgeRow {
  EdgeBoxes boxes[times];
  VertexId from[EdgeBoxes::room], to[EdgeBoxes::room];
  std::uint8_t element[EdgeBoxes::room];  // as in ElementCandidate
  std::uint32_t count = 0;

  /// `edges` has a bit for each edge that is wanted.
  LIMBER_KERNEL EdgeRow(const LeafEdges<times>& leaf, const LeafVertices& vertices, std::uint32_t edges) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const unsigned which = edges >> (corner * width) & 0xff;
      // All eight are written; those that do not count are overwritten by the next, or not used.
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        const Slots wanted = Slots::second_of(numbers_of_bits[which].data() + i);
        for (std::uint32_t time = 0; time < times; ++time) {
          const EdgeBoxes& all = leaf.boxes[time];
          for (int axis = 0; axis < 3; ++axis) {
            pick(all.low[axis] + corner * width, wanted).store(boxes[time].low[axis] + count + i);
            pick(all.high[axis] + corner * width, wanted).store(boxes[time].high[axis] + count + i);
          }
        }
        pick(vertices.id[corner], wanted).store(from + count + i);
        pick(vertices.id[(corner + 1) % 3], wanted).store(to + count + i);
      }
      const std::uint64_t elements =
          std::bit_cast<std::uint64_t>(numbers_of_bits[which]) + corner * width * in_each_byte;
      std::memcpy(element + count, &elements, sizeof elements);
      count += static_cast<std::uint32_t>(std::popcount(which));
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

/// Lists edges whose boxes are close, without those that share a vertex: some of a with some of b. Of a leaf and itself
/// each edge comes with those after it. With `has_ids` vertices have ids of one model.
template <std::uint32_t times, typename List>
LIMBER_KERNEL void list_edges(const LeafEdges<times>& a, std::uint32_t edges_a, const LeafVertices& vertices_a,
                              bool has_ids, const EdgeRow<times>& row_b, bool is_same_leaf, Packet limit_sq,
                              List& list) {
  const std::uint32_t count_b = row_b.count;
  std::uint32_t wanted = (1U << count_b) - 1, n = 0;
  for (std::uint32_t edges = edges_a; edges != 0; edges &= edges - 1) {
    const auto edge = static_cast<std::uint32_t>(std::countr_zero(edges));
    const std::uint32_t next = edge < 2 * width ? edge + width : edge - 2 * width;
    const VertexId from = has_ids ? vertices_a.of_corner(edge) : no_id;
    const VertexId to = has_ids ? vertices_a.of_corner(next) : no_id;
    Region<times> box;
    for (std::uint32_t time = 0; time < times; ++time) {
      box.low[time] = repeated(a.boxes[time].low, edge), box.high[time] = repeated(a.boxes[time].high, edge);
    }
    if (is_same_leaf) wanted &= wanted - 1;
    const auto first_b = static_cast<std::uint32_t>(std::countr_zero(wanted));
    for (std::uint32_t first = first_b / width * width; first < count_b; first += width) {
      unsigned found = wanted >> first & near_boxes(box, row_b.boxes, first, limit_sq);
      if (has_ids) found &= ~row_b.with(from, to, first);
      n = list.add_behind(n, edge, found, first);
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) list.b[i] = row_b.element[list.b[i]];
  list.count = n;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

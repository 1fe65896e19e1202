// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_close_elements.

#if defined(LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#undef LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#else
#define LIMBER_SIMD_FIND_CLOSE_ELEMENTS_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>

#include "base/check.h"
#include "base/error_bounds.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/pair_list-inl.h"
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

/// The numbers of the bits of a byte, from the lowest on; then zeros.
inline constexpr auto numbers_of_bits = [] {
  std::array<std::array<std::uint8_t, width>, 256> table{};
  for (std::uint32_t byte = 0; byte < table.size(); ++byte) {
    std::size_t count = 0;
    for (std::uint8_t bit = 0; bit < width; ++bit) {
      if ((byte >> bit & 1) != 0) table[byte][count++] = bit;
    }
  }
  return table;
}();

inline constexpr std::uint64_t in_each_byte = 0x0101010101010101;

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

/// Which of eight boxes from `first` on are near a box, which every lane has: a bit for each.
template <typename Boxes>
LIMBER_KERNEL unsigned near_boxes(const Packet3& low, const Packet3& high, const Boxes& boxes, std::uint32_t first,
                                  Packet limit_sq) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 gaps = box_gaps(low, high, boxes, first + i);
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
template <typename List>
LIMBER_KERNEL void list_vertices(const LeafCorners& a, std::uint32_t vertices, const bvh::Leaf* leaf_a,
                                 const Boxes& faces_b, const LeafVertices& vertices_b, std::uint64_t near,
                                 Packet limit_sq, List& list) {
  for (vertices &= in_rows_with_bits(near); vertices != 0; vertices &= vertices - 1) {
    const auto vertex = static_cast<std::uint32_t>(std::countr_zero(vertices));
    const std::uint32_t corner = vertex / width, slot = vertex % width;
    const unsigned shared = leaf_a != nullptr ? faces_with(vertices_b, leaf_a->vertices[slot][corner]) : 0;
    const Packet3 point = repeated(a, corner, slot);
    list.add(vertex, row_of(near, slot) & near_boxes(point, point, faces_b, 0, limit_sq) & ~shared, 0);
  }
}

/// The boxes of the edges that a leaf owns, one after the other, and their vertices.
struct alignas(64) OwnedEdges {
  static constexpr std::uint32_t room = 3 * width + width;
  float low[3][room], high[3][room];
  VertexId from[room], to[room];
  std::uint8_t element[room];  // as in ElementCandidate
  std::uint32_t count = 0;

  /// `edges` has a bit for each edge that is owned.
  LIMBER_KERNEL OwnedEdges(const LeafCorners& c, const LeafVertices& vertices, std::uint32_t edges) {
    for (std::uint32_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t next = (corner + 1) % 3;
      const unsigned which = edges >> (corner * width) & 0xff;
      Boxes boxes;
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        const Packet3 p = corners(c, static_cast<int>(corner), i), q = corners(c, static_cast<int>(next), i);
        store3(min3(p, q), boxes.low, i), store3(max3(p, q), boxes.high, i);
      }
      // All eight are written; those that do not count are overwritten by the next, or not used.
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        const Slots owned = Slots::second_of(numbers_of_bits[which].data() + i);
        for (int axis = 0; axis < 3; ++axis) {
          pick(boxes.low[axis], owned).store(low[axis] + count + i);
          pick(boxes.high[axis], owned).store(high[axis] + count + i);
        }
        pick(vertices.id[corner], owned).store(from + count + i);
        pick(vertices.id[next], owned).store(to + count + i);
      }
      const std::uint64_t elements =
          std::bit_cast<std::uint64_t>(numbers_of_bits[which]) + corner * width * in_each_byte;
      std::memcpy(element + count, &elements, sizeof elements);
      count += static_cast<std::uint32_t>(std::popcount(which));
    }
  }
  /// Those, of eight from `first` on, that have one of two vertices.
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
template <typename List>
LIMBER_KERNEL void list_edges(const LeafCorners& a, std::uint32_t edges_a, const bvh::Leaf* leaf_a, std::uint64_t near,
                              const OwnedEdges& owned_b, bool is_same_leaf, Packet limit_sq, List& list) {
  for (std::uint32_t edges = edges_a & in_rows_with_bits(near); edges != 0; edges &= edges - 1) {
    const auto edge = static_cast<std::uint32_t>(std::countr_zero(edges));
    const std::uint32_t corner = edge / width, slot = edge % width, next = (corner + 1) % 3;
    const Packet3 p = repeated(a, corner, slot), q = repeated(a, next, slot);
    const Packet3 low = min3(p, q), high = max3(p, q);
    std::uint32_t wanted = (1U << owned_b.count) - 1;
    if (is_same_leaf) wanted &= ~((2U << std::popcount(edges_a & ((1U << edge) - 1))) - 1);
    for (std::uint32_t first = 0; first < owned_b.count; first += width) {
      unsigned found = wanted >> first & near_boxes(low, high, owned_b, first, limit_sq);
      if (leaf_a != nullptr) {
        found &= ~owned_b.with(leaf_a->vertices[slot][corner], leaf_a->vertices[slot][next], first);
      }
      list.add(edge, found, first);
    }
  }
}

/// Ratios of numbers that may both be 0, brought to [0, 1].
LIMBER_KERNEL Packet clamped_ratio(Packet numerator, Packet denominator) {
  const Packet least = Packet::set(smallest_denominator);
  return min(max(numerator / max(denominator, least), zero()), Packet::set(1));
}

/// Whether two sets are so far apart along w, which points from a to b, that the pair is pruned. `high_a` and `low_b`
/// are their ends along w.
LIMBER_KERNEL Mask are_apart(const Packet3& w, Packet high_a, Packet low_b, Packet limit_sq) {
  const Packet gap = max(low_b - high_a, zero());
  return is_pruned(gap * gap, dot(w, w), limit_sq);
}

/// Lanes in which the edges p0 p1 and q0 q1 are certainly apart: along the direction between their closest points. How
/// well these are known does not matter.
LIMBER_KERNEL unsigned edges_apart(const Packet3 (&points)[4], Packet limit_sq) {
  const Packet3 &p0 = points[0], &p1 = points[1], &q0 = points[2], &q1 = points[3];
  const Packet3 u = p1 - p0, v = q1 - q0, d = q0 - p0;
  const Packet uu = dot(u, u), vv = dot(v, v), uv = dot(u, v), ud = dot(u, d), vd = dot(v, d);
  const Packet start = clamped_ratio(ud * vv - uv * vd, uu * vv - uv * uv);
  const Packet t = clamped_ratio(start * uv - vd, vv), s = clamped_ratio(t * uv + ud, uu);
  const Packet3 w = d + v * t - u * s;
  return bits(are_apart(w, max(dot(w, p0), dot(w, p1)), min(dot(w, q0), dot(w, q1)), limit_sq));
}

/// Lanes in which a vertex, the first point, and a face are certainly apart: along the normal of the face, or along the
/// direction from the vertex to the closest point of the face's edges.
LIMBER_KERNEL unsigned vertex_face_apart(const Packet3 (&points)[4], Packet limit_sq) {
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
  const Packet low = min(min(dot(w, face[0]), dot(w, face[1])), dot(w, face[2]));
  const Packet3 n = cross(face[1] - face[0], face[2] - face[0]);
  // All three corners: in float32 the normal of a sliver is not perpendicular to it.
  const Interval heights = interval(dot(n, r[0]), dot(n, r[1]), dot(n, r[2]));
  const Packet gap = max(max(heights.low, zero() - heights.high), zero());
  return bits(are_apart(w, dot(w, vertex), low, limit_sq) | is_pruned(gap * gap, dot(n, n), limit_sq));
}

/// The corners of the triangles of a leaf, four numbers each: [corner][slot]. The first corner follows the last.
struct alignas(64) CornerPoints {
  float v[4 * width][4];

  LIMBER_KERNEL explicit CornerPoints(const LeafCorners& c) {
    for (std::uint32_t corner = 0; corner < 4; ++corner) {
      for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
        store_points(corners(c, static_cast<int>(corner % 3), i), v[corner * width + i]);
      }
    }
  }
};

/// Four points of each of several pairs of elements: [point][pair].
struct alignas(64) PairPoints {
  float v[4][chunk][4];

  LIMBER_KERNEL void set(std::uint32_t point, std::uint32_t pair, const CornerPoints& from, std::uint32_t at) {
    std::memcpy(v[point][pair], from.v[at], sizeof from.v[at]);
  }
  LIMBER_KERNEL Packet3 at(std::uint32_t point, std::uint32_t pair) const { return load_points3(v[point][pair]); }
};

/// How pairs of a vertex and a face are brought into packets and compared.
struct VertexFacePoints {
  const CornerPoints &of_vertices, &of_faces;

  LIMBER_KERNEL std::uint8_t element_b(std::uint8_t face) const { return face; }

  LIMBER_KERNEL void set(PairPoints& points, std::uint32_t i, std::uint32_t vertex, std::uint32_t face) const {
    points.set(0, i, of_vertices, vertex);
    for (std::uint32_t k = 0; k < 3; ++k) points.set(1 + k, i, of_faces, face + k * width);
  }
  static LIMBER_KERNEL unsigned find_apart(const Packet3 (&points)[4], Packet limit_sq) {
    return vertex_face_apart(points, limit_sq);
  }
};
/// How pairs of edges are brought into packets and compared; the second edge is named by its place in OwnedEdges.
struct EdgePoints {
  const CornerPoints &a, &b;
  const OwnedEdges& edges_b;

  LIMBER_KERNEL std::uint8_t element_b(std::uint8_t place) const { return edges_b.element[place]; }

  LIMBER_KERNEL void set(PairPoints& points, std::uint32_t i, std::uint32_t edge_a, std::uint32_t place_b) const {
    const std::uint32_t edge_b = edges_b.element[place_b];
    points.set(0, i, a, edge_a), points.set(1, i, a, edge_a + width);
    points.set(2, i, b, edge_b), points.set(3, i, b, edge_b + width);
  }
  static LIMBER_KERNEL unsigned find_apart(const Packet3 (&points)[4], Packet limit_sq) {
    return edges_apart(points, limit_sq);
  }
};

/// Takes over the pairs of a list that are not certainly apart; with `swaps` the two elements change places.
template <bool swaps, typename List, typename Points, typename Kept>
LIMBER_KERNEL void keep_close(const List& list, Packet limit_sq, const Points& elements, Kept& kept) {
  PairPoints points;
  for (std::uint32_t first = 0; first < list.count; first += chunk) {
    const std::uint32_t count = std::min(chunk, list.count - first);
    // The last pair fills its packet.
    for (std::uint32_t i = 0; i < count || i % Packet::lanes != 0; ++i) {
      const std::uint32_t pair = std::min(first + i, list.count - 1);
      elements.set(points, i, list.a[pair], list.b[pair]);
    }
    for (std::uint32_t i = 0; i < count; i += Packet::lanes) {
      const Packet3 of_pairs[4] = {points.at(0, i), points.at(1, i), points.at(2, i), points.at(3, i)};
      const unsigned apart = Points::find_apart(of_pairs, limit_sq);
      for (std::uint32_t lane = 0; lane < std::min(Packet::lanes, count - i); ++lane) {
        const std::uint8_t a = list.a[first + i + lane], b = elements.element_b(list.b[first + i + lane]);
        kept.pairs[kept.count] = swaps ? ElementCandidate{b, a} : ElementCandidate{a, b};
        kept.count += ~apart >> lane & 1;
      }
    }
  }
}

LIMBER_KERNEL void find_close_elements(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                       const PruneLimits& pruning, OwnedElements owned_by_a, OwnedElements owned_by_b,
                                       const SelfPair* self, ElementCandidates& found) {
  LIMBER_ASSERT(!pruning.has_direction);
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  const ProjectedLeaves pair = project_leaves(a, b, transform, pruning);
  LeafCorners ca, cb;
  unpack(*a.triangles, pair.step_a, ca);
  if (self != nullptr) {
    unpack(*b.triangles, pair.step_b, cb);
    shift_corners(cb, pair.offset, cb);
  } else {
    unpack(*b.triangles, pair.step_b, transform, pair.offset, cb);
  }
  const float limit = pair.prune_distance + pair.error;
  const Packet limit_sq = Packet::set(limit * limit * base::squares_up);
  // A byte for each kind of element, with a bit for each slot; the last kind is a slot in use.
  const std::uint64_t owned_a = transpose(owned_by_a.of_slots), owned_b = transpose(owned_by_b.of_slots);
  const bool is_same_leaf = self != nullptr && &self->a == &self->b;
  Boxes faces_a, faces_b;
  find_boxes(ca, faces_a), find_boxes(cb, faces_b);
  std::uint64_t near = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    const unsigned of_row = near_boxes(repeated(faces_a.low, row), repeated(faces_a.high, row), faces_b, 0, limit_sq);
    near |= std::uint64_t{of_row & row_of(owned_b, 6) & (0U - (row_of(owned_a, 6) >> row & 1))} << (8 * row);
  }
  if (is_same_leaf) near &= bvh::each_pair_once;
  if (near == 0) return;

  const bvh::Leaf *const leaf_a = self != nullptr ? &self->a : nullptr, *const leaf_b =
                                                                            self != nullptr ? &self->b : nullptr;
  const LeafVertices vertices_a(leaf_a), vertices_b(leaf_b);
  ElementList<3 * width * width> vertex_face, vertex_face_swapped;
  ElementList<9 * width * width> edge_edge;
  list_vertices(ca, vertices_in(owned_a), leaf_a, faces_b, vertices_b, near, limit_sq, vertex_face);
  list_vertices(cb, vertices_in(owned_b), leaf_b, faces_a, vertices_a, transpose(near), limit_sq, vertex_face_swapped);
  const OwnedEdges edges_b(cb, vertices_b, edges_in(owned_b));
  list_edges(ca, edges_in(owned_a), leaf_a, is_same_leaf ? near | transpose(near) : near, edges_b, is_same_leaf,
             limit_sq, edge_edge);

  if (vertex_face.count + vertex_face_swapped.count + edge_edge.count == 0) return;
  const CornerPoints points_a(ca), points_b(cb);
  keep_close<false>(vertex_face, limit_sq, VertexFacePoints{points_a, points_b}, found.vertex_face);
  keep_close<true>(vertex_face_swapped, limit_sq, VertexFacePoints{points_b, points_a}, found.face_vertex);
  keep_close<false>(edge_edge, limit_sq, EdgePoints{points_a, points_b, edges_b}, found.edge_edge);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// For a mesh that is compared with itself: removes those pairs of neighbors that certainly have nothing in common but
// the vertex or the edge that they share, since a line or a plane through it separates them. And the lists of pairs
// that this needs.
//
// 1. shared_corners() finds which corners of two triangles are the same vertex.
// 2. separated_by_line(): a line along an edge, in the images of both along an axis. Few operations, so it is first.
// 3. separated_by_plane(), for the pairs that are left: planes through the shared corner or edge.
//
// Corners are quantized, so each test leaves room for errors; pairs that it cannot tell apart stay in the list. Bit k
// of what is called `_lanes` stands for lane k, which holds a pair.

#if defined(LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#undef LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#else
#define LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/error_bounds.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Lists of pairs, and their corners, a pair in each lane. Other kernels use them too.

static_assert(width == 8, "a mask of slots is a byte, and a mask of pairs has a byte for each slot of the first leaf");

/// The numbers of the bits of a byte, from the lowest on; then zeros. A table of 2 kB, because processors cannot
/// predict where a loop over the bits ends.
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

/// Times this, a byte is repeated in all bytes.
inline constexpr std::uint64_t in_each_byte = 0x0101010101010101;

/// Corner `k` of the triangles in the slots `i` and following.
LIMBER_KERNEL Packet3 corners(const LeafCorners& c, int k, std::uint32_t i) {
  return {Packet::load(c.v[3 * k] + i), Packet::load(c.v[3 * k + 1] + i), Packet::load(c.v[3 * k + 2] + i)};
}
/// Corner `k` of the triangles in some slots.
LIMBER_KERNEL Packet3 corners(const LeafCorners& c, int k, const Slots& slots) {
  return {pick(c.v[3 * k], slots), pick(c.v[3 * k + 1], slots), pick(c.v[3 * k + 2], slots)};
}

/// Pairs of triangles of two leaves, as width * slot of the first + slot of the second. There is room for a packet more
/// than there are pairs, so that whole packets may be written and read.
struct PairList {
  alignas(64) std::uint8_t pair[width * width + width];
  std::uint32_t count = 0;

  /// Appends the pairs whose bits are set: bit width * i + k is slot i of the first leaf and slot k of the second.
  LIMBER_KERNEL void add(std::uint64_t pairs) {
    std::uint32_t n = count;  // a local variable: bytes that are written could be any other
    for (std::uint32_t row = 0; row < width; ++row, pairs >>= width) {
      const auto& numbers = numbers_of_bits[pairs & 0xff];
      const std::uint64_t of_row = std::bit_cast<std::uint64_t>(numbers) + row * width * in_each_byte;
      std::memcpy(pair + n, &of_row, sizeof of_row);  // bytes that do not count are overwritten, or not used
      n += static_cast<std::uint32_t>(std::popcount(pairs & 0xff));
    }
    count = n;
  }
  /// Appends pairs of another list: those of the packet from its pair `i` on that are in `lanes`.
  LIMBER_KERNEL void add(const PairList& list, std::uint32_t i, unsigned lanes) {
    std::uint32_t n = count;
    for (; lanes != 0; lanes &= lanes - 1) {
      pair[n++] = list.pair[i + static_cast<std::uint32_t>(std::countr_zero(lanes))];
    }
    count = n;
  }
  /// Makes lanes after the last pair hold some pair.
  LIMBER_KERNEL void fill_last_packet() { std::fill_n(pair + count, width, std::uint8_t{0}); }
  /// The lanes, from pair `i` on, that hold a pair of the list.
  LIMBER_KERNEL unsigned lanes_at(std::uint32_t i) const { return (1U << std::min(count - i, Packet::lanes)) - 1; }
};

/// A leaf of a mesh that is compared with itself: the vertices of its triangles, [corner][slot]; their corners, each
/// leaf about its own center, so that differences of two corners are good to a few quantization steps.
struct SelfLeaf {
  alignas(64) VertexId id[3][width];
  const LeafCorners& positions;
  float extent;  // of all coordinates
  float error;   // of a coordinate of the difference of two corners

  /// `away` is the most that a corner may be away from where the leaf says it is, beside quantization.
  LIMBER_KERNEL SelfLeaf(const bvh::Leaf& leaf, const LeafCorners& corners_of_leaf, float step, float away)
      : positions(corners_of_leaf),
        extent(bvh::max_quantized * step),
        error((base::corner_difference_error * step + 2 * away) * base::squares_up) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      deinterleave(leaf.vertices[i].data(), id[0] + i, id[1] + i, id[2] + i);
    }
  }
};

/// Which corners of two triangles are the same vertex.
struct SharedCorners {
  Mask a[3], b[3];     // corner k of one is a corner of the other
  unsigned one_lanes;  // an odd number of corners of each is shared: one, or three
  unsigned two_lanes;  // most corners of each are shared: two, or three
};

template <typename Leaf>
LIMBER_KERNEL SharedCorners shared_corners(const Leaf& a, const Slots& in_a, const Leaf& b, const Slots& in_b) {
  Mask same[3][3];
  const Ids of_b[3] = {pick(b.id[0], in_b), pick(b.id[1], in_b), pick(b.id[2], in_b)};
  for (int k = 0; k < 3; ++k) {
    const Ids of_a = pick(a.id[k], in_a);
    for (int l = 0; l < 3; ++l) same[k][l] = of_a == of_b[l];
  }
  SharedCorners s;
  for (int k = 0; k < 3; ++k) {
    s.a[k] = same[k][0] | same[k][1] | same[k][2];
    s.b[k] = same[0][k] | same[1][k] | same[2][k];
  }
  // Parity and majority. Where three corners are shared both bits are set, and whatever the tests below say is right:
  // triangles with equal corners have nothing in common but what they share. A triangle may name a vertex more than
  // once. {5, 5, 6} next to {5, 7, 8} shares two corners of the one and one of the other: neither bit is set, and the
  // pair is kept. Next to {5, 5, 7} it shares an edge that has no length, so it proves nothing.
  const auto odd_mask = [](const Mask(&of)[3]) { return of[0] ^ of[1] ^ of[2]; };
  const auto most_mask = [](const Mask(&of)[3]) { return (of[0] & of[1]) | ((of[0] ^ of[1]) & of[2]); };
  s.one_lanes = bits(odd_mask(s.a) & odd_mask(s.b));
  s.two_lanes = bits(most_mask(s.a) & most_mask(s.b));
  return s;
}

// Separation by a line. Seen along an axis, a triangle lies in a sector at its shared corner s, between its edges a0
// and a1 from there. Two triangles have but that corner in common if a line through s along one of the four edges has
// them on its two sides:
//
//         a1   a0                                    a1
//          \ a |                                       \  a
//           \  |   b1                                   \      left
//            \ |  /                                      s ---------- a0 = b0
//             \| /  b                                   /      right
//              s ------ b0                             /  b
//                                                     b1
//   One shared corner: a is on the left         Two shared corners: a1 is on the left
//   of a0, and b0 and b1 are on its right.      of the shared edge, and b1 on its right.
//
// Which corners these are follows from the mask of those that are shared. With 0, 1, 2 for the corners of a triangle:
//
//   shared               0    1    2   | 0 1   0 2   1 2
//   s                    0    1    2   |  0     0     1
//   first other, a0      2    2    1   |  1     2     2     of two shared corners the second
//   second other, a1     1    0    0   |  2     1     0     of two shared corners the one that is not shared: the apex
//
// s of b may be the other end of a shared edge. Then b1 starts there, which does not change on which side of a0 it is.

/// A triangle with a shared corner in the plane of two axes, seen from there; the corners are those of the table above.
struct Sector {
  Packet x[2], y[2];  // of a0 and a1: from s to the first and to the second other corner

  LIMBER_KERNEL Sector(const Mask (&shared)[3], const LeafCorners& c, const Slots& slots, const int (&axes)[2]) {
    const Mask first_is_2_mask = shared[0] ^ shared[1];  // the first other corner is 2, elsewhere 1
    Packet* const to[2] = {x, y};
    for (int k = 0; k < 2; ++k) {
      const Packet p0 = pick(c.v[axes[k]], slots), p1 = pick(c.v[3 + axes[k]], slots);
      const Packet p2 = pick(c.v[6 + axes[k]], slots);
      const Packet s = select(shared[0], p0, select(shared[1], p1, p2));
      to[k][0] = select(first_is_2_mask, p2, p1) - s;
      to[k][1] = select(shared[0], select(shared[1], p2, p1), p0) - s;
    }
  }
};

/// The largest errors of cross products of sectors.
struct SectorErrors {
  Packet aa, ab, bb;
};

/// Lanes in which a line through the shared corner, along an edge of one of the triangles, separates their images: the
/// triangles have only the shared corner in common, or the shared edge. A sector that is as narrow as its error has no
/// left and right: its edges separate nothing.
LIMBER_KERNEL unsigned separated_by_line(const SharedCorners& shared, const Sector& a, const Sector& b,
                                         const SectorErrors& error) {
  const auto turn = [](const Sector& p, int i, const Sector& q, int j) { return p.x[i] * q.y[j] - p.y[i] * q.x[j]; };
  const Packet turn_a = turn(a, 0, a, 1), turn_b = turn(b, 0, b, 1);
  const Packet t00 = turn(a, 0, b, 0), t01 = turn(a, 0, b, 1), t10 = turn(a, 1, b, 0), t11 = turn(a, 1, b, 1);
  // a_ij is a_i x b_j, mirrored so that a turns left from a0 to a1: > 0 means that b_j is left of a_i. b_ij is the same
  // product, mirrored so that b turns left: > 0 means that a_i is right of b_j.
  const Packet a00 = flipped_as(t00, turn_a), a01 = flipped_as(t01, turn_a), a10 = flipped_as(t10, turn_a),
               a11 = flipped_as(t11, turn_a);
  const Packet b00 = flipped_as(t00, turn_b), b01 = flipped_as(t01, turn_b), b10 = flipped_as(t10, turn_b),
               b11 = flipped_as(t11, turn_b);
  const Mask a_turns_mask = abs(turn_a) > error.aa, b_turns_mask = abs(turn_b) > error.bb;
  // How far b0 and b1 are right of a0, or left of a1. And how far a0 and a1 are right of b0, or left of b1.
  const Packet beyond_a = max(zero() - max(a00, a01), min(a10, a11));
  const Packet beyond_b = max(min(b00, b10), zero() - max(b01, b11));
  const Mask one_mask = (a_turns_mask & (beyond_a > error.ab)) | (b_turns_mask & (beyond_b > error.ab));
  // a0 is the shared edge: a1 is left of it, since a turns left, and b1 right.
  const Mask two_mask = a_turns_mask & (zero() - a01 > error.ab);
  return (bits(one_mask) & shared.one_lanes) | (bits(two_mask) & shared.two_lanes);
}

/// Errors of the difference of two corners of a triangle: of each coordinate, and of its length.
struct CornerError {
  Packet coordinate, length;
};

/// Lanes in which a plane through the one shared corner separates the triangles.
///
/// The plane is perpendicular to m, the sum of b's edges from that corner less those of a. Any plane would do: if the
/// other corners are on different sides of it, strictly, the triangles have only the shared corner in common.
LIMBER_KERNEL unsigned separated_at_corner(const SharedCorners& shared, const Packet3 (&a)[3], const Packet3 (&b)[3],
                                           const CornerError& error_a, const CornerError& error_b) {
  const Packet3 at_a = select(shared.a[0], a[0], select(shared.a[1], a[1], a[2]));
  const Packet3 at_b = select(shared.b[0], b[0], select(shared.b[1], b[1], b[2]));
  const Packet3 p[3] = {a[0] - at_a, a[1] - at_a, a[2] - at_a}, q[3] = {b[0] - at_b, b[1] - at_b, b[2] - at_b};
  const Packet3 m = (q[0] + q[1] + q[2]) - (p[0] + p[1] + p[2]);
  const Packet far = Packet::set(far_off);  // the shared corner is on the plane, and does not count
  Packet nearest_a = far, nearest_b = far;
  for (int k = 0; k < 3; ++k) {
    nearest_a = min(nearest_a, select(shared.a[k], far, zero() - dot(m, p[k])));
    nearest_b = min(nearest_b, select(shared.b[k], far, dot(m, q[k])));
  }
  const Packet sum = abs(m.x) + abs(m.y) + abs(m.z);
  return bits((nearest_a > sum * error_a.coordinate) & (nearest_b > sum * error_b.coordinate));
}

/// Inner products of an edge e, and of vectors p and q to another corner of either triangle.
struct EdgeProducts {
  Packet ee, ep, eq, pq, pp, qq;
};

/// Where (e x p) . (e x q) is certainly negative: p and q are on different sides of the plane along e that is
/// perpendicular to the plane of e and p (docs/algorithms/intersection.md). p and q may start at either end of e, as
/// their parts along e do not count.
LIMBER_KERNEL Mask edge_plane_separates(const EdgeProducts& d, Packet error_e, Packet error_p, Packet error_q) {
  const Packet across = d.ee * d.pq - d.ep * d.eq;
  const Packet e = sqrt(d.ee), p = sqrt(d.pp), q = sqrt(d.qq), most_e = e + error_e;
  // What errors of the three change the product by, and what rounding does.
  const Packet changed = most_e * most_e * (p + error_p) * (q + error_q) * Packet::set(base::squares_up) -
                         d.ee * p * q * Packet::set(base::squares_down);
  const Packet rounding = d.ee * (d.pp + d.qq) * Packet::set(base::edge_plane_error);
  return across + changed + rounding < zero();
}

/// Lanes in which a plane through the shared edge separates the triangles.
LIMBER_KERNEL unsigned separated_at_edge(const SharedCorners& shared, const Packet3 (&a)[3], const Packet3 (&b)[3],
                                         const CornerError& error_a, const CornerError& error_b) {
  // The corner of a that is not shared, and the ends v and w of the edge; q starts at either of them.
  const Packet3 apex_a = select(shared.a[0], select(shared.a[1], a[2], a[1]), a[0]);
  const Packet3 v = select(shared.a[0], a[0], a[1]);
  const Packet3 w = select(shared.a[0], select(shared.a[1], a[1], a[2]), a[2]);
  const Packet3 apex_b = select(shared.b[0], select(shared.b[1], b[2], b[1]), b[0]);
  const Packet3 e = w - v, p = apex_a - v, q = apex_b - select(shared.b[0], b[0], b[1]);
  return bits(edge_plane_separates({dot(e, e), dot(e, p), dot(e, q), dot(p, q), dot(p, p), dot(q, q)}, error_a.length,
                                   error_a.length, error_b.length));
}

/// Lanes in which a plane through an edge of `a` at the one shared corner, perpendicular to `a`, separates the
/// triangles: both other corners of b, q1 and q2, are beyond it, seen from the other edge of `a`.
LIMBER_KERNEL unsigned separated_along_edges(const Mask (&shared_a)[3], const Packet3 (&a)[3], Packet error_a,
                                             const Mask (&shared_b)[3], const Packet3 (&b)[3], Packet error_b) {
  const Packet3 at_a = select(shared_a[0], a[0], select(shared_a[1], a[1], a[2]));
  const Packet3 at_b = select(shared_b[0], b[0], select(shared_b[1], b[1], b[2]));
  const Packet3 p1 = select(shared_a[0], a[1], a[0]) - at_a, p2 = select(shared_a[2], a[1], a[2]) - at_a;
  const Packet3 q1 = select(shared_b[0], b[1], b[0]) - at_b, q2 = select(shared_b[2], b[1], b[2]) - at_b;
  const Packet p11 = dot(p1, p1), p12 = dot(p1, p2), p22 = dot(p2, p2), q11 = dot(q1, q1), q22 = dot(q2, q2);
  const Packet p1q1 = dot(p1, q1), p1q2 = dot(p1, q2), p2q1 = dot(p2, q1), p2q2 = dot(p2, q2);
  const auto apart = [&](const EdgeProducts& d) { return edge_plane_separates(d, error_a, error_a, error_b); };
  return bits((apart({p11, p12, p1q1, p2q1, p22, q11}) & apart({p11, p12, p1q2, p2q2, p22, q22})) |
              (apart({p22, p12, p2q1, p1q1, p11, q11}) & apart({p22, p12, p2q2, p1q2, p11, q22})));
}

/// Lanes in which a plane separates the triangles beyond the corner or the edge that they share.
LIMBER_KERNEL unsigned separated_by_plane(const SharedCorners& shared, const Packet3 (&a)[3], const Packet3 (&b)[3],
                                          const CornerError& error_a, const CornerError& error_b) {
  unsigned apart_lanes = 0;
  if (shared.one_lanes != 0) {
    apart_lanes |= shared.one_lanes & separated_at_corner(shared, a, b, error_a, error_b);
    if ((shared.one_lanes & ~apart_lanes) != 0) {
      apart_lanes |=
          shared.one_lanes & (separated_along_edges(shared.a, a, error_a.length, shared.b, b, error_b.length) |
                              separated_along_edges(shared.b, b, error_b.length, shared.a, a, error_a.length));
    }
  }
  if (shared.two_lanes != 0) apart_lanes |= shared.two_lanes & separated_at_edge(shared, a, b, error_a, error_b);
  return apart_lanes;
}

/// Removes those pairs from a list that share one vertex or one edge and certainly have nothing else in common. Those
/// that the tests treat as neighbors but keep go to its end. Lines are tried in the plane of two axes: any are right.
LIMBER_KERNEL void remove_separated_neighbors(const SelfLeaf& a, const SelfLeaf& b, const int (&axes)[2],
                                              PairList& pairs) {
  // Coordinates of differences are at most twice the extent.
  const auto error_of = [](const SelfLeaf& p, const SelfLeaf& q) {
    const float crossed = 4 * (p.extent * q.error + q.extent * p.error) + 2 * p.error * q.error;
    const float rounding = base::sector_rounding_error * p.extent * q.extent;
    return Packet::set((crossed + rounding) * base::squares_up);
  };
  const SectorErrors errors{error_of(a, a), error_of(a, b), error_of(b, b)};
  PairList open;
  std::uint32_t kept = 0;
  pairs.fill_last_packet();
  for (std::uint32_t i = 0; i < pairs.count; i += Packet::lanes) {
    const unsigned lanes = pairs.lanes_at(i);
    const Slots in_a = Slots::first_of(pairs.pair + i), in_b = Slots::second_of(pairs.pair + i);
    const SharedCorners shared = shared_corners(a, in_a, b, in_b);
    const unsigned neighbor_lanes = shared.one_lanes | shared.two_lanes;
    unsigned apart_lanes = 0;
    if ((neighbor_lanes & lanes) != 0) {
      apart_lanes = separated_by_line(shared, Sector(shared.a, a.positions, in_a, axes),
                                      Sector(shared.b, b.positions, in_b, axes), errors);
    }
    open.add(pairs, i, lanes & neighbor_lanes & ~apart_lanes);
    // In place: as many have been read.
    for (unsigned rest = lanes & ~neighbor_lanes; rest != 0; rest &= rest - 1) {
      pairs.pair[kept++] = pairs.pair[i + static_cast<std::uint32_t>(std::countr_zero(rest))];
    }
  }
  pairs.count = kept;
  if (open.count == 0) return;
  const auto corner_error = [](const SelfLeaf& leaf) {
    constexpr float root_of_3 = 1.7321F;  // rounded up
    return CornerError{Packet::set(leaf.error), Packet::set(leaf.error * root_of_3)};
  };
  const CornerError error_a = corner_error(a), error_b = corner_error(b);
  open.fill_last_packet();
  for (std::uint32_t i = 0; i < open.count; i += Packet::lanes) {
    const Slots in_a = Slots::first_of(open.pair + i), in_b = Slots::second_of(open.pair + i);
    const Packet3 p[3] = {corners(a.positions, 0, in_a), corners(a.positions, 1, in_a), corners(a.positions, 2, in_a)};
    const Packet3 q[3] = {corners(b.positions, 0, in_b), corners(b.positions, 1, in_b), corners(b.positions, 2, in_b)};
    const unsigned apart_lanes = separated_by_plane(shared_corners(a, in_a, b, in_b), p, q, error_a, error_b);
    pairs.add(open, i, open.lanes_at(i) & ~apart_lanes);
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

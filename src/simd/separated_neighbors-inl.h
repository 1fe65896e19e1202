// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles of one mesh that share vertices: which of them certainly have nothing else in common.

#if defined(LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#undef LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#else
#define LIMBER_SIMD_SEPARATED_NEIGHBORS_INL_H
#endif

#include <algorithm>
#include <cstdint>

#include "core/check.h"
#include "core/error_bounds.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The vertices of the triangles of a leaf: [corner][slot].
struct alignas(64) LeafVertices {
  VertexId id[3][width];
};

LIMBER_KERNEL void transpose_vertices(const bvh::Leaf& leaf, LeafVertices& v) {
  for (std::uint32_t slot = 0; slot < width; ++slot) {
    for (std::size_t corner = 0; corner < 3; ++corner) v.id[corner][slot] = leaf.vertices[slot][corner];
  }
}

/// Which corners of two triangles are the same vertex.
struct SharedCorners {
  Mask a[3], b[3];    // corner k of one is a corner of the other
  unsigned one, two;  // lanes: as many corners of a are
};

LIMBER_KERNEL SharedCorners shared_corners(const std::array<VertexId, 3>& a, const LeafVertices& b, std::uint32_t i) {
  Mask same[3][3];
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < 3; ++l) same[k][l] = same_ids(b.id[l] + i, a[static_cast<std::size_t>(k)]);
  }
  SharedCorners s;
  for (int k = 0; k < 3; ++k) {
    s.a[k] = same[k][0] | same[k][1] | same[k][2];
    s.b[k] = same[0][k] | same[1][k] | same[2][k];
  }
  const auto count_of = [](const Mask(&of)[3], unsigned& one, unsigned& two) {
    const unsigned x = bits(of[0]), y = bits(of[1]), z = bits(of[2]);
    two = ((x & y) | (y & z) | (x & z)) & ~(x & y & z);
    one = (x ^ y ^ z) & ~(x & y & z);
  };
  // A triangle may name a vertex more than once; then the counts differ.
  unsigned one_b = 0, two_b = 0;
  count_of(s.a, s.one, s.two);
  count_of(s.b, one_b, two_b);
  s.one &= one_b, s.two &= two_b;
  return s;
}

LIMBER_KERNEL Packet3 corner_of(const bvh::QuantizedTriangles& leaf, int corner, std::uint32_t i, Packet step) {
  return {Packet::from_int16(leaf.corner[3 * corner] + i) * step,
          Packet::from_int16(leaf.corner[3 * corner + 1] + i) * step,
          Packet::from_int16(leaf.corner[3 * corner + 2] + i) * step};
}
LIMBER_KERNEL Packet3 corner_of(const bvh::QuantizedTriangles& leaf, int corner, std::uint32_t slot) {
  return {Packet::set(leaf.corner[3 * corner][slot]), Packet::set(leaf.corner[3 * corner + 1][slot]),
          Packet::set(leaf.corner[3 * corner + 2][slot])};
}

/// Errors of the difference of two corners of a triangle: of each coordinate, and of its length.
struct CornerError {
  Packet coordinate, length;
};

/// Lanes in which a plane through the one shared corner separates the triangles.
///
/// The plane is across the sum of the edges of b from that corner less those of a. Whatever it is: if the other corners
/// are on different sides of it, strictly, the triangles have only the shared corner in common.
LIMBER_KERNEL unsigned separated_at_corner(const SharedCorners& shared, const Packet3 (&a)[3], const Packet3 (&b)[3],
                                           const CornerError& error_a, const CornerError& error_b) {
  const Packet3 at_a = select(shared.a[0], a[0], select(shared.a[1], a[1], a[2]));
  const Packet3 at_b = select(shared.b[0], b[0], select(shared.b[1], b[1], b[2]));
  const Packet3 p[3] = {a[0] - at_a, a[1] - at_a, a[2] - at_a}, q[3] = {b[0] - at_b, b[1] - at_b, b[2] - at_b};
  const Packet3 m = (q[0] + q[1] + q[2]) - (p[0] + p[1] + p[2]);
  const Packet far = Packet::set(far_off);
  Packet nearest_a = far, nearest_b = far;
  for (int k = 0; k < 3; ++k) {
    nearest_a = min(nearest_a, select(shared.a[k], far, zero() - dot(m, p[k])));
    nearest_b = min(nearest_b, select(shared.b[k], far, dot(m, q[k])));
  }
  const Packet sum = abs(m.x) + abs(m.y) + abs(m.z);
  return bits((nearest_a > sum * error_a.coordinate) & (nearest_b > sum * error_b.coordinate));
}

/// Inner products of three vectors.
struct EdgeProducts {
  Packet ee, ep, eq, pq, pp, qq;
};

/// Whether (e x p) . (e x q) is certainly negative: p and q are on different sides of the plane along e that is
/// perpendicular to the plane of e and p (docs/algorithms/intersection.md).
LIMBER_KERNEL Mask point_apart(const EdgeProducts& d, Packet error_e, Packet error_p, Packet error_q) {
  const Packet across = d.ee * d.pq - d.ep * d.eq;
  const Packet e = sqrt(d.ee), p = sqrt(d.pp), q = sqrt(d.qq), most_e = e + error_e;
  // What errors of the three change the product by, and what rounding does.
  const Packet changed = most_e * most_e * (p + error_p) * (q + error_q) * Packet::set(core::squares_up) -
                         d.ee * p * q * Packet::set(core::squares_down);
  return across + changed + d.ee * (d.pp + d.qq) * Packet::set(core::edge_plane_error) < zero();
}

/// Lanes in which a plane through the shared edge separates the triangles.
LIMBER_KERNEL unsigned separated_at_edge(const SharedCorners& shared, const Packet3 (&a)[3], const Packet3 (&b)[3],
                                         const CornerError& error_a, const CornerError& error_b) {
  // The corner of a that is not shared, and those of the edge.
  const Packet3 apex_a = select(shared.a[0], select(shared.a[1], a[2], a[1]), a[0]);
  const Packet3 v = select(shared.a[0], a[0], a[1]);
  const Packet3 w = select(shared.a[0], select(shared.a[1], a[1], a[2]), a[2]);
  const Packet3 apex_b = select(shared.b[0], select(shared.b[1], b[2], b[1]), b[0]);
  const Packet3 e = w - v, p = apex_a - v, q = apex_b - select(shared.b[0], b[0], b[1]);
  return bits(point_apart({dot(e, e), dot(e, p), dot(e, q), dot(p, q), dot(p, p), dot(q, q)}, error_a.length,
                          error_a.length, error_b.length));
}

/// The same for one shared corner, with the planes along the edges of `a` from there, perpendicular to that triangle: b
/// is beyond one of them.
LIMBER_KERNEL unsigned separated_along_edges(const Mask (&shared_a)[3], const Packet3 (&a)[3], Packet error_a,
                                             const Mask (&shared_b)[3], const Packet3 (&b)[3], Packet error_b) {
  const Packet3 at_a = select(shared_a[0], a[0], select(shared_a[1], a[1], a[2]));
  const Packet3 at_b = select(shared_b[0], b[0], select(shared_b[1], b[1], b[2]));
  const Packet3 p1 = select(shared_a[0], a[1], a[0]) - at_a, p2 = select(shared_a[2], a[1], a[2]) - at_a;
  const Packet3 q1 = select(shared_b[0], b[1], b[0]) - at_b, q2 = select(shared_b[2], b[1], b[2]) - at_b;
  const Packet p11 = dot(p1, p1), p12 = dot(p1, p2), p22 = dot(p2, p2), q11 = dot(q1, q1), q22 = dot(q2, q2);
  const Packet p1q1 = dot(p1, q1), p1q2 = dot(p1, q2), p2q1 = dot(p2, q1), p2q2 = dot(p2, q2);
  const auto apart = [&](const EdgeProducts& d) { return point_apart(d, error_a, error_a, error_b); };
  return bits((apart({p11, p12, p1q1, p2q1, p22, q11}) & apart({p11, p12, p1q2, p2q2, p22, q22})) |
              (apart({p22, p12, p2q1, p1q1, p11, q11}) & apart({p22, p12, p2q2, p1q2, p11, q22})));
}

/// Of the `wanted` pairs, those that share one vertex or one edge and certainly have nothing else in common: bit
/// 8 * i + j is triangle i of a and j of b. `radius_a` and `radius_b` are those of the leaves' spheres, `error` is the
/// most that a vertex may be away from where a leaf says it is, beside quantization; all in units of the tree.
LIMBER_KERNEL std::uint64_t separated_neighbors(const bvh::Leaf& a, const bvh::Leaf& b, float radius_a, float radius_b,
                                                float error, std::uint64_t wanted) {
  LIMBER_ASSERT(radius_a >= 0 && radius_b >= 0 && error >= 0);
  LeafVertices vertices;
  transpose_vertices(b, vertices);
  // Lengths are in quantization steps of a.
  const float step = radius_b / radius_a, lost = 2 * error * (bvh::max_quantized / radius_a) * core::squares_up;
  const Packet steps = Packet::set(step);
  const auto error_of = [lost](float s) {
    return CornerError{Packet::set(core::corner_difference_error * s + lost),
                       Packet::set(core::corner_difference_error * core::root_of_3 * s + lost)};
  };
  const CornerError error_a = error_of(1), error_b = error_of(step);
  std::uint64_t found = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const auto these = static_cast<unsigned>(wanted >> (8 * row + i)) & ((1U << Packet::lanes) - 1);
      if (these == 0) continue;
      const SharedCorners shared = shared_corners(a.vertices[row], vertices, i);
      const unsigned one = shared.one & these, two = shared.two & these;
      if ((one | two) == 0) continue;
      const Packet3 corners_a[3] = {corner_of(a.corners, 0, row), corner_of(a.corners, 1, row),
                                    corner_of(a.corners, 2, row)};
      const Packet3 corners_b[3] = {corner_of(b.corners, 0, i, steps), corner_of(b.corners, 1, i, steps),
                                    corner_of(b.corners, 2, i, steps)};
      unsigned apart = 0;
      if (one != 0) {
        apart |= one & separated_at_corner(shared, corners_a, corners_b, error_a, error_b);
        if ((one & ~apart) != 0) {
          apart |=
              one & (separated_along_edges(shared.a, corners_a, error_a.length, shared.b, corners_b, error_b.length) |
                     separated_along_edges(shared.b, corners_b, error_b.length, shared.a, corners_a, error_a.length));
        }
      }
      if (two != 0) apart |= two & separated_at_edge(shared, corners_a, corners_b, error_a, error_b);
      found |= std::uint64_t{apart} << (8 * row + i);
    }
  }
  return found;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

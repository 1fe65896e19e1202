// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::compare_segments, compare_triangles and refine_candidates, a pair in each lane.
//
// Based on  the clamped closest-point iteration of [Ericson2005], section 5.1.9.
// Differs   As geometry/features.h says; the arithmetic is the same, number by number.

#if defined(LIMBER_SIMD_COMPARE_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#undef LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#else
#define LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "base/rounding.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/separated_neighbors-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

template <typename P>
LIMBER_KERNEL P clamped_quotient(P numerator, P denominator) {
  const P zero = P::set(0), one = P::set(1);
  const P quotient = select(numerator >= denominator, one, numerator / denominator);
  return select((denominator > zero) & (numerator > zero), quotient, zero);
}

/// Closest points of segments: parameters from 0 to 1, and what is between the points.
template <typename P>
struct ClosestOnSegments {
  P s, t;
  Triple<P> between;
  P distance_sq;
};

/// The closest points of segments with these edge vectors; `w` is from the start of a to that of b.
template <typename P>
LIMBER_KERNEL ClosestOnSegments<P> closest_on_segments(const Triple<P>& edge_a, const Triple<P>& edge_b,
                                                       const Triple<P>& w) {
  const Triple<P> n = cross(edge_a, edge_b);
  const P along = dot(edge_a, edge_b);
  const P start = clamped_quotient(dot(cross(w, edge_b), n), dot(n, n));
  const P t = clamped_quotient(start * along - dot(edge_b, w), dot(edge_b, edge_b));
  const P s = clamped_quotient(t * along + dot(edge_a, w), dot(edge_a, edge_a));
  const Triple<P> between = w + (edge_b * t - edge_a * s);
  return {s, t, between, dot(between, between)};
}

LIMBER_KERNEL Quad sum_of_sizes(const Triple<Quad>& a, const Triple<Quad>& b, const Triple<Quad>& c) {
  return (abs(a.x) + abs(b.x) + abs(c.x)) + (abs(a.y) + abs(b.y) + abs(c.y)) + (abs(a.z) + abs(b.z) + abs(c.z));
}

// In vectors of four: on some processors those of 512 bits slow down what comes after them.
LIMBER_KERNEL void compare_segments(const SegmentPairs& pairs, ClosestOfSegments& found) {
  found.are_ordinary = 0;
  for (std::uint32_t i = 0; i < SegmentPairs::room; i += Quad::lanes) {
    const auto load = [&](const Vec3* points) {
      Triple<Quad> p;
      load_points(&points[i].x, p.x, p.y, p.z);
      return p;
    };
    const Triple<Quad> origin = load(pairs.start_a);
    const Triple<Quad> edge_a = load(pairs.end_a) - origin, w = load(pairs.start_b) - origin;
    const Triple<Quad> end_b = load(pairs.end_b) - origin;
    const ClosestOnSegments<Quad> closest = closest_on_segments(edge_a, end_b - w, w);
    closest.s.store(found.s + i), closest.t.store(found.t + i);
    sqrt(closest.distance_sq).store(found.distance + i);
    const Quad size = sum_of_sizes(edge_a, w, end_b);
    found.are_ordinary |=
        bits((size > Quad::set(base::smallest_unscaled_size)) & (size < Quad::set(base::largest_unscaled_size)) &
             (closest.distance_sq > Quad::set(base::tiny_square)))
        << i;
  }
}

// Kernels::compare_triangles.

using Quad3 = Triple<Quad>;

LIMBER_KERNEL Quad3 broadcast(const Vec3& v) { return {Quad::set(v.x), Quad::set(v.y), Quad::set(v.z)}; }

/// The corners of a triangle, [axis][corner]: the first two again after the last, so that edges can be loaded.
struct CornersInTurn {
  double v[3][5];

  LIMBER_KERNEL explicit CornersInTurn(const Triangle& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 5; ++k) v[axis][k] = t[k % 3][axis];
    }
  }
  LIMBER_KERNEL Quad3 from(std::uint32_t k) const {
    return {Quad::load(v[0] + k), Quad::load(v[1] + k), Quad::load(v[2] + k)};
  }
};

/// The corners, of those given by turns, whose foot is inside of a face, as a bit mask.
LIMBER_KERNEL unsigned find_feet(const FaceVectors& face, const CornersInTurn& corners) {
  const Quad zero = Quad::set(0);
  unsigned found = 0;
  for (std::uint32_t k = 0; k < 3; k += Quad::lanes) {
    const Quad3 p = corners.from(k);
    const Quad w2 = dot(broadcast(face.inward[0]), p - broadcast(face.corner.v0));
    const Quad w0 = dot(broadcast(face.inward[1]), p - broadcast(face.corner.v1));
    const Quad w1 = dot(broadcast(face.inward[2]), p - broadcast(face.corner.v2));
    const Quad sum = w0 + w1 + w2;
    found |= bits((w0 >= zero) & (w1 >= zero) & (w2 >= zero) & (sum > zero)) << k;
  }
  return found & 7;
}

LIMBER_KERNEL void compare_triangles(const FaceVectors& a, const FaceVectors& b, TriangleFeatures& found) {
  const CornersInTurn corners_a(a.corner), corners_b(b.corner);
  found.feet_of_a = find_feet(b, corners_a);
  found.feet_of_b = find_feet(a, corners_b);
  found.distance_sq = std::numeric_limits<double>::infinity();
  found.edge_a = found.edge_b = 0;
  found.at_a = found.at_b = 0;
  for (std::uint32_t j = 0; j < 3; j += Quad::lanes) {
    const Quad3 start_b = corners_b.from(j), edge_b = corners_b.from(j + 1) - start_b;
    Quad least_sq = Quad::set(std::numeric_limits<double>::infinity());
    Quad at_a = Quad::set(0), at_b = at_a, of_a = at_a;
    for (std::size_t i = 0; i < 3; ++i) {
      const Quad3 edge_a = broadcast(a.edge[i]), w = start_b - broadcast(a.corner[i]);
      const ClosestOnSegments<Quad> closest = closest_on_segments(edge_a, edge_b, w);
      const QuadMask is_better = least_sq > closest.distance_sq;
      least_sq = select(is_better, closest.distance_sq, least_sq);
      at_a = select(is_better, closest.s, at_a), at_b = select(is_better, closest.t, at_b);
      of_a = select(is_better, Quad::set(static_cast<double>(i)), of_a);
    }
    double least[Quad::lanes], s[Quad::lanes], t[Quad::lanes], edge[Quad::lanes];
    least_sq.store(least), at_a.store(s), at_b.store(t), of_a.store(edge);
    for (std::uint32_t lane = 0; lane < Quad::lanes && j + lane < 3; ++lane) {
      const auto edge_a = static_cast<std::uint32_t>(edge[lane]), edge_b_index = j + lane;
      // Of equally close pairs the first, edges of a being counted first.
      const bool is_first = 3 * edge_a + edge_b_index < 3 * found.edge_a + found.edge_b;
      if (least[lane] < found.distance_sq || (least[lane] == found.distance_sq && is_first)) {
        found.distance_sq = least[lane], found.at_a = s[lane], found.at_b = t[lane];
        found.edge_a = edge_a, found.edge_b = edge_b_index;
      }
    }
  }
}

// Triangles in lanes: as many as a Quad has numbers, each triangle in a lane of its own.

LIMBER_KERNEL Quad number(double x) { return Quad::set(x); }
LIMBER_KERNEL Quad length_sq(const Quad3& v) { return dot(v, v); }
LIMBER_KERNEL Quad3 abs3(const Quad3& v) { return {abs(v.x), abs(v.y), abs(v.z)}; }

/// A triangle of each pair.
struct TriangleLanes {
  Quad3 corner[3];

  LIMBER_KERNEL static TriangleLanes load(const Vec3 (&corners)[3][TrianglePairs::room], std::uint32_t i) {
    TriangleLanes t;
    for (std::size_t k = 0; k < 3; ++k) load_points(&corners[k][i].x, t.corner[k].x, t.corner[k].y, t.corner[k].z);
    return t;
  }
  LIMBER_KERNEL TriangleLanes from(const Quad3& origin) const {
    return {{corner[0] - origin, corner[1] - origin, corner[2] - origin}};
  }
};
LIMBER_KERNEL TriangleLanes select(QuadMask which, const TriangleLanes& a, const TriangleLanes& b) {
  return {{select(which, a.corner[0], b.corner[0]), select(which, a.corner[1], b.corner[1]),
           select(which, a.corner[2], b.corner[2])}};
}

/// The largest coordinate of two triangles.
LIMBER_KERNEL Quad largest_coordinate(const TriangleLanes& a, const TriangleLanes& b) {
  Quad largest = max(largest_abs(a.corner[0]), largest_abs(b.corner[0]));
  for (std::size_t k = 1; k < 3; ++k) largest = max(largest, max(largest_abs(a.corner[k]), largest_abs(b.corner[k])));
  return largest;
}
/// Whether powers of an extent up to the 16th neither overflow nor vanish.
LIMBER_KERNEL QuadMask is_ordinary(Quad extent) { return (extent > number(0x1p-60)) & (extent < number(0x1p60)); }

LIMBER_KERNEL void store(const Quad3& v, Vec3* to) {
  double x[Quad::lanes], y[Quad::lanes], z[Quad::lanes];
  v.x.store(x), v.y.store(y), v.z.store(z);
  for (std::uint32_t lane = 0; lane < Quad::lanes; ++lane) to[lane] = {x[lane], y[lane], z[lane]};
}

// Kernels::refine_candidates: better lower bounds for the candidates that find_candidates() has left.
//
// The closest points of two triangles that are apart are on two edges, or at a corner and in a face. In the second case
// the gap along the face's normal is the distance, and find_candidates() has tried both normals. For the first case all
// nine pairs of edges are compared here, and the line between the closest edges is one more direction for a gap.

// Replaces smaller divisors: squared lengths of edges, and of the parallelogram that two edges span.
inline constexpr float smallest_square = 0x1p-60F;

/// The edge of each triangle from corner `k` to the next.
LIMBER_KERNEL Packet3 edge(const Packet3 (&corner)[3], int k) { return corner[k == 2 ? 0 : k + 1] - corner[k]; }

/// The vector between the closest points of the edges of two triangles, from b to a. Rounding may make it a vector
/// between other points of the edges.
LIMBER_KERNEL Packet3 between_edges(const Packet3 (&a)[3], const Packet3 (&b)[3]) {
  const Packet one = Packet::set(1), least = Packet::set(smallest_square);
  const auto clamped = [&](Packet x) { return min(max(x, zero()), one); };
  Packet3 edge_b[3];
  Packet bb[3], per_bb[3];
  for (int j = 0; j < 3; ++j) {
    edge_b[j] = edge(b, j);
    bb[j] = dot(edge_b[j], edge_b[j]);
    per_bb[j] = one / max(bb[j], least);
  }
  Packet3 shortest{zero(), zero(), zero()};
  Packet shortest_sq = Packet::set(infinite);
  for (int i = 0; i < 3; ++i) {
    const Packet3 edge_a = edge(a, i);
    const Packet aa = dot(edge_a, edge_a), per_aa = one / max(aa, least);
    for (int j = 0; j < 3; ++j) {
      // The closest points are a[i] + s edge_a and b[j] + t edge_b. Those of the whole lines have s = `on_line`. Then t
      // is clamped to its edge, and s is found anew from t.
      const Packet3 apart = a[i] - b[j];
      const Packet ab = dot(edge_a, edge_b[j]), along_a = dot(edge_a, apart), along_b = dot(edge_b[j], apart);
      const Packet on_line = clamped((ab * along_b - along_a * bb[j]) / max(aa * bb[j] - ab * ab, least));
      const Packet t = clamped((ab * on_line + along_b) * per_bb[j]);
      const Packet s = clamped((ab * t - along_a) * per_aa);
      const Packet3 between = apart + edge_a * s - edge_b[j] * t;
      const Packet between_sq = dot(between, between);
      shortest = select(between_sq < shortest_sq, between, shortest);
      shortest_sq = min(between_sq, shortest_sq);
    }
  }
  return shortest;
}

LIMBER_KERNEL void refine_candidates(Candidates& candidates) {
  PairList pairs;
  for (; pairs.count < candidates.count; ++pairs.count) {
    const Candidate& c = candidates.pairs[pairs.count];
    pairs.pair[pairs.count] = static_cast<std::uint8_t>(c.slot_a * width + c.slot_b);
  }
  pairs.fill_last_packet();
  const LeafCorners &ca = candidates.corners_a, &cb = candidates.corners_b;
  for (std::uint32_t i = 0; i < pairs.count; i += Packet::lanes) {
    const Slots in_a = Slots::first_of(pairs.pair + i), in_b = Slots::second_of(pairs.pair + i);
    const Packet3 a[3] = {corners(ca, 0, in_a), corners(ca, 1, in_a), corners(ca, 2, in_a)};
    const Packet3 b[3] = {corners(cb, 0, in_b), corners(cb, 1, in_b), corners(cb, 2, in_b)};
    const Packet3 v = between_edges(a, b);
    // From a corner of a, so that the numbers are small.
    const Packet gap_v_sq = interval_gap_sq(interval(zero(), dot(v, a[1] - a[0]), dot(v, a[2] - a[0])),
                                            interval(dot(v, b[0] - a[0]), dot(v, b[1] - a[0]), dot(v, b[2] - a[0])));
    alignas(64) float bound_sq[Packet::lanes];
    (gap_v_sq / max(dot(v, v), Packet::set(smallest_direction_sq))).store(bound_sq);
    for (unsigned lanes = pairs.lanes_at(i); lanes != 0; lanes &= lanes - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(lanes));
      Candidate& candidate = candidates.pairs[i + lane];
      candidate.bound_sq = std::max(candidate.bound_sq, bound_sq[lane]);
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

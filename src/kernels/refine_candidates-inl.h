// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::refine_candidates: better lower bounds for the candidates that find_candidates() has left.
//
// The closest points of two triangles that are apart are on two edges, or at a corner and in a face. In the second case
// the gap along the face's normal is the distance, and find_candidates() has tried both normals. For the first case all
// nine pairs of edges are compared here, and the line between the closest edges is one more direction for a gap.

#if defined(LIMBER_SIMD_REFINE_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_REFINE_CANDIDATES_INL_H
#undef LIMBER_SIMD_REFINE_CANDIDATES_INL_H
#else
#define LIMBER_SIMD_REFINE_CANDIDATES_INL_H
#endif

#include <algorithm>
#include <bit>

#include "kernels/find_candidates-inl.h"
#include "kernels/pair_list-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

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

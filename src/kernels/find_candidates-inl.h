// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_candidates: the pairs of triangles of two leaves that may be closer than the prune distance.
//
// Triangles are quantized corners, so gaps are off by an error. A pair is pruned if its gap along some direction is at
// least the prune distance plus that error. In this order:
//
// 1. project_leaves() brings both leaves to one frame and scale, and finds the error.
// 2. All pairs at once are compared along the search direction, if there is one.
// 3. Then by the boxes of their triangles, and across two edges, the longest ones of the first pair that is left. For
//    two leaves of one tree by the largest gap of the boxes alone, which is cheaper; and remove_separated_neighbors()
//    removes neighbors that certainly meet nowhere else than in what they share.
// 4. The pairs that are left, one in each lane, are compared along the line of centroids and both triangles' normals.
//
// Other cross products of edges are left to the float64 routines. A mask of pairs has bit width * i + k for slot i of a
// and slot k of b.
//
// With `wants_pruned_bound` each step also finds a lower bound of the gaps of the pairs that it prunes:
//   excess                 step 2: how much more than the prune distance the gaps are. Errors are subtracted already.
//   pruned_sq              steps 3 and 4: squared gaps. Errors are subtracted at the end of find_candidates_of().
//   bound_sq               the same of pairs that are kept, which whoever compares it makes less by Candidates::error.

#if defined(LIMBER_SIMD_FIND_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CANDIDATES_INL_H
#undef LIMBER_SIMD_FIND_CANDIDATES_INL_H
#else
#define LIMBER_SIMD_FIND_CANDIDATES_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "kernels/project-inl.h"
#include "kernels/separated_neighbors-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Squared length of the shortest direction that may prune, where the pair is scaled so that its size is about 1. A
// length of 0 would prune everything, as 0 >= 0. From this length on nothing underflows: limits are at least 2^-17
// (leaf_pair_error), so squared gaps that prune are above 2^-34 * 1e-20 = 6e-31, and float32 is normal from 1.2e-38 on.
inline constexpr float smallest_direction_sq = 1e-20F;
inline constexpr float infinite = std::numeric_limits<float>::infinity();

/// The interval that three numbers, one for each corner, span.
struct Interval {
  Packet low, high;
};
LIMBER_KERNEL Interval interval(Packet x, Packet y, Packet z) { return {min(min(x, y), z), max(max(x, y), z)}; }

/// The squared gap of two intervals. If these are projections on a vector w, it is (gap of the triangles * |w|)^2.
LIMBER_KERNEL Packet interval_gap_sq(const Interval& a, const Interval& b) {
  const Packet gap = max(max(b.low - a.high, a.low - b.high), zero());
  return gap * gap;
}

/// Whether the gap along a direction of squared length w_sq prunes a pair; `gap_w_sq` is (gap * |w|)^2.
LIMBER_KERNEL Mask is_pruned(Packet gap_w_sq, Packet w_sq, Packet limit_sq) {
  return (gap_w_sq >= limit_sq * w_sq) & (w_sq >= Packet::set(smallest_direction_sq));
}

/// Compares a pair of triangles in each lane, along the line of centroids and both normals. Returns the `wanted` lanes
/// that are not pruned. `bound_sq` becomes the squared lower bound of each returned lane; with `wants_pruned_bound` of
/// pruned lanes too. Other lanes mean nothing.
template <bool wants_pruned_bound>
LIMBER_KERNEL unsigned compare_pairs(const Packet3 (&a)[3], const Packet3 (&b)[3], Packet limit_sq, unsigned wanted,
                                     Packet& bound_sq) {
  const Packet smallest_sq = Packet::set(smallest_direction_sq);
  // Three times the vector between the centroids: best where the triangles are small next to their distance.
  const Packet3 line = (b[0] + b[1] + b[2]) - (a[0] + a[1] + a[2]);
  const Packet line_sq = dot(line, line);
  const Packet line_gap_sq = interval_gap_sq(interval(dot(line, a[0]), dot(line, a[1]), dot(line, a[2])),
                                             interval(dot(line, b[0]), dot(line, b[1]), dot(line, b[2])));
  const Mask pruned_by_line_mask = is_pruned(line_gap_sq, line_sq, limit_sq);
  if constexpr (wants_pruned_bound) bound_sq = line_gap_sq / max(line_sq, smallest_sq);
  unsigned kept = wanted & ~bits(pruned_by_line_mask);
  // A lane that the line prunes keeps this bound, below too: results must not depend on the number of lanes.
  if (kept == 0) return 0;
  // Along the normals, from a corner of a so that the numbers are small.
  const Packet3 e1 = a[1] - a[0], e2 = a[2] - a[0], to_b[3] = {b[0] - a[0], b[1] - a[0], b[2] - a[0]};
  const auto gap_along_sq = [&](const Packet3& n) {
    return interval_gap_sq(interval(zero(), dot(n, e1), dot(n, e2)),
                           interval(dot(n, to_b[0]), dot(n, to_b[1]), dot(n, to_b[2])));
  };
  const Packet3 normal_a = cross(e1, e2), normal_b = cross(b[1] - b[0], b[2] - b[0]);
  const Packet a_sq = dot(normal_a, normal_a), a_gap_sq = gap_along_sq(normal_a);
  const Packet b_sq = dot(normal_b, normal_b), b_gap_sq = gap_along_sq(normal_b);
  kept &= ~(bits(is_pruned(a_gap_sq, a_sq, limit_sq)) | bits(is_pruned(b_gap_sq, b_sq, limit_sq)));
  const Packet best_sq = max(max(line_gap_sq / max(line_sq, smallest_sq), a_gap_sq / max(a_sq, smallest_sq)),
                             b_gap_sq / max(b_sq, smallest_sq));
  bound_sq = wants_pruned_bound ? select(pruned_by_line_mask, bound_sq, best_sq) : best_sq;
  return kept;
}

LIMBER_KERNEL float smallest_lane(Packet p) {
  alignas(64) float x[Packet::lanes];
  p.store(x);
  return *std::min_element(x, x + Packet::lanes);
}

/// The pairs that the search direction does not prune.
///
/// The support of a triangle is how far it extends along the direction towards the other leaf. So the gap of a pair is
/// the distance of the leaves' centers along the direction, less both supports. That is at least the prune distance and
/// all errors where the sum of the supports is at most ProjectedLeaves::pruned_support. With `wants_pruned_bound`,
/// `excess` becomes a lower bound of how much the gap of each pruned pair exceeds the prune distance.
template <bool wants_pruned_bound>
LIMBER_KERNEL std::uint64_t kept_along_direction(const bvh::QuantizedTriangles& a, const bvh::QuantizedTriangles& b,
                                                 const ProjectedLeaves& pair, const PruneLimits& pruning,
                                                 float& excess) {
  alignas(64) float support_a[width];
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    (farthest_corners(a, i, broadcast(pruning.direction32)) * Packet::set(pair.step_a)).store(support_a + i);
  }
  std::uint64_t wanted = 0;
  const Packet pruned_support = Packet::set(pair.pruned_support);
  const Packet most = Packet::set(base::max_units);  // what kept pairs count as: no gap is larger
  Packet least = most;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet support_b = farthest_corners(b, i, broadcast(pruning.other_direction32)) * Packet::set(pair.step_b);
    for (std::uint32_t row = 0; row < width; ++row) {
      const Packet support = Packet::set(support_a[row]) + support_b;
      const Mask wanted_mask = support > pruned_support;
      wanted |= std::uint64_t{bits(wanted_mask)} << (width * row + i);
      if constexpr (wants_pruned_bound) least = min(least, select(wanted_mask, most, pruned_support - support));
    }
  }
  if constexpr (wants_pruned_bound) excess = smallest_lane(least);
  return wanted;
}

/// The bounding boxes of the triangles of a leaf.
struct alignas(64) Boxes {
  float low[3][width], high[3][width];
};

LIMBER_KERNEL void find_boxes(const LeafCorners& c, Boxes& boxes) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 p = corners(c, 0, i), q = corners(c, 1, i), r = corners(c, 2, i);
    store3(min3(min3(p, q), r), boxes.low, i);
    store3(max3(max3(p, q), r), boxes.high, i);
  }
}

/// The vector of one slot, in every lane.
template <std::size_t slots>
LIMBER_KERNEL Packet3 repeated(const float (&v)[3][slots], std::uint32_t slot) {
  return {Packet::set(v[0][slot]), Packet::set(v[1][slot]), Packet::set(v[2][slot])};
}

/// The pairs that keeps() accepts. It is called with the gaps of the bounding boxes of some pairs, one in each lane,
/// along the three axes, negative where they overlap, and returns a mask.
template <typename Keeps>
LIMBER_KERNEL std::uint64_t kept_by_gaps(const LeafCorners& a, const LeafCorners& b, const Keeps& keeps) {
  Boxes boxes_a, boxes_b;
  find_boxes(a, boxes_a);
  find_boxes(b, boxes_b);
  std::uint64_t wanted = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    const Packet3 low = repeated(boxes_a.low, row), high = repeated(boxes_a.high, row);
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet3 above = load3(boxes_b.low, i) - high, below = low - load3(boxes_b.high, i);
      const Mask wanted_mask = keeps(max3(above, below));
      wanted |= std::uint64_t{bits(wanted_mask)} << (width * row + i);
    }
  }
  return wanted;
}

/// The pairs whose bounding boxes are closer than the limit. With `wants_pruned_bound`, lowers `pruned_sq` to the
/// squared distance of the boxes of each other pair.
template <bool wants_pruned_bound>
LIMBER_KERNEL std::uint64_t kept_by_boxes(const LeafCorners& a, const LeafCorners& b, Packet limit_sq,
                                          float& pruned_sq) {
  const Packet most = Packet::set(infinite);
  Packet least = most;
  const std::uint64_t wanted = kept_by_gaps(a, b, [&](const Packet3& gaps) {
    const Packet distance_sq = length_of_gaps_sq(gaps);
    const Mask wanted_mask = distance_sq < limit_sq;
    if constexpr (wants_pruned_bound) least = min(least, select(wanted_mask, most, distance_sq));
    return wanted_mask;
  });
  if constexpr (wants_pruned_bound) pruned_sq = std::min(pruned_sq, smallest_lane(least));
  return wanted;
}

/// The pairs whose bounding boxes are closer than `limit` along every axis. This takes less time than kept_by_boxes()
/// and prunes fewer pairs; hardly fewer where the limit is small next to the triangles, as it is for contacts.
LIMBER_KERNEL std::uint64_t kept_along_axes(const LeafCorners& a, const LeafCorners& b, Packet limit) {
  return kept_by_gaps(a, b, [&](const Packet3& gaps) { return max(max(gaps.x, gaps.y), gaps.z) < limit; });
}

/// The longest edge of the triangle in a slot.
LIMBER_KERNEL void find_longest_edge(const LeafCorners& c, std::uint32_t slot, float (&longest)[3]) {
  float greatest_sq = 0;
  longest[0] = longest[1] = longest[2] = 0;
  for (int k = 0; k < 3; ++k) {
    float edge[3];
    for (int j = 0; j < 3; ++j) edge[j] = c.v[3 * ((k + 1) % 3) + j][slot] - c.v[3 * k + j][slot];
    const float length_sq = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
    if (length_sq > greatest_sq) {
      greatest_sq = length_sq;
      std::copy(edge, edge + 3, longest);
    }
  }
}

/// The intervals that the triangles of a leaf span along a direction.
struct alignas(64) Spans {
  float low[width], high[width];
};
LIMBER_KERNEL void find_spans(const LeafCorners& c, const Packet3& along, Spans& spans) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Interval span =
        interval(dot(along, corners(c, 0, i)), dot(along, corners(c, 1, i)), dot(along, corners(c, 2, i)));
    span.low.store(spans.low + i);
    span.high.store(spans.high + i);
  }
}

/// The `wanted` pairs that are not pruned along the cross product of two edges, the longest of the first wanted pair.
/// Tubes of long thin triangles that pass each other are apart in this direction. With `wants_pruned_bound`, lowers
/// `pruned_sq` to the squared gap of each pair pruned here. Pre: a pair is wanted.
template <bool wants_pruned_bound>
LIMBER_KERNEL std::uint64_t kept_across_edges(const LeafCorners& a, const LeafCorners& b, float limit,
                                              std::uint64_t wanted, float& pruned_sq) {
  const auto first = static_cast<std::uint32_t>(std::countr_zero(wanted));
  float e[3], f[3];
  find_longest_edge(a, first / width, e);
  find_longest_edge(b, first % width, f);
  const float across[4] = {e[1] * f[2] - e[2] * f[1], e[2] * f[0] - e[0] * f[2], e[0] * f[1] - e[1] * f[0], 0};
  const float length_sq = across[0] * across[0] + across[1] * across[1] + across[2] * across[2];
  if (!(length_sq >= smallest_direction_sq)) return wanted;
  const float length = std::sqrt(length_sq);
  Spans spans_a, spans_b;
  find_spans(a, broadcast(across), spans_a);
  find_spans(b, broadcast(across), spans_b);
  const Packet limit_length = Packet::set(limit * length * base::squares_up);
  alignas(64) float gaps[width * width];
  std::uint64_t pruned = 0;
  for (std::uint32_t row = 0; row < width; ++row) {
    const Packet low = Packet::set(spans_a.low[row]), high = Packet::set(spans_a.high[row]);
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet gap = max(Packet::load(spans_b.low + i) - high, low - Packet::load(spans_b.high + i));
      if constexpr (wants_pruned_bound) gap.store(gaps + width * row + i);
      pruned |= std::uint64_t{bits(gap >= limit_length)} << (width * row + i);
    }
  }
  pruned &= wanted;
  for (std::uint64_t rest = wants_pruned_bound ? pruned : 0; rest != 0; rest &= rest - 1) {
    const float gap = gaps[std::countr_zero(rest)] / length;
    pruned_sq = std::min(pruned_sq, gap * gap);
  }
  return wanted & ~pruned;
}

/// The corners of a leaf relative to its center.
LIMBER_KERNEL void unpack(const bvh::QuantizedTriangles& leaf, float step, LeafCorners& c) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (int k = 0; k < 9; ++k) (Packet::from_int16(leaf.corner[k] + i) * Packet::set(step)).store(c.v[k] + i);
  }
}
/// The corners of a leaf in the frame of the other leaf, relative to that one's center.
LIMBER_KERNEL void unpack(const bvh::QuantizedTriangles& leaf, float step, const FrameTransform& transform,
                          const float* offset, LeafCorners& c) {
  const Packet3 x = broadcast(transform.rotation[0]), y = broadcast(transform.rotation[1]),
                z = broadcast(transform.rotation[2]);
  const Packet3 shift = broadcast(offset);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (int k = 0; k < 3; ++k) {
      const Packet3 p = corners(leaf, k, i) * Packet::set(step);
      (x.x * p.x + y.x * p.y + z.x * p.z + shift.x).store(c.v[3 * k] + i);
      (x.y * p.x + y.y * p.y + z.y * p.z + shift.y).store(c.v[3 * k + 1] + i);
      (x.z * p.x + y.z * p.y + z.z * p.z + shift.z).store(c.v[3 * k + 2] + i);
    }
  }
}

/// The corners of a leaf moved by `offset`.
LIMBER_KERNEL void shift_corners(const LeafCorners& from, const float* offset, LeafCorners& to) {
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    for (int k = 0; k < 9; ++k) (Packet::load(from.v[k] + i) + Packet::set(offset[k % 3])).store(to.v[k] + i);
  }
}

/// The two axes of the coordinate plane in which the triangles of a slot look largest: without the axis that is nearest
/// to the slab's normal.
LIMBER_KERNEL void find_wide_axes(const bvh::ChildBounds& bounds, std::uint32_t slot, int (&axes)[2]) {
  const float x = std::abs(bounds.normal_x[slot]), y = std::abs(bounds.normal_y[slot]);
  const float z = std::abs(bounds.normal_z[slot]);
  const int dropped = z >= std::max(x, y) ? 2 : y >= x ? 1 : 0;
  axes[0] = dropped == 0 ? 1 : 0, axes[1] = dropped == 2 ? 1 : 2;
}

/// find_candidates(), with `is_self` for two leaves of one tree; `self` is used only then.
template <bool wants_pruned_bound, bool is_self>
LIMBER_KERNEL void find_candidates_of(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                      const PruneLimits& pruning, const SelfPair* self, Candidates& candidates) {
  const ProjectedLeaves pair = project_leaves<is_self>(a, b, transform, pruning);
  candidates.count = 0, candidates.error = pair.error, candidates.scale = pair.scale;
  candidates.pruned_bound = infinite;
  std::uint64_t wanted = is_self && self->is_one_leaf() ? bvh::each_pair_once : ~std::uint64_t{0};
  // Triangles that fill up a leaf are left out.
  if (a.triangle_count < width) wanted &= (std::uint64_t{1} << (width * a.triangle_count)) - 1;
  if (b.triangle_count < width) wanted &= ((std::uint64_t{1} << b.triangle_count) - 1) * in_each_byte;
  if (pruning.has_direction) {
    float excess = 0;
    wanted &= kept_along_direction<wants_pruned_bound>(*a.triangles, *b.triangles, pair, pruning, excess);
    // The factor covers the sum's rounding.
    if constexpr (wants_pruned_bound) candidates.pruned_bound = (pair.prune_distance + excess) * base::squares_down;
    if (wanted == 0) return;
  }
  LeafCorners &ca = candidates.corners_a, &cb = candidates.corners_b;
  LeafCorners own_b;  // relative to the center of b, for remove_separated_neighbors(): no offset is rounded
  unpack(*a.triangles, pair.step_a, ca);
  if (is_self) {
    unpack(*b.triangles, pair.step_b, own_b);
    shift_corners(own_b, pair.offset, cb);
  } else {
    unpack(*b.triangles, pair.step_b, transform, pair.offset, cb);
  }

  const float limit = pair.prune_distance + pair.error;
  const Packet limit_sq = Packet::set(limit * limit * base::squares_up);
  float pruned_sq = infinite;
  // Above the size of both leaves boxes prune next to nothing: they are skipped, and so is kept_across_edges().
  if (limit < (pair.step_a + pair.step_b) * bvh::max_quantized) {
    wanted &= is_self ? kept_along_axes(ca, cb, Packet::set(limit * base::squares_up))
                      : kept_by_boxes<wants_pruned_bound>(ca, cb, limit_sq, pruned_sq);
    if (!is_self && wanted != 0) wanted = kept_across_edges<wants_pruned_bound>(ca, cb, limit, wanted, pruned_sq);
  }
  PairList pairs;
  pairs.add(wanted);
  if (is_self) {
    // How far a vertex may be from its stored place, beside quantization: one model's error is its slack alone, as
    // nothing is placed.
    const float away = base::float_up(transform.error * pair.scale);
    // Those of leaf a are good for both, as neighbors mostly have similar normals.
    int axes[2];
    find_wide_axes(a.node->bounds, a.slot, axes);
    remove_separated_neighbors(SelfLeaf(self->a, ca, pair.step_a, away), SelfLeaf(self->b, own_b, pair.step_b, away),
                               axes, pairs);
  }
  pairs.fill_last_packet();
  for (std::uint32_t i = 0; i < pairs.count; i += Packet::lanes) {
    const unsigned lanes = pairs.lanes_at(i);
    const Slots in_a = Slots::first_of(pairs.pair + i), in_b = Slots::second_of(pairs.pair + i);
    const Packet3 corners_a[3] = {corners(ca, 0, in_a), corners(ca, 1, in_a), corners(ca, 2, in_a)};
    const Packet3 corners_b[3] = {corners(cb, 0, in_b), corners(cb, 1, in_b), corners(cb, 2, in_b)};
    Packet bound_sq = zero();
    unsigned kept = compare_pairs<wants_pruned_bound>(corners_a, corners_b, limit_sq, lanes, bound_sq);
    alignas(64) float bounds[Packet::lanes];
    bound_sq.store(bounds);
    for (unsigned pruned = wants_pruned_bound ? lanes & ~kept : 0; pruned != 0; pruned &= pruned - 1) {
      pruned_sq = std::min(pruned_sq, bounds[std::countr_zero(pruned)]);
    }
    for (; kept != 0; kept &= kept - 1) {
      const auto lane = static_cast<std::uint32_t>(std::countr_zero(kept));
      const std::uint8_t slots = pairs.pair[i + lane];
      candidates.pairs[candidates.count++] = {bounds[lane], static_cast<std::uint8_t>(slots / width),
                                              static_cast<std::uint8_t>(slots % width)};
    }
  }
  if constexpr (wants_pruned_bound) {
    candidates.pruned_bound = std::min(candidates.pruned_bound, std::sqrt(pruned_sq * base::squares_down) - pair.error);
  }
}

LIMBER_KERNEL void find_candidates(const SlotRef& a, const SlotRef& b, const FrameTransform& transform,
                                   const PruneLimits& pruning, const SelfPair* self, bool wants_pruned_bound,
                                   Candidates& candidates) {
  if (self != nullptr) {
    LIMBER_ASSERT(!wants_pruned_bound);
    find_candidates_of<false, true>(a, b, transform, pruning, self, candidates);
  } else if (wants_pruned_bound) {
    find_candidates_of<true, false>(a, b, transform, pruning, self, candidates);
  } else {
    find_candidates_of<false, false>(a, b, transform, pruning, self, candidates);
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

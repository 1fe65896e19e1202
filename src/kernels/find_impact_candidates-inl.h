// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_impact_candidates.

#if defined(LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#undef LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#else
#define LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/close_elements-inl.h"
#include "kernels/project-inl.h"
#include "layout/moving_node.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The corners of a leaf relative to a point: those of the start times one factor, and those of the end times another.
LIMBER_KERNEL void combine(const bvh::MovingLeaf& leaf, double of_start, double of_end, const float* offset,
                           LeafCorners& corners) {
  const Packet from_start = Packet::set(static_cast<float>(of_start)),
               from_end = Packet::set(static_cast<float>(of_end));
  for (int k = 0; k < 9; ++k) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet start = Packet::load(leaf.corner[0][k] + i), end = Packet::load(leaf.corner[1][k] + i);
      (start * from_start + end * from_end + Packet::set(offset[k % 3])).store(corners.v[k] + i);
    }
  }
}

/// At any pace a direction has to keep elements apart in all combinations of starts and ends. All is relative to the
/// center of a at the start.
LIMBER_KERNEL void find_at_any_pace(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b, double separation,
                                    OwnedElements owned_by_a, OwnedElements owned_by_b, const SelfPair* self,
                                    ElementCandidates& found) {
  double offset[4][3], size = 0;  // of starts and ends, those of a first
  for (int k = 0; k < 12; ++k) {
    offset[k / 3][k % 3] = (k < 6 ? a : b).center[k / 3 % 2][k % 3] - a.center[0][k % 3];
    size = std::max(size, std::abs(offset[k / 3][k % 3]));
  }
  const double scale = scale_to_one(
      std::clamp(size + std::max(a.unit[0], a.unit[1]) + std::max(b.unit[0], b.unit[1]), 0x1p-900, 0x1p900));
  LeafCorners c[4];
  for (int k = 0; k < 4; ++k) {
    const bvh::MovingLeaf& leaf = k < 2 ? a : b;
    float shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = static_cast<float>(offset[k][axis] * scale);
    combine(leaf, k % 2 == 0 ? scale * leaf.unit[0] : 0, k % 2 == 0 ? 0 : scale * leaf.unit[1], shift, c[k]);
  }
  const LeafCorners ca[4] = {c[0], c[1], c[0], c[1]}, cb[4] = {c[2], c[3], c[3], c[2]};
  const float limit = base::float_up(std::min(separation * scale, base::max_units)) + base::leaf_pair_error;
  find_elements(ca, cb, limit, owned_by_a, owned_by_b, self, found);
}

LIMBER_KERNEL void find_impact_candidates(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b,
                                          const MotionLimits& limits, OwnedElements owned_by_a,
                                          OwnedElements owned_by_b, const SelfPair* self, ElementCandidates& found) {
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  if (limits.at_any_pace) return find_at_any_pace(a, b, limits.separation, owned_by_a, owned_by_b, self, found);
  // From the center of a to that of b, and the size of the pair, at the first and at the last time that matters.
  // Centers are exact, so all rounding is in proportion to that size, or below 2^-26 of it.
  const double times[2] = {limits.begin, limits.end};
  const auto at = [](double time, double start, double end) { return (1 - time) * start + time * end; };
  double offset[2][3], size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double start = b.center[0][axis] - a.center[0][axis], end = b.center[1][axis] - a.center[1][axis];
    for (int i = 0; i < 2; ++i) {
      offset[i][axis] = at(times[i], start, end);
      size = std::max({size, std::abs(offset[i][axis]), 0x1p-24 * std::abs(start), 0x1p-24 * std::abs(end)});
    }
  }
  const auto extent = [&](const bvh::MovingLeaf& leaf) {
    return std::max(at(times[0], leaf.unit[0], leaf.unit[1]), at(times[1], leaf.unit[0], leaf.unit[1]));
  };
  size += extent(a) + extent(b);
  const double scale = scale_to_one(std::clamp(size, 0x1p-900, 0x1p900));  // all numbers are about 1 or less
  constexpr float none[3] = {0, 0, 0};
  LeafCorners ca[2], cb[2];
  for (int i = 0; i < 2; ++i) {
    const double of_start = (1 - times[i]) * scale, of_end = times[i] * scale;
    float shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = static_cast<float>(offset[i][axis] * scale);
    combine(a, of_start * a.unit[0], of_end * a.unit[1], none, ca[i]);
    combine(b, of_start * b.unit[0], of_end * b.unit[1], shift, cb[i]);
  }
  const float limit = base::float_up(std::min(limits.separation * scale, base::max_units)) + base::leaf_pair_error;
  find_elements(ca, cb, limit, owned_by_a, owned_by_b, self, found);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

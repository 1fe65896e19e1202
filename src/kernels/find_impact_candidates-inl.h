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
#include "bvh/moving_node.h"
#include "kernels/close_elements-inl.h"
#include "kernels/project-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The corners of a leaf at a time, relative to a point, in another unit. `scale` is the leaf's unit in that one.
LIMBER_KERNEL void interpolate(const bvh::MovingLeaf& leaf, float time, float scale, const float* offset,
                               LeafCorners& corners) {
  const Packet from_start = Packet::set((1 - time) * scale), from_end = Packet::set(time * scale);
  for (int k = 0; k < 9; ++k) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet start = Packet::load(leaf.corner[0][k] + i), end = Packet::load(leaf.corner[1][k] + i);
      (start * from_start + end * from_end + Packet::set(offset[k % 3])).store(corners.v[k] + i);
    }
  }
}

LIMBER_KERNEL void find_impact_candidates(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b,
                                          const MotionLimits& limits, OwnedElements owned_by_a,
                                          OwnedElements owned_by_b, const SelfPair* self, ElementCandidates& found) {
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  // From the center of a to that of b, and the size of the pair, at the start and at the last time that matters.
  // Centers are exact, so all rounding is in proportion to that size.
  const double last = limits.max_time;
  double offset[2][3], size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    offset[0][axis] = b.center[0][axis] - a.center[0][axis];
    offset[1][axis] = (1 - last) * offset[0][axis] + last * (b.center[1][axis] - a.center[1][axis]);
    size = std::max({size, std::abs(offset[0][axis]), std::abs(offset[1][axis])});
  }
  const auto extent = [&](const bvh::MovingLeaf& leaf) {
    const auto start = static_cast<double>(leaf.extent[0]), end = static_cast<double>(leaf.extent[1]);
    return leaf.unit * std::max(start, (1 - last) * start + last * end);
  };
  size += extent(a) + extent(b);
  const double scale = scale_to_one(std::clamp(size, 0x1p-900, 0x1p900));  // all numbers are about 1 or less
  const auto scale_a = static_cast<float>(a.unit * scale), scale_b = static_cast<float>(b.unit * scale);
  constexpr float none[3] = {0, 0, 0};
  const float times[2] = {0, static_cast<float>(limits.max_time)};
  LeafCorners ca[2], cb[2];
  for (int time = 0; time < 2; ++time) {
    float shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = static_cast<float>(offset[time][axis] * scale);
    interpolate(a, times[time], scale_a, none, ca[time]);
    interpolate(b, times[time], scale_b, shift, cb[time]);
  }
  const float limit = base::float_up(std::min(limits.separation * scale, base::max_units)) + base::leaf_pair_error;
  find_elements(ca, cb, limit, owned_by_a, owned_by_b, self, found);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

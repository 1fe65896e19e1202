// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_meeting_children.

#if defined(LIMBER_SIMD_FIND_MEETING_CHILDREN_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_MEETING_CHILDREN_INL_H
#undef LIMBER_SIMD_FIND_MEETING_CHILDREN_INL_H
#else
#define LIMBER_SIMD_FIND_MEETING_CHILDREN_INL_H
#endif

#include <cstdint>

#include "base/error_bounds.h"
#include "bvh/moving_node.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// At most what x was before one operation has rounded it.
LIMBER_KERNEL Doubles rounded_down(Doubles x) { return x - abs(x) * Doubles::set(base::rounding_error); }

/// The intervals of some boxes along one axis, at both ends of the motion.
struct MovingInterval {
  Doubles low[bvh::motion_ends], high[bvh::motion_ends];
};

/// A lower bound of the time at which two boxes are within a separation along one axis; above 1 if they never are. Gaps
/// are linear in time, so it is where the gap that is there at the start closes. The quotient is not rounded down.
LIMBER_KERNEL Doubles meeting_time(const MovingInterval& a, const MovingInterval& b, Doubles separation) {
  Doubles above[bvh::motion_ends], below[bvh::motion_ends];
  for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
    above[end] = rounded_down(rounded_down(a.low[end] - b.high[end]) - separation);
    below[end] = rounded_down(rounded_down(b.low[end] - a.high[end]) - separation);
  }
  const DoublesMask is_above = above[0] > below[0];
  const Doubles start = max(above[0], below[0]), end = select(is_above, above[1], below[1]);
  const Doubles none = Doubles::set(0), never = Doubles::set(2);
  return select(start > none, select(end > none, never, start / (start - end)), none);
}

LIMBER_KERNEL unsigned find_meeting_children(const bvh::MovingNode& node, const bvh::MovingBox& other,
                                             double separation, double max_time, double* first_time) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Doubles::lanes) {
    Doubles time = Doubles::set(0);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      MovingInterval child, whole;
      for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
        child.low[end] = Doubles::load(node.low[end][axis] + i),
        child.high[end] = Doubles::load(node.high[end][axis] + i);
        whole.low[end] = Doubles::set(other.low[end][axis]), whole.high[end] = Doubles::set(other.high[end][axis]);
      }
      time = max(time, meeting_time(child, whole, Doubles::set(separation)));
    }
    // The quotient has been rounded twice, and is once more; what may have underflowed becomes 0.
    const Doubles down = time * Doubles::set(1 - 8 * base::rounding_error) - Doubles::set(base::tiny_time);
    const Doubles earliest = max(down, Doubles::set(0));
    found |= bits(earliest <= Doubles::set(max_time)) << i;
    earliest.store(first_time + i);
  }
  return found;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

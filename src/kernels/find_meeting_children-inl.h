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
#include "layout/moving_node.h"
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

/// From when until when two boxes are within a separation along one axis; from 2 on if they never are. Gaps are linear
/// in time, so they begin to be where the gap that is there at the start closes, and cease to be where the gap that is
/// there at the end opens. Quotients are rounded to the nearest number.
struct Meeting {
  Doubles first, last;
};
LIMBER_KERNEL Meeting meeting(const MovingInterval& a, const MovingInterval& b, Doubles separation) {
  Doubles above[bvh::motion_ends], below[bvh::motion_ends];
  for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
    above[end] = rounded_down(rounded_down(a.low[end] - b.high[end]) - separation);
    below[end] = rounded_down(rounded_down(b.low[end] - a.high[end]) - separation);
  }
  const Doubles none = Doubles::set(0), never = Doubles::set(2);
  // Of the gap that is open at a time, its sizes then and at the other end.
  const Doubles start = max(above[0], below[0]), start_later = select(above[0] > below[0], above[1], below[1]);
  const Doubles end = max(above[1], below[1]), end_earlier = select(above[1] > below[1], above[0], below[0]);
  return {select(start > none, select(start_later > none, never, start / (start - start_later)), none),
          select(end > none, end_earlier / (end_earlier - end), never)};
}

LIMBER_KERNEL unsigned find_meeting_children(const bvh::MovingNode& node, const bvh::MovingBox& other,
                                             const MotionLimits& limits, MeetingTimes& times) {
  const Doubles separation = Doubles::set(limits.separation), tiny = Doubles::set(base::tiny_time);
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Doubles::lanes) {
    Doubles first = Doubles::set(0), last = Doubles::set(2);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      MovingInterval child, whole;
      for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
        child.low[end] = Doubles::load(node.low[end][axis] + i),
        child.high[end] = Doubles::load(node.high[end][axis] + i);
        whole.low[end] = Doubles::set(other.low[end][axis]), whole.high[end] = Doubles::set(other.high[end][axis]);
      }
      const Meeting along = meeting(child, whole, separation);
      first = max(first, along.first), last = min(last, along.last);
    }
    // Quotients have been rounded twice, and are once more; what may have underflowed becomes 0, or is made larger.
    first = max(first * Doubles::set(1 - 8 * base::rounding_error) - tiny, Doubles::set(limits.begin));
    last = min(last * Doubles::set(1 + 8 * base::rounding_error) + tiny, Doubles::set(limits.end));
    found |= bits(first <= last) << i;
    first.store(times.first + i), last.store(times.last + i);
  }
  return found;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

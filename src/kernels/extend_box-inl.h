// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::extend_box.

#if defined(LIMBER_SIMD_EXTEND_BOX_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_EXTEND_BOX_INL_H
#undef LIMBER_SIMD_EXTEND_BOX_INL_H
#else
#define LIMBER_SIMD_EXTEND_BOX_INL_H
#endif

#include <algorithm>
#include <cstddef>

#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

LIMBER_KERNEL void extend_box(const float* points, std::size_t count, PointBox& box) {
  std::size_t i = 0;
  if (count >= Packet::lanes) {
    Packet3 low = load_points3(points), high = low;
    for (i = Packet::lanes; i + Packet::lanes <= count; i += Packet::lanes) {
      const Packet3 some = load_points3(points + 4 * i);
      low = min3(low, some), high = max3(high, some);
    }
    box.low[0] = std::min(box.low[0], -largest(zero() - low.x)), box.high[0] = std::max(box.high[0], largest(high.x));
    box.low[1] = std::min(box.low[1], -largest(zero() - low.y)), box.high[1] = std::max(box.high[1], largest(high.y));
    box.low[2] = std::min(box.low[2], -largest(zero() - low.z)), box.high[2] = std::max(box.high[2], largest(high.z));
  }
  for (; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], points[4 * i + axis]);
      box.high[axis] = std::max(box.high[axis], points[4 * i + axis]);
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::overlapping_boxes, Kernels::overlapping_pairs.

#if defined(LIMBER_SIMD_OVERLAPPING_BOXES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_OVERLAPPING_BOXES_INL_H
#undef LIMBER_SIMD_OVERLAPPING_BOXES_INL_H
#else
#define LIMBER_SIMD_OVERLAPPING_BOXES_INL_H
#endif

#include <bit>

#include "layout/boxes.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// A box, each number of it in all SIMD lanes.
struct WideBox {
  Triple<Doubles> low, high;

  LIMBER_KERNEL WideBox(const Vec3& from, const Vec3& to)
      : low{Doubles::set(from.x), Doubles::set(from.y), Doubles::set(from.z)},
        high{Doubles::set(to.x), Doubles::set(to.y), Doubles::set(to.z)} {}
};

LIMBER_KERNEL unsigned overlapping(const bvh::BoxNode& boxes, const WideBox& box) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Doubles::lanes) {
    const auto along = [&](std::size_t axis, Doubles low, Doubles high) {
      return (Doubles::load(boxes.low[axis] + i) <= high) & (low <= Doubles::load(boxes.high[axis] + i));
    };
    const DoublesMask along_x = along(0, box.low.x, box.high.x), along_y = along(1, box.low.y, box.high.y);
    found |= bits(along_x & along_y & along(2, box.low.z, box.high.z)) << i;
  }
  return found;
}

LIMBER_KERNEL unsigned overlapping_boxes(const bvh::BoxNode& boxes, const Vec3& low, const Vec3& high) {
  return overlapping(boxes, WideBox(low, high));
}

LIMBER_KERNEL std::uint64_t overlapping_pairs(const bvh::BoxNode& a, const bvh::BoxNode& b, const Box& around_b,
                                              double margin) {
  const Vec3 by{margin, margin, margin};
  std::uint64_t found = 0;
  for (unsigned slots = overlapping(a, WideBox(around_b.low - by, around_b.high + by)); slots != 0;
       slots &= slots - 1) {
    const int k = std::countr_zero(slots);
    const Vec3 low{a.low[0][k], a.low[1][k], a.low[2][k]}, high{a.high[0][k], a.high[1][k], a.high[2][k]};
    found |= std::uint64_t{overlapping(b, WideBox(low - by, high + by))} << (k * 8);
  }
  return found;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

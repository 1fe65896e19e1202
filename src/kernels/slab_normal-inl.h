// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The normal of a slab: the mean normal of what it bounds.

#if defined(LIMBER_SIMD_SLAB_NORMAL_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_SLAB_NORMAL_INL_H
#undef LIMBER_SIMD_SLAB_NORMAL_INL_H
#else
#define LIMBER_SIMD_SLAB_NORMAL_INL_H
#endif

#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Areas below this have lost too many digits.
inline constexpr float smallest_area = 0x1p-120F, smallest_float = 0x1p-126F;

/// A unit vector along `area`, or the direction in which the box is thinnest if the area is 0.
LIMBER_KERNEL Packet3 slab_normal(const Packet3& area, const Packet3& half) {
  const Packet zeros = zero(), ones = Packet::set(1);
  const Packet size = largest_abs(area);
  const Packet3 scaled = area * (ones / max(size, Packet::set(smallest_float)));
  const Packet3 normal = scaled * (ones / max(sqrt(dot(scaled, scaled)), Packet::set(0.5F)));
  const Mask x_is_thinner = half.x <= half.y;
  const Mask z_is_thinnest = half.z < min(half.x, half.y);
  Packet3 thinnest{select(x_is_thinner, ones, zeros), select(x_is_thinner, zeros, ones), zeros};
  thinnest = select(z_is_thinnest, Packet3{zeros, zeros, ones}, thinnest);
  return select(size > Packet::set(smallest_area), normal, thinnest);
}

/// The sum of vectors, each of them or its opposite, whichever is on the side of the sum of those before it.
LIMBER_KERNEL void sum_aligned(const float (&v)[3][width], float (&sum)[3]) {
  sum[0] = sum[1] = sum[2] = 0;
  for (std::uint32_t k = 0; k < width; ++k) {
    const float side = sum[0] * v[0][k] + sum[1] * v[1][k] + sum[2] * v[2][k];
    for (int axis = 0; axis < 3; ++axis) sum[axis] += side < 0 ? -v[axis][k] : v[axis][k];
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

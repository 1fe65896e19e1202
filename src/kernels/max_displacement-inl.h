// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::max_displacement.

#if defined(LIMBER_SIMD_MAX_DISPLACEMENT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_MAX_DISPLACEMENT_INL_H
#undef LIMBER_SIMD_MAX_DISPLACEMENT_INL_H
#else
#define LIMBER_SIMD_MAX_DISPLACEMENT_INL_H
#endif

#include <algorithm>
#include <cmath>

#include "limber/math.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

LIMBER_KERNEL Displacement max_displacement(const Vec3* from, const Vec3* to, std::size_t count, double most) {
  const Doubles limit = Doubles::set(most);
  Doubles farthest_sq = Doubles::set(0);
  DoublesMask is_bounded = limit <= limit;
  std::size_t i = 0;
  for (; i + Doubles::lanes <= count; i += Doubles::lanes) {
    Triple<Doubles> p, q;
    load_points(&to[i].x, p.x, p.y, p.z);
    load_points(&from[i].x, q.x, q.y, q.z);
    is_bounded = is_bounded & (abs(p.x) <= limit) & (abs(p.y) <= limit) & (abs(p.z) <= limit);
    const Triple<Doubles> d = p - q;
    farthest_sq = max(farthest_sq, dot(d, d));
  }
  if (!all_of(is_bounded)) return {0, false};
  double rest_sq = largest(farthest_sq);
  for (; i < count; ++i) {
    if (!(max_abs(to[i]) <= most) || !is_finite(to[i])) return {0, false};
    const Vec3 d = to[i] - from[i];
    rest_sq = std::max(rest_sq, d.x * d.x + d.y * d.y + d.z * d.z);
  }
  return {rest_sq, true};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the triangles of a leaf extend in a direction.

#if defined(LIMBER_SIMD_LEAF_SUPPORT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_LEAF_SUPPORT_INL_H
#undef LIMBER_SIMD_LEAF_SUPPORT_INL_H
#else
#define LIMBER_SIMD_LEAF_SUPPORT_INL_H
#endif

#include "layout/node.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Corner `k` of the triangles in the slots `i` and following, in quantization steps.
LIMBER_KERNEL Packet3 corners(const bvh::QuantizedTriangles& t, int k, std::uint32_t i) {
  return {Packet::from_int16(t.corner[3 * k] + i), Packet::from_int16(t.corner[3 * k + 1] + i),
          Packet::from_int16(t.corner[3 * k + 2] + i)};
}

/// The farthest of the corners of each triangle in direction n, in quantization steps.
LIMBER_KERNEL Packet farthest_corners(const bvh::QuantizedTriangles& leaf, std::uint32_t i, const Packet3& n) {
  return max(max(dot(n, corners(leaf, 0, i)), dot(n, corners(leaf, 1, i))), dot(n, corners(leaf, 2, i)));
}

/// The support of all triangles of a leaf along `normal`, in quantization steps.
LIMBER_KERNEL float leaf_support(const bvh::QuantizedTriangles& leaf, const float* normal) {
  const Packet3 n = broadcast(normal);
  Packet farthest = farthest_corners(leaf, 0, n);
  for (std::uint32_t i = Packet::lanes; i < width; i += Packet::lanes) {
    farthest = max(farthest, farthest_corners(leaf, i, n));
  }
  return largest(farthest);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// How far the triangles of a leaf extend in a direction.

#if defined(LIMBER_SIMD_LEAF_SUPPORT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_LEAF_SUPPORT_INL_H
#undef LIMBER_SIMD_LEAF_SUPPORT_INL_H
#else
#define LIMBER_SIMD_LEAF_SUPPORT_INL_H
#endif

#include "bvh/node.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The farthest of the corners of each triangle in direction n, in quantization steps.
LIMBER_KERNEL Packet farthest_corners(const bvh::QuantizedTriangles& leaf, std::uint32_t i, const Packet3& n) {
  Packet farthest[3];
  for (int k = 0; k < 3; ++k) {
    farthest[k] =
        dot(n, Packet3{Packet::from_int16(leaf.corner[3 * k] + i), Packet::from_int16(leaf.corner[3 * k + 1] + i),
                       Packet::from_int16(leaf.corner[3 * k + 2] + i)});
  }
  return max(max(farthest[0], farthest[1]), farthest[2]);
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

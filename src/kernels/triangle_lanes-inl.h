// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles in lanes: as many as a Quad has numbers, each triangle in a lane of its own.

#if defined(LIMBER_SIMD_TRIANGLE_LANES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_TRIANGLE_LANES_INL_H
#undef LIMBER_SIMD_TRIANGLE_LANES_INL_H
#else
#define LIMBER_SIMD_TRIANGLE_LANES_INL_H
#endif

#include <cstddef>
#include <cstdint>

#include "kernels/compare_triangles-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

LIMBER_KERNEL Quad number(double x) { return Quad::set(x); }
LIMBER_KERNEL Quad length_sq(const Quad3& v) { return dot(v, v); }
LIMBER_KERNEL Quad3 abs3(const Quad3& v) { return {abs(v.x), abs(v.y), abs(v.z)}; }

/// A triangle of each pair.
struct TriangleLanes {
  Quad3 corner[3];

  LIMBER_KERNEL static TriangleLanes load(const Vec3 (&corners)[3][TrianglePairs::room], std::uint32_t i) {
    TriangleLanes t;
    for (std::size_t k = 0; k < 3; ++k) load_points(&corners[k][i].x, t.corner[k].x, t.corner[k].y, t.corner[k].z);
    return t;
  }
  LIMBER_KERNEL TriangleLanes from(const Quad3& origin) const {
    return {{corner[0] - origin, corner[1] - origin, corner[2] - origin}};
  }
};
LIMBER_KERNEL TriangleLanes select(QuadMask which, const TriangleLanes& a, const TriangleLanes& b) {
  return {{select(which, a.corner[0], b.corner[0]), select(which, a.corner[1], b.corner[1]),
           select(which, a.corner[2], b.corner[2])}};
}

/// The largest coordinate of two triangles.
LIMBER_KERNEL Quad largest_coordinate(const TriangleLanes& a, const TriangleLanes& b) {
  Quad largest = max(largest_abs(a.corner[0]), largest_abs(b.corner[0]));
  for (std::size_t k = 1; k < 3; ++k) largest = max(largest, max(largest_abs(a.corner[k]), largest_abs(b.corner[k])));
  return largest;
}
/// Whether powers of an extent up to the 16th neither overflow nor vanish.
LIMBER_KERNEL QuadMask is_ordinary(Quad extent) { return (extent > number(0x1p-60)) & (extent < number(0x1p60)); }

LIMBER_KERNEL void store(const Quad3& v, Vec3* to) {
  double x[Quad::lanes], y[Quad::lanes], z[Quad::lanes];
  v.x.store(x), v.y.store(y), v.z.store(z);
  for (std::uint32_t lane = 0; lane < Quad::lanes; ++lane) to[lane] = {x[lane], y[lane], z[lane]};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

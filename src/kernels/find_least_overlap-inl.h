// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_least_overlap: the axes in rows of four. A row has the cross products of an edge of a with the three
// edges of b, and a normal.

#if defined(LIMBER_SIMD_FIND_LEAST_OVERLAP_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_LEAST_OVERLAP_INL_H
#undef LIMBER_SIMD_FIND_LEAST_OVERLAP_INL_H
#else
#define LIMBER_SIMD_FIND_LEAST_OVERLAP_INL_H
#endif

#include <cstddef>
#include <cstdint>
#include <limits>

#include "kernels/compare_triangles-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// A vector perpendicular to both e and f; 0 if they are parallel. src/geometry/triangle_contact.cpp says how near.
LIMBER_KERNEL Quad3 perpendicular(const Quad3& e, const Quad3& f) {
  const Quad3 n = cross(e, f);
  const Quad n_sq = dot(n, n);
  const Quad3 across = n - e * (dot(n, e) / dot(e, e));
  const QuadMask is_small = (n_sq < Quad::set(0x1p-4)) & (n_sq > Quad::set(0));
  return {select(is_small, across.x, n.x), select(is_small, across.y, n.y), select(is_small, across.z, n.z)};
}

/// The least and the greatest height of a triangle's corners along an axis.
struct HeightRange {
  Quad low, high;
};
LIMBER_KERNEL HeightRange heights_along(const Quad3& axis, const Triangle& t) {
  const Quad p0 = dot(axis, broadcast(t.v0)), p1 = dot(axis, broadcast(t.v1)), p2 = dot(axis, broadcast(t.v2));
  return {min(min(p0, p1), p2), max(max(p0, p1), p2)};
}

LIMBER_KERNEL void find_least_overlap(const TriangleAxes& a, const TriangleAxes& b, bool intersect,
                                      LeastOverlap& least) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr std::uint32_t row_size = 4, of_normal = 3;
  alignas(32) double edges_b[3][row_size] = {}, places[row_size], normals[3][3][row_size] = {};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t j = 0; j < 3; ++j) edges_b[axis][j] = b.edge[j][axis];
    normals[0][axis][of_normal] = a.normal[axis];
    normals[1][axis][of_normal] = normals[2][axis][of_normal] = b.normal[axis];
  }
  for (std::uint32_t j = 0; j < row_size; ++j) places[j] = j;
  least = {infinity, {}, false};
  double first = infinity;  // the place of the axis found, in the order of preference
  for (std::uint32_t j = 0; j < row_size; j += Quad::lanes) {
    const QuadMask is_normal = Quad::load(places + j) >= Quad::set(of_normal);
    const Quad3 f{Quad::load(edges_b[0] + j), Quad::load(edges_b[1] + j), Quad::load(edges_b[2] + j)};
    Quad least_overlap = Quad::set(infinity), place = least_overlap, sign = least_overlap;
    Quad3 best{least_overlap, least_overlap, least_overlap};
    for (std::size_t i = 0; i < 3; ++i) {
      const Quad3 n = perpendicular(broadcast(a.edge[i]), f);
      Quad3 axis{select(is_normal, Quad::load(normals[i][0] + j), n.x),
                 select(is_normal, Quad::load(normals[i][1] + j), n.y),
                 select(is_normal, Quad::load(normals[i][2] + j), n.z)};
      Quad axis_sq = dot(axis, axis);
      // Below an angle of 2^-30 a cross product has lost half of its digits.
      least.is_well_conditioned |= bits(axis_sq > Quad::set(0x1p-60)) != 0;
      const QuadMask is_long = axis_sq > Quad::set(0x1p-200);
      if (!all_of(is_long)) {  // squares of others could vanish
        axis = axis * select(is_long, Quad::set(1), Quad::set(0x1p600));
        axis_sq = dot(axis, axis);
      }
      const HeightRange of_a = heights_along(axis, a.corner), of_b = heights_along(axis, b.corner);
      const Quad ahead = of_a.high - of_b.low, back = of_b.high - of_a.low;
      Quad overlap = min(ahead, back);
      if (intersect) overlap = max(overlap, Quad::set(0));  // below 0 is rounding then
      overlap = overlap / sqrt(axis_sq);
      const QuadMask is_less = (axis_sq > Quad::set(0)) & (overlap < least_overlap);
      least_overlap = select(is_less, overlap, least_overlap);
      best = {select(is_less, axis.x, best.x), select(is_less, axis.y, best.y), select(is_less, axis.z, best.z)};
      sign = select(is_less, select(back < ahead, Quad::set(-1), Quad::set(1)), sign);
      place = select(is_less, Quad::set(static_cast<double>(row_size * i)), place);
    }
    double overlaps[Quad::lanes], x[Quad::lanes], y[Quad::lanes], z[Quad::lanes], signs[Quad::lanes];
    double rows[Quad::lanes];
    least_overlap.store(overlaps), place.store(rows), sign.store(signs);
    best.x.store(x), best.y.store(y), best.z.store(z);
    for (std::uint32_t lane = 0; lane < Quad::lanes; ++lane) {
      // Normals first, then edges of a, then edges of b.
      const double at = rows[lane] + (j + lane == of_normal ? -1.0 - row_size * 3 : j + lane);
      if (overlaps[lane] < least.overlap || (overlaps[lane] == least.overlap && at < first)) {
        first = at;
        least.overlap = overlaps[lane];
        least.axis = signs[lane] < 0 ? Vec3{-x[lane], -y[lane], -z[lane]} : Vec3{x[lane], y[lane], z[lane]};
      }
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::bound_children_along and Kernels::bound_triangles_along: for a point that is far from the model next to its
// size, so that float32 cannot tell the distances of its parts apart. Their heights along the direction to the point
// are as small as the model.

#if defined(LIMBER_SIMD_BOUND_FAR_POINT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_FAR_POINT_INL_H
#undef LIMBER_SIMD_BOUND_FAR_POINT_INL_H
#else
#define LIMBER_SIMD_BOUND_FAR_POINT_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/leaf_support-inl.h"
#include "kernels/order_children-inl.h"
#include "kernels/slab_sphere-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// How far a point, in lengths, is above the base along the point's direction.
LIMBER_KERNEL double height_of(const QueryPoint& point, const Vec3& p) {
  const double* const d = point.direction;
  return d[0] * (p.x - point.base[0]) + d[1] * (p.y - point.base[1]) + d[2] * (p.z - point.base[2]);
}

LIMBER_KERNEL void bound_children_along(const bvh::Node& node, const QueryPoint& point, float limit,
                                        ChildrenInOrder& children) {
  const bvh::ChildBounds& n = node.bounds;
  const auto height =
      static_cast<float>(std::clamp(height_of(point, node.origin) * point.per_unit, -base::max_units, base::max_units));
  const float error = (std::abs(height) + node.radius) * base::projection_error + point.error_units;
  const Packet at = Packet::set(height + error);
  const Packet everywhere = Packet::set(static_cast<float>(4 * base::max_units));
  const Packet3 up = broadcast(point.direction32);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet highest =
        at + dot(centers(n, i), up) + min(Packet::load(n.radius + i), box_support(half_sizes(n, i), up));
    // Infinite where the error is.
    infinite_unless_child(zero() - min(highest, everywhere), i, node.child_count).store(children.bound + i);
  }
  children.upper = std::numeric_limits<float>::infinity();
  order_children(limit, children);
}

LIMBER_KERNEL void bound_triangles_along(const bvh::Node& node, std::uint32_t slot,
                                         const bvh::QuantizedTriangles& triangles, const QueryPoint& point,
                                         double limit, TriangleIntervals& intervals) {
  const bvh::ChildBounds& n = node.bounds;
  intervals.step = static_cast<double>(n.radius[slot]) * point.unit / static_cast<double>(bvh::max_quantized);
  std::fill(intervals.lower, intervals.lower + width, 0.0F);
  intervals.upper = std::numeric_limits<float>::infinity();
  const Vec3 center = node.origin + point.unit * Vec3{n.center_x[slot], n.center_y[slot], n.center_z[slot]};
  // Triangles that do not reach this height over the leaf's center are farther away than the limit.
  const double needed = point.height - height_of(point, center) - limit - point.error;
  constexpr double most_steps = 0x1p60;
  const double error = base::quantization_error +
                       2 * static_cast<double>(bvh::max_quantized) * static_cast<double>(base::projection_error);
  const double steps = std::clamp(needed / intervals.step, -most_steps, most_steps) - error;
  const Packet least = Packet::set(base::float_down(steps));
  intervals.kept = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    intervals.kept |= bits(farthest_corners(triangles, i, broadcast(point.direction32)) >= least) << i;
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::find_crossed_children and Kernels::find_crossed_triangles.

#if defined(LIMBER_SIMD_FIND_CROSSED_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_CROSSED_INL_H
#undef LIMBER_SIMD_FIND_CROSSED_INL_H
#else
#define LIMBER_SIMD_FIND_CROSSED_INL_H
#endif

#include <cmath>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/slab_sphere-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

LIMBER_KERNEL unsigned find_crossed_children(const bvh::Node& node, const QueryRay& ray) {
  const unsigned used = (1U << node.child_count) - 1;
  const LocalPoint local(ray.origin, node.origin, {}, ray.per_unit);
  // Not less than: true also where the error is infinite.
  if (!(local.size + static_cast<double>(ray.error_units) < base::max_units)) return used;
  const Packet error = Packet::set(local.magnitude(node.radius) * base::projection_error + ray.error_units);
  const Packet3 at = broadcast(local.position);
  const Packet3 forward = broadcast(ray.forward), left = broadcast(ray.left), up = broadcast(ray.up);
  const bvh::ChildBounds& n = node.bounds;
  unsigned crossed = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 d = centers(n, i) - at, half = half_sizes(n, i);
    const Packet radius = Packet::load(n.radius + i);
    const auto support = [&](const Packet3& direction) { return min(radius, box_support(half, direction)) + error; };
    const Mask is_crossed = (zero() - dot(d, forward) <= support(forward)) & (abs(dot(d, left)) <= support(left)) &
                            (abs(dot(d, up)) <= support(up));
    crossed |= bits(is_crossed) << i;
  }
  return crossed & used;
}

LIMBER_KERNEL unsigned find_crossed_triangles(const bvh::Node& node, std::uint32_t slot,
                                              const bvh::QuantizedTriangles& triangles, const QueryRay& ray) {
  const bvh::ChildBounds& n = node.bounds;
  const double per_step = static_cast<double>(bvh::max_quantized) / (static_cast<double>(n.radius[slot]) * ray.unit);
  const Vec3 center = ray.unit * Vec3{n.center_x[slot], n.center_y[slot], n.center_z[slot]};
  const LocalPoint local(ray.origin, node.origin, center, per_step);
  const double error =
      ray.error * per_step + base::quantization_error +
      (local.size + static_cast<double>(bvh::max_quantized)) * static_cast<double>(base::projection_error);
  if (!(local.size + error < base::max_units)) return (1U << width) - 1;
  const Packet off = Packet::set(base::float_up(error));
  const Packet3 at = broadcast(local.position);
  const Packet3 forward = broadcast(ray.forward), left = broadcast(ray.left), up = broadcast(ray.up);
  unsigned crossed = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 corner[3] = {corners(triangles, 0, i) - at, corners(triangles, 1, i) - at,
                               corners(triangles, 2, i) - at};
    const auto high = [&](const Packet3& v) {
      return max(max(dot(corner[0], v), dot(corner[1], v)), dot(corner[2], v));
    };
    const auto low = [&](const Packet3& v) {
      return min(min(dot(corner[0], v), dot(corner[1], v)), dot(corner[2], v));
    };
    const Packet below = zero() - off;
    const Mask is_crossed =
        (high(forward) >= below) & (high(left) >= below) & (low(left) <= off) & (high(up) >= below) & (low(up) <= off);
    crossed |= bits(is_crossed) << i;
  }
  return crossed;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::merge_bounds.

#if defined(LIMBER_SIMD_MERGE_BOUNDS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_MERGE_BOUNDS_INL_H
#undef LIMBER_SIMD_MERGE_BOUNDS_INL_H
#else
#define LIMBER_SIMD_MERGE_BOUNDS_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error_bounds.h"
#include "kernels/slab_normal-inl.h"
#include "kernels/slab_sphere-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Against a division by 0.
inline constexpr float smallest_radius = 0x1p-100F;

// How often the error of a corner enters a height or a distance.
inline constexpr float errors_added = 4;

/// The interval of all numbers that have been added.
struct Span {
  Packet least, most;

  LIMBER_KERNEL void add(Packet low, Packet high) { least = min(least, low), most = max(most, high); }
  LIMBER_KERNEL float low() const { return -largest(zero() - least); }
  LIMBER_KERNEL float high() const { return largest(most); }
};

LIMBER_KERNEL Span empty_span() { return {Packet::set(far_off), Packet::set(-far_off)}; }

/// At least the distance from a point of anything in children whose centers are at `d` from it: by their spheres, or by
/// their slabs and the spheres across them.
LIMBER_KERNEL Packet farthest_of(const NodePairs& p, const Packet3& d, Packet low, Packet high) {
  const Packet distance_sq = dot(d, d), height = dot(p.normal, d);
  const Packet along = max(abs(height + low), abs(height + high));
  const Packet rounding = distance_sq * Packet::set(base::across_error);
  const Packet across = sqrt(max(distance_sq - height * height, zero()) + rounding) + p.radius;
  return min(sqrt(distance_sq) + p.radius, sqrt(along * along + across * across)) * Packet::set(base::squares_up);
}

/// The bound around the children of a node that has all of them.
LIMBER_KERNEL bvh::MergedBounds merge_all(const bvh::ChildBounds& n) {
  bvh::MergedBounds whole;
  Span box[3] = {empty_span(), empty_span(), empty_span()};
  alignas(64) float area[3][width];
  Packet largest_radius = zero();
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    largest_radius = max(largest_radius, Packet::load(n.radius + i));
  }
  // Relative to the largest, so that squares do not vanish.
  const Packet per_radius = Packet::set(1 / std::max(largest(largest_radius), smallest_radius));
  const float* const centers[3] = {n.center_x, n.center_y, n.center_z};
  const float* const halves[3] = {n.half_x, n.half_y, n.half_z};
  const float* const normals[3] = {n.normal_x, n.normal_y, n.normal_z};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet radius = Packet::load(n.radius + i) * per_radius, weight = radius * radius;
    for (int axis = 0; axis < 3; ++axis) {
      const Packet center = Packet::load(centers[axis] + i), half = Packet::load(halves[axis] + i);
      box[axis].add(center - half, center + half);
      (Packet::load(normals[axis] + i) * weight).store(area[axis] + i);
    }
  }
  float extent = 0;
  for (const Span& side : box) extent = std::max({extent, std::abs(side.low()), std::abs(side.high())});
  const float error = extent * base::corner_error + base::smallest_corner_error;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = box[axis].low(), high = box[axis].high();
    whole.center[axis] = 0.5F * low + 0.5F * high;
    whole.half[axis] = std::max(high - whole.center[axis], whole.center[axis] - low) + error;
  }
  float sum[3];
  sum_aligned(area, sum);
  const Packet3 normal = slab_normal(broadcast(sum), broadcast(whole.half));
  Span slab = empty_span(), sphere = empty_span();
  const Packet errors = Packet::set(errors_added * error), up = Packet::set(base::squares_up);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const ProjectedNode center{{whole.center[0], whole.center[1], whole.center[2]}, {}, {}, {}, 0, 0, 0};
    const NodePairs p = pair_up(n, i, center);
    const Packet3 d{zero() - p.d.x, zero() - p.d.y, zero() - p.d.z};
    const Packet cosine = dot(p.normal, normal), height = dot(normal, d);
    const Packet3 crossed = cross(p.normal, normal);
    const Packet sine = sqrt(dot(crossed, crossed)), cosine_abs = abs(cosine);
    const Packet of_box = box_support(p.half, normal);
    const Mask same_side = cosine > zero();
    const Packet above = support(p.radius, select(same_side, p.upper, p.lower), cosine_abs, sine);
    const Packet below = support(p.radius, select(same_side, p.lower, p.upper), cosine_abs, sine);
    slab.add(height - min(below, of_box) * up - errors, height + min(above, of_box) * up + errors);
    const Packet far = farthest_of(p, d, Packet::load(n.low + i), Packet::load(n.high + i)) + errors;
    sphere.add(far, far);
  }
  alignas(64) float stored[3][width];
  store3(normal, stored, 0);
  for (int axis = 0; axis < 3; ++axis) whole.normal[axis] = stored[axis][0];
  whole.low = slab.low(), whole.high = slab.high();
  const float* const half = whole.half;
  const float diagonal = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]) * base::squares_up;
  whole.radius = std::min(sphere.high(), diagonal);
  return whole;
}

LIMBER_KERNEL bvh::MergedBounds merge_bounds(const bvh::Node& node) {
  if (node.child_count == width) return merge_all(node.bounds);
  float rows[sizeof(bvh::ChildBounds) / sizeof(float) / width][width];
  std::memcpy(rows, &node.bounds, sizeof(rows));
  for (float(&row)[width] : rows) {
    for (std::uint32_t k = node.child_count; k < width; ++k)
      row[k] = row[node.child_count - 1];  // repeats the last child
  }
  bvh::ChildBounds repeated;
  std::memcpy(&repeated, rows, sizeof(rows));
  return merge_all(repeated);
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

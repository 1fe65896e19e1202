// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::bound_leaf: a lower bound of the distance between the triangles of a leaf and a volume of the other tree.
//
// The volume of a leaf of a few large triangles, as of a wall and a floor, contains much space that none of them is in.
// So each triangle is compared with the other volume on its own, by the gap along: the axes of either box, the normal
// of the slab, the normal of the triangle, and the line from the volume's center to the closest point of the triangle,
// approximately.

#if defined(LIMBER_SIMD_BOUND_LEAF_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_LEAF_INL_H
#undef LIMBER_SIMD_BOUND_LEAF_INL_H
#else
#define LIMBER_SIMD_BOUND_LEAF_INL_H
#endif

#include <cmath>

#include "base/error_bounds.h"
#include "kernels/closest_on_triangles-inl.h"
#include "kernels/leaf_support-inl.h"
#include "kernels/project-inl.h"
#include "kernels/slab_sphere-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// A volume about the origin, in every lane.
struct CenteredVolume {
  Packet3 axis[3];  // of its box
  Packet half[3];
  Packet3 normal;
  Packet radius;
  Cap upper, lower;
};

LIMBER_KERNEL CenteredVolume centered(const ProjectedNode& p, const FrameTransform& transform) {
  CenteredVolume v;
  for (int k = 0; k < 3; ++k) {
    v.axis[k] = broadcast(transform.rotation[k]);
    v.half[k] = Packet::set(p.own_half[k]);
  }
  v.normal = broadcast(p.normal);
  v.radius = Packet::set(p.radius);
  v.upper = cap(v.radius, Packet::set(p.high)), v.lower = cap(v.radius, Packet::set(-p.low));
  return v;
}

/// How far a volume extends along directions of length 1: as far as its box, or the sphere that its slab cuts.
LIMBER_KERNEL Packet support(const CenteredVolume& v, const Packet3& direction) {
  const Packet of_box = abs(dot(v.axis[0], direction)) * v.half[0] + abs(dot(v.axis[1], direction)) * v.half[1] +
                        abs(dot(v.axis[2], direction)) * v.half[2];
  const Packet cosine = dot(v.normal, direction);
  const Packet3 crossed = cross(v.normal, direction);
  const Packet of_sphere =
      support(v.radius, select(cosine > zero(), v.upper, v.lower), abs(cosine), sqrt(dot(crossed, crossed)));
  return min(of_box, of_sphere);
}

/// The least height of the corners of each triangle along a direction.
LIMBER_KERNEL Packet lowest_along(const PointTriangles& t, const Packet3& direction) {
  return dot(t.to_corner, direction) + min(min(dot(t.edge_b, direction), dot(t.edge_c, direction)), zero());
}

/// The gap between triangles and a volume that extends from -`low` to `high` along a direction of length 1.
LIMBER_KERNEL Packet gap_along(const PointTriangles& t, const Packet3& direction, Packet low, Packet high) {
  const Packet a = dot(t.to_corner, direction), b = dot(t.edge_b, direction), c = dot(t.edge_c, direction);
  return max(a + min(min(b, c), zero()) - high, zero() - a - max(max(b, c), zero()) - low);
}

/// A vector of length 1, or shorter for tiny vectors, as those of degenerate triangles: bounds only get lower.
LIMBER_KERNEL Packet3 unit_vector(const Packet3& v) {
  return v * (Packet::set(1) / max(sqrt(dot(v, v)), Packet::set(shortest_divisor)));
}

LIMBER_KERNEL float bound_leaf(const SlotRef& leaf, const SlotRef& other, const FrameTransform& transform) {
  alignas(32) double center[4];
  project_center(*other.node, other.slot, transform, leaf.node->origin, center);
  const ProjectedNode p = project_node(*leaf.node, other, transform, center);
  const CenteredVolume volume = centered(p, transform);
  const bvh::ChildBounds& n = leaf.node->bounds;
  const std::uint32_t k = leaf.slot;
  const float step = n.radius[k] * (1 / bvh::max_quantized);  // of quantized corners
  const float magnitude = std::abs(p.center[0]) + std::abs(p.center[1]) + std::abs(p.center[2]) + leaf.node->radius;
  const Packet error = Packet::set(step * static_cast<float>(base::quantization_error) +
                                   (magnitude + p.radius) * base::projection_error);
  const Packet3 shift{Packet::set(n.center_x[k] - p.center[0]), Packet::set(n.center_y[k] - p.center[1]),
                      Packet::set(n.center_z[k] - p.center[2])};
  const Packet3 half = broadcast(p.half);
  Packet least = Packet::set(far_off);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 a = corners(*leaf.triangles, 0, i) * Packet::set(step) + shift;
    const Packet3 b = corners(*leaf.triangles, 1, i) * Packet::set(step) + shift;
    const Packet3 c = corners(*leaf.triangles, 2, i) * Packet::set(step) + shift;
    const PointTriangles t{a, b - a, c - a};
    const Packet3 low = min3(min3(a, b), c), high = max3(max3(a, b), c);
    const Packet3 boxes{max(low.x, zero() - high.x) - half.x - error, max(low.y, zero() - high.y) - half.y - error,
                        max(low.z, zero() - high.z) - half.z - error};
    const auto own = [&](int axis) {
      return gap_along(t, volume.axis[axis], volume.half[axis], volume.half[axis]) - error;
    };
    const Packet best = max(length_of_gaps_sq(boxes), length_of_gaps_sq(Packet3{own(0), own(1), own(2)}));
    const Packet of_slab = gap_along(t, volume.normal, volume.lower.height, volume.upper.height);
    const Packet3 normal = unit_vector(cross(t.edge_b, t.edge_c)), towards = unit_vector(nearly_closest(t));
    const Packet3 opposite{zero() - normal.x, zero() - normal.y, zero() - normal.z};
    const Packet of_normal = gap_along(t, normal, support(volume, opposite), support(volume, normal));
    // One side suffices: the triangle has a point at a positive height along `towards`.
    const Packet of_point = lowest_along(t, towards) - support(volume, towards);
    const Packet gap = max(max(of_slab, of_normal), of_point) - error;
    least = min(least, max(best, gap_sq(gap, zero())));
  }
  return -largest(zero() - least) * base::squares_down;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

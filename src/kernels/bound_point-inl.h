// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels for a point or a ray, and a tree. The first functions line up children by their bounds, without a branch that
// nobody could predict.

#if defined(LIMBER_SIMD_BOUND_POINT_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_POINT_INL_H
#undef LIMBER_SIMD_BOUND_POINT_INL_H
#else
#define LIMBER_SIMD_BOUND_POINT_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/project-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Numbers from here to its double are whole, so their last bits count.
inline constexpr float counts_from = 0x1p23F;

/// The number of each child, and infinity for slots from `child_count` on. The slots are `i` and following.
LIMBER_KERNEL Packet infinite_unless_child(Packet x, std::uint32_t i, std::uint32_t child_count) {
  alignas(64) static constexpr float number[width] = {0, 1, 2, 3, 4, 5, 6, 7};
  const Mask is_child = Packet::load(number + i) < Packet::set(static_cast<float>(child_count));
  return select(is_child, x, Packet::set(std::numeric_limits<float>::infinity()));
}

/// Finds which children have a bound of at most `limit`, and their places. Pre: the limit is finite.
LIMBER_KERNEL void order_children(float limit, ChildrenInOrder& children) {
  alignas(64) float key[width];
  unsigned kept = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet bound = Packet::load(children.bound + i);
    const Mask is_kept = bound <= Packet::set(limit);
    kept |= bits(is_kept) << i;
    numbered(select(is_kept, bound, Packet::set(-far_off)), i).store(key + i);
  }
  children.kept = kept;
  const Packet one = Packet::set(1);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet own = Packet::load(key + i);
    Packet even = Packet::set(counts_from), odd = zero();
    for (std::uint32_t k = 0; k < width; k += 2) {
      even = even + select(Packet::set(key[k]) > own, one, zero());
      odd = odd + select(Packet::set(key[k + 1]) > own, one, zero());
    }
    (even + odd).store(children.place_in_bits + i);
  }
}

// Kernels::bound_children_to_point and Kernels::bound_triangles_to_point: bounds of the distances from a point to the
// volumes of children, and to the quantized triangles of a leaf. Far points come below.

// Replaces smaller divisors: radii of spheres that are points.
inline constexpr float smallest_child_radius = 0x1p-100F;

/// Packets have largest() only.
LIMBER_KERNEL float smallest(Packet x) { return -largest(zero() - x); }

/// Squared lower bounds of the distances from a point to the children `i` and following, a packet of them. Where a
/// bound is 0, the result is how deep the point is inside of the child's sphere, as a fraction of the radius, negative.
/// The point's `position` is relative to the origin of the node. `farthest` becomes the distances of the farthest
/// points of the spheres: every child has a triangle that is nearer.
LIMBER_KERNEL Packet bound_point(const bvh::ChildBounds& n, std::uint32_t i, const Packet3& position, Packet error,
                                 Packet& farthest) {
  const Packet3 d = position - centers(n, i), half = half_sizes(n, i), normal = normals(n, i);
  const Packet radius = Packet::load(n.radius + i);
  const Packet d_sq = dot(d, d), distance = sqrt(d_sq);
  const Packet sphere_gap = distance - radius;
  farthest = distance + radius;
  // The distances x, y, z of the box along the axes.
  const Packet x = max(abs(d.x) - half.x - error, zero());
  const Packet y = max(abs(d.y) - half.y - error, zero());
  const Packet z = max(abs(d.z) - half.z - error, zero());
  // The distance of the cylinder along the slab's normal that contains the sphere's part in the slab. d_sq - height^2
  // loses digits, so what rounding may have added is subtracted.
  const Packet height = dot(d, normal);
  const Packet slab_gap = max(height - Packet::load(n.high + i), Packet::load(n.low + i) - height) - error;
  const Packet rounding = d_sq * Packet::set(base::across_error);
  const Packet across = sqrt(max(d_sq - height * height - rounding, zero())) - radius - error;
  const Packet best = max(max(gap_sq(sphere_gap - error, zero()), x * x + y * y + z * z), gap_sq(slab_gap, across));
  // The depth is without errors, because it only decides in which order children come.
  const Packet depth = min(sphere_gap / max(radius, Packet::set(smallest_child_radius)), zero());
  return select(best > zero(), best * Packet::set(base::squares_down), depth);
}

LIMBER_KERNEL void bound_children_to_point(const bvh::Node& node, const QueryPoint& point, float limit,
                                           ChildrenInOrder& children) {
  const LocalPoint local(point.position, node.origin, {}, point.per_unit);
  // Written with ! so that infinite errors and NaN come here too.
  if (!(local.size + static_cast<double>(point.error_units) < base::max_units)) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      infinite_unless_child(zero(), i, node.child_count).store(children.bound + i);
    }
    children.upper = std::numeric_limits<float>::infinity();
    return order_children(limit, children);
  }
  const float error = local.magnitude(node.radius) * base::point_error + point.error_units;
  const Packet3 at = broadcast(local.position);
  Packet least = Packet::set(far_off);  // more than any distance in units
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Packet farthest = zero();
    const Packet bound = bound_point(node.bounds, i, at, Packet::set(error), farthest);
    infinite_unless_child(bound, i, node.child_count).store(children.bound + i);
    least = min(least, infinite_unless_child(farthest, i, node.child_count));
  }
  children.upper = (smallest(least) + error) * base::squares_up;  // the factor covers the rounding of the sum, too
  order_children(limit, children);
}

/// The triangles of the slots `i` and following, and a point, in quantization steps.
LIMBER_KERNEL PointTriangles point_triangles(const bvh::QuantizedTriangles& t, std::uint32_t i, const Packet3& point) {
  const Packet3 a = corners(t, 0, i);
  return {a - point, corners(t, 1, i) - a, corners(t, 2, i) - a};
}

LIMBER_KERNEL void bound_triangles_to_point(const bvh::Node& node, std::uint32_t slot,
                                            const bvh::QuantizedTriangles& triangles, const QueryPoint& point,
                                            double limit, TriangleIntervals& intervals) {
  const bvh::ChildBounds& n = node.bounds;
  intervals.step = static_cast<double>(n.radius[slot]) * point.unit / static_cast<double>(bvh::max_quantized);
  const double per_step = 1 / intervals.step;
  const Vec3 center = point.unit * Vec3{n.center_x[slot], n.center_y[slot], n.center_z[slot]};
  const LocalPoint local(point.position, node.origin, center, per_step);
  constexpr double most_steps = 0x1p40;  // there the error is 2^20 (point_error), and the leaf has 2^16 steps only
  constexpr double leaf_size = static_cast<double>(bvh::max_quantized) + 1;  // of a coordinate, with room for rounding
  const double error = point.error * per_step + base::quantization_error +
                       (local.size + leaf_size) * static_cast<double>(base::point_error);
  // Written with ! so that infinite errors and NaN come here too, as for a leaf without size.
  if (!(local.size + error < most_steps)) {
    std::fill(intervals.lower, intervals.lower + width, 0.0F);
    intervals.upper = std::numeric_limits<float>::infinity();
    intervals.kept = (1U << width) - 1;
    return;
  }
  const Packet3 at = broadcast(local.position);
  const float error32 = base::float_up(error);
  const Packet shortest = Packet::set(shortest_divisor);
  Packet least = Packet::set(std::numeric_limits<float>::infinity());
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const PointTriangles t = point_triangles(triangles, i, at);
    const Packet3 near = nearly_closest(t);
    const Packet near_length = sqrt(dot(near, near));
    const Packet3 normal = cross(t.edge_b, t.edge_c);
    const Packet normal_length = sqrt(dot(normal, normal));
    // A gap along any direction is a lower bound of the distance. The direction to the closest point is the best one,
    // so one that nearly leads there is nearly as good. The error covers rounding.
    const Packet towards = gap_times_length(t, near) / max(near_length, shortest);
    const Packet above = gap_times_length(t, normal) / max(normal_length, shortest);
    (max(towards, above) - Packet::set(error32)).store(intervals.lower + i);
    least = min(least, near_length);  // an upper bound, because `near` is on the triangle
  }
  intervals.upper = smallest(least) + error32;  // point_error has room for the rounding of the sum
  // The limit is made finite as a float. That prunes nothing more, because lower bounds are below most_steps.
  const double limit_in_steps = std::min(limit * per_step, base::max_units);
  const Packet farthest = Packet::set(std::min(intervals.upper, base::float_up(limit_in_steps)));
  intervals.kept = 0;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    intervals.kept |= bits(Packet::load(intervals.lower + i) <= farthest) << i;
  }
}

// Kernels::bound_children_along and Kernels::bound_triangles_along: for a point that is far from the model next to its
// size, so that float32 cannot tell the distances of its parts apart. Their heights along the direction to the point
// are as small as the model.

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

// Kernels::find_crossed_children and Kernels::find_crossed_triangles.

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

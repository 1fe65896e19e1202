// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::merge_bounds, and small kernels of boxes and points.

#if defined(LIMBER_SIMD_MERGE_BOUNDS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_MERGE_BOUNDS_INL_H
#undef LIMBER_SIMD_MERGE_BOUNDS_INL_H
#else
#define LIMBER_SIMD_MERGE_BOUNDS_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "kernels/fit_leaves-inl.h"
#include "kernels/project-inl.h"
#include "kernels/slab_sides-inl.h"
#include "layout/node.h"
#include "limber/math.h"
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

/// As farthest_of(), by the boxes along the slabs.
LIMBER_KERNEL Packet farthest_corner_of(const OrientedBoxes& boxes, const Packet3& d) {
  Packet squares = zero();
  for (int k = 0; k < 3; ++k) {
    const Packet along = abs(dot(boxes.axis[k], d) + boxes.middle[k]) + boxes.half[k];
    squares = squares + along * along;
  }
  return sqrt(squares) * Packet::set(1 + base::sides_error);
}

/// The turn of the axes of the children's second moment in a plane, in which they count as boxes along their slabs.
LIMBER_KERNEL Packet moment_turn(const bvh::Node& node, const Packet3& center, const Packet3& normal,
                                 Packet per_radius) {
  alignas(64) float difference[width], product[width];
  const PlaneAxes plane = plane_axes(normal);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const OrientedBoxes boxes = oriented_boxes(node, i);
    const Packet3 d = (centers(node.bounds, i) - center) * per_radius;
    const Packet x = dot(plane.first, d), y = dot(plane.second, d);
    Packet squares = x * x - y * y, mixed = x * y;
    for (int k = 0; k < 3; ++k) {
      const Packet half = boxes.half[k] * per_radius, weight = half * half * Packet::set(1.0F / 3);
      const Packet u = dot(plane.first, boxes.axis[k]), v = dot(plane.second, boxes.axis[k]);
      squares = squares + weight * (u * u - v * v), mixed = mixed + weight * (u * v);
    }
    squares.store(difference + i), (mixed + mixed).store(product + i);
  }
  float c = 0, s = 0;
  for (std::uint32_t k = 0; k < width; ++k) c += difference[k], s += product[k];
  const float length = std::sqrt(c * c + s * s);
  // Half of the angle; of the two ways to compute it the one in which nothing cancels.
  return c >= 0 ? turn_along(Packet::set(length + c), Packet::set(s))
                : turn_along(Packet::set(s), Packet::set(length - c));
}

/// The bound around the children of a node that has all of them.
template <bool with_sides>
LIMBER_KERNEL bvh::MergedBounds merge_all(const bvh::Node& node) {
  const bvh::ChildBounds& n = node.bounds;
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
  const Packet turn = with_sides ? moment_turn(node, broadcast(whole.center), normal, per_radius) : zero();
  const Packet3 first_side = in_plane(normal, turn), sides[2] = {first_side, cross(normal, first_side)};
  Span slab = empty_span(), sphere = empty_span(), side[2] = {empty_span(), empty_span()};
  const Packet errors = Packet::set(errors_added * error), up = Packet::set(base::squares_up);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const ProjectedNode center{{whole.center[0], whole.center[1], whole.center[2]}, {}, {}, {}, 0, 0, 0, 0};
    const NodePairs p = pair_up(n, i, center);
    const Packet3 d{zero() - p.d.x, zero() - p.d.y, zero() - p.d.z};
    const Packet cosine = dot(p.normal, normal), height = dot(normal, d);
    const Packet3 crossed = cross(p.normal, normal);
    const Packet sine = sqrt(dot(crossed, crossed)), cosine_abs = abs(cosine);
    const Packet of_box = box_support(p.half, normal);
    const Mask same_side = cosine > zero();
    Packet above = support(p.radius, select(same_side, p.upper, p.lower), cosine_abs, sine);
    Packet below = support(p.radius, select(same_side, p.lower, p.upper), cosine_abs, sine);
    Packet far = farthest_of(p, d, Packet::load(n.low + i), Packet::load(n.high + i));
    if (with_sides) {
      const OrientedBoxes boxes = oriented_boxes(node, i);
      const TwoSupports of_boxes = supports(boxes, normal);
      above = min(above, of_boxes.above), below = min(below, of_boxes.below);
      far = min(far, farthest_corner_of(boxes, d));
      for (int k = 0; k < 2; ++k) {
        const TwoSupports along = supports(boxes, sides[k]);
        const Packet most = min(box_support(p.half, sides[k]), p.radius), at = dot(sides[k], d);
        side[k].add(at - min(most, along.below) * up - errors, at + min(most, along.above) * up + errors);
      }
    }
    slab.add(height - min(below, of_box) * up - errors, height + min(above, of_box) * up + errors);
    far = far + errors;
    sphere.add(far, far);
  }
  alignas(64) float stored[3][width];
  store3(normal, stored, 0);
  for (int axis = 0; axis < 3; ++axis) whole.normal[axis] = stored[axis][0];
  whole.low = slab.low(), whole.high = slab.high();
  const float* const half = whole.half;
  const float diagonal = std::sqrt(half[0] * half[0] + half[1] * half[1] + half[2] * half[2]) * base::squares_up;
  whole.radius = std::min(sphere.high(), diagonal);
  if (with_sides) {
    set_sides(turn, {side[0].low(), side[1].low()}, {side[0].high(), side[1].high()}, whole);
  } else {
    set_no_sides(whole);
  }
  return whole;
}

LIMBER_KERNEL bvh::MergedBounds merge_all(const bvh::Node& node, bool sides) {
  return sides ? merge_all<true>(node) : merge_all<false>(node);
}

LIMBER_KERNEL bvh::MergedBounds merge_bounds(const bvh::Node& node, bool with_sides) {
  if (node.child_count == width) return merge_all(node, with_sides);
  // A copy, in which the slots that are not in use repeat the last child.
  bvh::Node repeated = node;
  float rows[sizeof(bvh::ChildBounds) / sizeof(float) / width][width];
  std::memcpy(rows, &node.bounds, sizeof(rows));
  for (float(&row)[width] : rows) {
    for (std::uint32_t k = node.child_count; k < width; ++k) row[k] = row[node.child_count - 1];
  }
  std::memcpy(&repeated.bounds, rows, sizeof(rows));
  std::int16_t sides[sizeof(bvh::SlabSides) / sizeof(std::int16_t) / width][width];
  std::memcpy(sides, &node.sides, sizeof(sides));
  for (std::int16_t(&row)[width] : sides) {
    for (std::uint32_t k = node.child_count; k < width; ++k) row[k] = row[node.child_count - 1];
  }
  std::memcpy(&repeated.sides, sides, sizeof(sides));
  return merge_all(repeated, with_sides);
}

// Kernels::extend_box.

LIMBER_KERNEL void extend_box(const float* points, std::size_t count, PointBox& box) {
  std::size_t i = 0;
  if (count >= Packet::lanes) {
    Packet3 low = load_points3(points), high = low;
    for (i = Packet::lanes; i + Packet::lanes <= count; i += Packet::lanes) {
      const Packet3 some = load_points3(points + 4 * i);
      low = min3(low, some), high = max3(high, some);
    }
    box.low[0] = std::min(box.low[0], -largest(zero() - low.x)), box.high[0] = std::max(box.high[0], largest(high.x));
    box.low[1] = std::min(box.low[1], -largest(zero() - low.y)), box.high[1] = std::max(box.high[1], largest(high.y));
    box.low[2] = std::min(box.low[2], -largest(zero() - low.z)), box.high[2] = std::max(box.high[2], largest(high.z));
  }
  for (; i < count; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], points[4 * i + axis]);
      box.high[axis] = std::max(box.high[axis], points[4 * i + axis]);
    }
  }
}

// Kernels::overlapping_boxes, Kernels::overlapping_pairs.

/// A box, each number of it in all SIMD lanes.
struct WideBox {
  Triple<Doubles> low, high;

  LIMBER_KERNEL WideBox(const Vec3& from, const Vec3& to)
      : low{Doubles::set(from.x), Doubles::set(from.y), Doubles::set(from.z)},
        high{Doubles::set(to.x), Doubles::set(to.y), Doubles::set(to.z)} {}
};

LIMBER_KERNEL unsigned overlapping(const bvh::BoxNode& boxes, const WideBox& box) {
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Doubles::lanes) {
    const auto along = [&](std::size_t axis, Doubles low, Doubles high) {
      return (Doubles::load(boxes.low[axis] + i) <= high) & (low <= Doubles::load(boxes.high[axis] + i));
    };
    const DoublesMask along_x = along(0, box.low.x, box.high.x), along_y = along(1, box.low.y, box.high.y);
    found |= bits(along_x & along_y & along(2, box.low.z, box.high.z)) << i;
  }
  return found;
}

LIMBER_KERNEL unsigned overlapping_boxes(const bvh::BoxNode& boxes, const Vec3& low, const Vec3& high) {
  return overlapping(boxes, WideBox(low, high));
}

LIMBER_KERNEL std::uint64_t overlapping_pairs(const bvh::BoxNode& a, const bvh::BoxNode& b, const Box& around_b,
                                              double margin) {
  const Vec3 by{margin, margin, margin};
  std::uint64_t found = 0;
  for (unsigned slots = overlapping(a, WideBox(around_b.low - by, around_b.high + by)); slots != 0;
       slots &= slots - 1) {
    const int k = std::countr_zero(slots);
    const Vec3 low{a.low[0][k], a.low[1][k], a.low[2][k]}, high{a.high[0][k], a.high[1][k], a.high[2][k]};
    found |= std::uint64_t{overlapping(b, WideBox(low - by, high + by))} << (k * 8);
  }
  return found;
}

// Kernels::least_of_few.

// Counts how many are less than each, without any branch on numbers. Of two packets at once, and of numbers with even
// and odd index apart: additions that need not wait for each other.
LIMBER_KERNEL FewLeast least_of_few(const float* points, std::size_t axis, std::size_t count, std::size_t n) {
  LIMBER_ASSERT(0 < n && n <= count && count <= few_points);
  constexpr std::size_t at_once = std::size_t{2} * Packet::lanes;
  static_assert(few_points == 64 && few_points % at_once == 0);
  alignas(32) float numbers[few_points];
  for (std::size_t i = 0; i < count; ++i) numbers[i] = points[4 * i + axis];
  const std::size_t end = (count + at_once - 1) / at_once * at_once;
  // Padding. Where most numbers are infinite it may be among the least, so it is left out below.
  for (std::size_t i = count; i < end; ++i) numbers[i] = std::numeric_limits<float>::infinity();
  const Packet one = Packet::set(1), wanted = Packet::set(static_cast<float>(n));
  alignas(32) float less[few_points];
  Packet most = zero();  // that are less than one of the least
  FewLeast found{0, 0};
  for (std::size_t i = 0; i < end; i += at_once) {
    const Packet x = Packet::load(numbers + i), y = Packet::load(numbers + i + Packet::lanes);
    Packet less_x = zero(), less_y = zero(), odd_x = zero(), odd_y = zero();
    for (std::size_t k = 0; k < end; k += 2) {
      const Packet even = Packet::set(numbers[k]), odd = Packet::set(numbers[k + 1]);
      less_x = less_x + select(even < x, one, zero()), less_y = less_y + select(even < y, one, zero());
      odd_x = odd_x + select(odd < x, one, zero()), odd_y = odd_y + select(odd < y, one, zero());
    }
    less_x = less_x + odd_x, less_y = less_y + odd_y;
    less_x.store(less + i), less_y.store(less + i + Packet::lanes);
    const Mask least_x = less_x < wanted, least_y = less_y < wanted;
    most = max(most, max(select(least_x, less_x, zero()), select(least_y, less_y, zero())));
    found.least |= std::uint64_t{bits(least_x)} << i | std::uint64_t{bits(least_y)} << (i + Packet::lanes);
  }
  const Packet of_greatest = Packet::set(largest(most));
  for (std::size_t i = 0; i < end; i += Packet::lanes) {
    found.greatest |= std::uint64_t{bits(Packet::load(less + i) >= of_greatest)} << i;
  }
  const std::uint64_t used = ~std::uint64_t{0} >> (few_points - count);
  found.least &= used;
  found.greatest &= found.least;
  return found;
}

LIMBER_KERNEL BoxRow join_rows(const BoxRow* rows, std::uint64_t which) {
  BoxRow joined;
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    Packet least = Packet::load(rows[std::countr_zero(which)].least + i);
    for (std::uint64_t rest = which & (which - 1); rest != 0; rest &= rest - 1) {
      least = min(least, Packet::load(rows[std::countr_zero(rest)].least + i));
    }
    least.store(joined.least + i);
  }
  return joined;
}

// Kernels::max_displacement.

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

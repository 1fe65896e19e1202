// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The directions in the plane of a slab, along which its content has intervals, too (bvh::SlabSides).

#if defined(LIMBER_SIMD_SLAB_SIDES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_SLAB_SIDES_INL_H
#undef LIMBER_SIMD_SLAB_SIDES_INL_H
#else
#define LIMBER_SIMD_SLAB_SIDES_INL_H
#endif

#include "base/error_bounds.h"
#include "layout/node.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

inline constexpr float smallest_float = 0x1p-126F;

/// Two directions of length 1 perpendicular to a normal and to each other [Duff2017].
struct PlaneAxes {
  Packet3 first, second;
};
LIMBER_KERNEL PlaneAxes plane_axes(const Packet3& n) {
  const Packet one = Packet::set(1), sign = flipped_as(one, n.z);
  const Packet a = (zero() - one) / (sign + n.z), b = n.x * n.y * a;
  return {{one + sign * (n.x * n.x * a), sign * b, zero() - sign * n.x}, {b, sign + n.y * n.y * a, zero() - n.y}};
}

/// The direction in the plane of a normal that a turn stands for.
LIMBER_KERNEL Packet3 in_plane(const Packet3& normal, Packet turn) {
  const PlaneAxes plane = plane_axes(normal);
  const Packet sine = turn * Packet::set(1 / bvh::max_quantized);
  return plane.first * sqrt(Packet::set(1) - sine * sine) + plane.second * sine;
}

/// Rounds numbers below 2^22 in size to whole ones, halves to even ones.
LIMBER_KERNEL Packet rounded(Packet x) {
  const Packet shift = Packet::set(0x1.8p23F);
  return (x + shift) - shift;
}

/// The turn by which one of the two directions is along (x, y), in the axes of the plane.
LIMBER_KERNEL Packet turn_along(Packet x, Packet y) {
  const Mask is_second = abs(x) < abs(y);
  const Packet along = select(is_second, y, x), across = select(is_second, zero() - x, y);
  const Packet length = sqrt(along * along + across * across);
  const Packet sine = flipped_as(across, along) / max(length, Packet::set(smallest_float));
  const Packet most = Packet::set(0.7072F);  // more only where squares underflow
  return rounded(max(min(sine, most), zero() - most) * Packet::set(bvh::max_quantized));
}
/// The turn by which one of the two directions is along `direction`, as seen in the plane of the normal.
LIMBER_KERNEL Packet turn_along(const Packet3& normal, const Packet3& direction) {
  const PlaneAxes plane = plane_axes(normal);
  return turn_along(dot(plane.first, direction), dot(plane.second, direction));
}

// The largest ratios at which content counts as elongated: of its width to its length, and of the volume of the box
// along the slab to that of the box along the axes. At 0.3 tubes gain less; at 0.5 other models lose 5 %. No answer
// depends on these numbers.
inline constexpr float most_width = 0.45F, most_volume = 0.4F;

/// Whether content is elongated: much longer than wide along its slab, and its box there much smaller than the box
/// along the axes. Both are told by half their sizes.
LIMBER_KERNEL Mask is_elongated(const Packet (&along_slab)[3], const Packet3& half) {
  const Packet wide = min(along_slab[1], along_slab[2]), is_long = max(along_slab[1], along_slab[2]);
  return (wide <= Packet::set(most_width) * is_long) &
         (along_slab[0] * wide * is_long <= Packet::set(most_volume) * (half.x * half.y * half.z));
}

/// Stores the intervals along two directions of volumes of these radii where `which` says so, elsewhere those of the
/// spheres.
LIMBER_KERNEL void store_sides(const Packet (&low)[2], const Packet (&high)[2], Packet radius, Mask which,
                               std::uint32_t i, bvh::SlabSides& sides) {
  const Packet per_step = Packet::set(bvh::max_side) / radius, most = Packet::set(bvh::max_quantized);
  const Packet outward = Packet::set(2), least = zero() - most;
  for (int k = 0; k < 2; ++k) {
    select(which, rounded(max(low[k] * per_step - outward, least)), least).store_int16(sides.low[k] + i);
    select(which, rounded(min(high[k] * per_step + outward, most)), most).store_int16(sides.high[k] + i);
  }
}

LIMBER_KERNEL void set_no_sides(bvh::MergedBounds& whole) {
  whole.turn = 0, whole.is_elongated = 0;
  for (int k = 0; k < 2; ++k) whole.side_low[k] = -far_off, whole.side_high[k] = far_off;
}
/// Gives a bound, which has all else, its intervals along two directions if they show that it is elongated.
LIMBER_KERNEL void set_sides(Packet turn, const float (&low)[2], const float (&high)[2], bvh::MergedBounds& whole) {
  const auto half = [](float from, float to) { return Packet::set(0.5F * (to - from)); };
  const Packet along_slab[3] = {half(whole.low, whole.high), half(low[0], high[0]), half(low[1], high[1])};
  if (!all_of(is_elongated(along_slab, broadcast(whole.half)))) return set_no_sides(whole);
  whole.turn = largest(turn), whole.is_elongated = 1;
  for (int k = 0; k < 2; ++k) whole.side_low[k] = low[k], whole.side_high[k] = high[k];
}

/// Boxes along the normal of a slab and two directions in its plane. They extend by `half` about the points that are at
/// `middle` over the volumes' centers, along each axis. Half sizes have room for the rounding of the axes.
struct OrientedBoxes {
  Packet3 axis[3];
  Packet middle[3], half[3];
};

/// The boxes of the volumes in the slots `i` and following.
LIMBER_KERNEL OrientedBoxes oriented_boxes(const bvh::Node& node, std::uint32_t i) {
  const bvh::ChildBounds& n = node.bounds;
  OrientedBoxes boxes;
  Packet3(&axis)[3] = boxes.axis;
  axis[0] = {Packet::load(n.normal_x + i), Packet::load(n.normal_y + i), Packet::load(n.normal_z + i)};
  axis[1] = in_plane(axis[0], Packet::from_int16(node.sides.turn + i));
  axis[2] = cross(axis[0], axis[1]);
  const Packet radius = Packet::load(n.radius + i), low = Packet::load(n.low + i), high = Packet::load(n.high + i),
               one_half = Packet::set(0.5F);
  boxes.middle[0] = one_half * (high + low),
  boxes.half[0] = one_half * (high - low) + radius * Packet::set(base::sides_error);
  const Packet half_step = radius * Packet::set(0.5F / bvh::max_side);
  for (int k = 0; k < 2; ++k) {
    const Packet from = Packet::from_int16(node.sides.low[k] + i), to = Packet::from_int16(node.sides.high[k] + i);
    boxes.middle[k + 1] = half_step * (to + from), boxes.half[k + 1] = half_step * (to - from);
  }
  return boxes;
}

/// How far boxes extend from the volumes' centers along a direction and along the opposite one.
struct TwoSupports {
  Packet above, below;
};
LIMBER_KERNEL TwoSupports supports(const OrientedBoxes& boxes, const Packet3& direction) {
  Packet middle = zero(), half = zero();
  for (int k = 0; k < 3; ++k) {
    const Packet cosine = dot(boxes.axis[k], direction);
    middle = middle + cosine * boxes.middle[k], half = half + abs(cosine) * boxes.half[k];
  }
  return {half + middle, half - middle};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

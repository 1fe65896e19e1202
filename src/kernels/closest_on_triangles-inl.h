// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The closest points of triangles to a point, nearly.

#if defined(LIMBER_SIMD_CLOSEST_ON_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_CLOSEST_ON_TRIANGLES_INL_H
#undef LIMBER_SIMD_CLOSEST_ON_TRIANGLES_INL_H
#else
#define LIMBER_SIMD_CLOSEST_ON_TRIANGLES_INL_H
#endif

#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Replaces smaller divisors: lengths and squares, in quantization steps or in units.
inline constexpr float shortest_divisor = 0x1p-60F;

/// Triangles (a, b, c) of a packet of slots, relative to a point.
struct PointTriangles {
  Packet3 to_corner;       // from the point to a
  Packet3 edge_b, edge_c;  // from a to b, and from a to c
};

/// A point of each triangle near the closest one, relative to the query point. Rounding may make it a worse point, but
/// it stays on the triangle: weights of b and c are never negative; together they are at most 1 (or 1 + 2^-23, by
/// rounding).
LIMBER_KERNEL Packet3 nearly_closest(const PointTriangles& t) {
  const Packet one = Packet::set(1), least = Packet::set(shortest_divisor);
  const auto clamped = [&](Packet x) { return min(max(x, zero()), one); };
  const Packet bb = dot(t.edge_b, t.edge_b), bc = dot(t.edge_b, t.edge_c), cc = dot(t.edge_c, t.edge_c);
  const Packet along_b = zero() - dot(t.to_corner, t.edge_b), along_c = zero() - dot(t.to_corner, t.edge_c);
  // The closest points of the edges ab and ac, and of bc, which is called the third edge. The point of weights v, w is
  // x = a + v edge_b + w edge_c. With p the query point, change = (|x - p|^2 - |a - p|^2) / 2 is enough to compare
  // points, and free of the cancellation of large squares. It is v (bb v / 2 + w bc - along_b) + w (cc w / 2 -
  // along_c), and negative where x is nearer than a.
  const Packet half = Packet::set(0.5F);
  const Packet at_b = clamped(along_b / max(bb, least)), at_c = clamped(along_c / max(cc, least));
  const Packet third_sq = bb - bc - bc + cc;
  const Packet third_c = clamped((along_c - along_b + bb - bc) / max(third_sq, least));
  const Packet third_b = one - third_c;
  const Packet change_b = at_b * (at_b * half * bb - along_b), change_c = at_c * (at_c * half * cc - along_c);
  const Packet change_third =
      third_b * (third_b * half * bb + third_c * bc - along_b) + third_c * (third_c * half * cc - along_c);
  const Mask c_is_nearer = change_c < change_b;
  Packet weight_b = select(c_is_nearer, zero(), at_b), weight_c = select(c_is_nearer, at_c, zero());
  const Mask third_is_nearest = change_third < min(change_b, change_c);
  weight_b = select(third_is_nearest, third_b, weight_b), weight_c = select(third_is_nearest, third_c, weight_c);
  // The foot of the point, if it is inside of the triangle: its weights are proportional to the areas opposite corners.
  const Packet area_b = cc * along_b - bc * along_c, area_c = bb * along_c - bc * along_b;
  const Packet area = bb * cc - bc * bc, area_a = area - area_b - area_c;
  const Mask is_inside = (area_a > zero()) & (area_b > zero()) & (area_c > zero());
  const Packet per_area = one / max(area_a + area_b + area_c, least);
  weight_b = select(is_inside, area_b * per_area, weight_b), weight_c = select(is_inside, area_c * per_area, weight_c);
  return t.to_corner + t.edge_b * weight_b + t.edge_c * weight_c;
}

/// The gap between the point and each triangle along a direction, times the length of `direction`. Negative if the
/// point's height along the direction is within the interval of the corners' heights.
LIMBER_KERNEL Packet gap_times_length(const PointTriangles& t, const Packet3& direction) {
  const Packet height = dot(t.to_corner, direction);
  const Packet b = dot(t.edge_b, direction), c = dot(t.edge_c, direction);
  return max(height + min(min(b, c), zero()), zero() - height - max(max(b, c), zero()));
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::bound_children.

#if defined(LIMBER_SIMD_BOUND_CHILDREN_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#undef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#else
#define LIMBER_SIMD_BOUND_CHILDREN_INL_H
#endif

#include "core/error_bounds.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"
#include "simd/project-inl.h"
#include "simd/slab_sphere-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Against divisions by 0. A divisor that is too large only lowers a bound.
inline constexpr float smallest_divisor = 0x1p-50F, smallest_radius_sum = 0x1p-100F;

/// Bound 5 of docs/algorithms/bounds.md: returns the children that the search direction does not prune, and sets
/// `bound_sq` to the squared bound along it, for all children.
LIMBER_KERNEL Mask near_along(const NodePairs& p, const ProjectedDirection& direction, Packet& bound_sq) {
  const Packet3 n = broadcast(direction.normal);
  const Packet cosine = dot(p.normal, n);
  const Packet3 crossed = cross(p.normal, n);
  const Packet sphere_support =
      support(p.radius, select(cosine > zero(), p.upper, p.lower), abs(cosine), sqrt(dot(crossed, crossed)));
  // The gap along n falls short of the prune distance by `deficit`. The gap of the spheres across n may make up for it:
  // (prune_distance - deficit)^2 + across^2 >= prune_distance^2.
  const Packet deficit = dot(n, p.center) + min(sphere_support, box_support(p.half, n)) - Packet::set(direction.gap);
  const Packet3 crossed_d = cross(p.d, n);
  const Packet across = max(sqrt(dot(crossed_d, crossed_d)) * Packet::set(core::squares_down) - p.radius_sum, zero());
  const Packet prune_distance = Packet::set(direction.prune_distance), missing = min(deficit, prune_distance);
  const Packet needed = missing * (prune_distance + (prune_distance - missing));
  bound_sq = gap_sq(prune_distance * Packet::set(core::squares_down) - deficit, across);
  return (deficit > zero()) & (needed >= across * across * Packet::set(core::squares_down));
}

/// Squared gap of the spheres, or of the boxes along the axes of the children.
LIMBER_KERNEL Packet sphere_and_box_sq(const NodePairs& p, const Packet3& other_half) {
  const Packet x = max(abs(p.d.x) - p.half.x - other_half.x, zero());
  const Packet y = max(abs(p.d.y) - p.half.y - other_half.y, zero());
  const Packet z = max(abs(p.d.z) - p.half.z - other_half.z, zero());
  return max(gap_sq(p.sphere_gap, zero()), x * x + y * y + z * z);
}

/// Squared gap along the normal of either slab, or along the line of centers. Names that end in _o are of the other,
/// projected node.
LIMBER_KERNEL Packet slab_sq(const NodePairs& p, const ProjectedNode& other) {
  const Packet radius_o = Packet::set(other.radius);
  const Packet3 normal_o = broadcast(other.normal);
  const Cap upper_o{Packet::set(other.high), Packet::set(other.rim_high)};
  const Cap lower_o{Packet::set(-other.low), Packet::set(other.rim_low)};
  // Along either normal, together with the gap of the spheres across it.
  const Packet cosine = dot(p.normal, normal_o);
  const Packet3 crossed = cross(p.normal, normal_o);
  const Packet cosine_abs = abs(cosine), sine = sqrt(dot(crossed, crossed));
  const Packet height_o = dot(p.d, normal_o), height = dot(p.d, p.normal);
  const Packet height_o_abs = abs(height_o), height_abs = abs(height);
  const Packet rounding = p.d_sq * Packet::set(core::across_error);
  const Packet across_o = sqrt(max(p.d_sq - height_o * height_o - rounding, zero()));
  const Packet across = sqrt(max(p.d_sq - height * height - rounding, zero()));
  // Which side of a slab counts follows from the same comparisons as which side the other node is on: heights of 0,
  // and products that underflow, must not have it both ways.
  const Mask is_above_o = height_o > zero(), is_above = height > zero(), is_acute = cosine > zero();
  const Cap near_o = select(is_above_o, lower_o, upper_o), near = select(is_above, p.upper, p.lower);
  const Packet support_along_o = support(p.radius, select(is_above_o ^ is_acute, p.lower, p.upper), cosine_abs, sine);
  const Packet support_o_along = support(radius_o, select(is_above ^ is_acute, upper_o, lower_o), cosine_abs, sine);
  const Packet best = max(gap_sq(height_o_abs - support_along_o - near_o.height, across_o - p.radius_sum),
                          gap_sq(height_abs - near.height - support_o_along, across - p.radius_sum));
  // Along the line of centers; products with `distance` instead of quotients. The sines are rounded down above; here
  // they have to be rounded up.
  const Packet sine_rounding = p.distance * Packet::set(core::sine_error);
  const Packet support_times_d =
      min(box_support(p.half, p.d), select(p.radius * height_abs <= near.height * p.distance, p.radius * p.distance,
                                           near.height * height_abs + near.rim * (across + sine_rounding)));
  const Packet support_o_times_d = select(radius_o * height_o_abs <= near_o.height * p.distance, radius_o * p.distance,
                                          near_o.height * height_o_abs + near_o.rim * (across_o + sine_rounding));
  const Packet gap =
      max(p.d_sq - support_times_d - support_o_times_d, zero()) / max(p.distance, Packet::set(smallest_divisor));
  return max(best, gap * gap);
}

/// The same as bound_children() for the children `i` and following.
LIMBER_KERNEL KeptSlots bound_packet(const bvh::ChildBounds& children, std::uint32_t i, const ProjectedNode& other,
                                     const ProjectedDirection* direction, float limit_sq, float* order,
                                     float* bound_sq) {
  const NodePairs p = pair_up(children, i, other);
  const Packet limit = Packet::set(limit_sq), down = Packet::set(core::squares_down);
  const Packet best = max(sphere_and_box_sq(p, broadcast(other.half)), slab_sq(p, other)) * down;
  const Packet overlap = p.sphere_gap / max(p.radius_sum, Packet::set(smallest_radius_sum));
  select(best > zero(), best, min(overlap, zero())).store(order + i);
  unsigned kept = bits(best < limit);
  Packet along_sq = zero();
  if (direction != nullptr) kept &= bits(near_along(p, *direction, along_sq));
  if (bound_sq != nullptr) max(best, along_sq * down).store(bound_sq + i);
  return {kept, kept & bits(best <= zero())};
}

LIMBER_KERNEL KeptSlots bound_children(const bvh::WideNode& node, const OtherNode& other,
                                       const FrameTransform& transform, const PruneLimits& pruning, float limit_sq,
                                       float* order, float* bound_sq) {
  alignas(32) double center[4];
  project_center(*other.node, other.slot, transform, node.origin, center);
  const ProjectedNode projected = project_node(node, other, transform, center);
  ProjectedDirection direction;
  const bool has_direction = pruning.has_direction && pruning.distance * transform.per_unit < core::max_units / 2;
  if (has_direction) direction = project_direction(node, other, transform, pruning, center);
  KeptSlots kept{0, 0};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const KeptSlots these =
        bound_packet(node.bounds, i, projected, has_direction ? &direction : nullptr, limit_sq, order, bound_sq);
    kept.all |= these.all << i, kept.overlapping |= these.overlapping << i;
  }
  const unsigned used = (1U << node.child_count) - 1;
  return {kept.all & used, kept.overlapping & used};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

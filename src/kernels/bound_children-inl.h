// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::bound_children: lower bounds of the distances between the children of a node and one slot of the other tree.
// Each is the largest of (docs/algorithms/bounds.md):
//   1. the gap of the spheres (sphere_gap);
//   2. the distance of the boxes, in the frame of either tree (box_gaps, own_box_gaps);
//   3. the gap along the normal of either slab, with the gap of the spheres across it (slab_sq);
//   4. the gap along the line of centers (slab_sq).
// A fifth, the gap along the search direction, prunes on its own (near_along).

#if defined(LIMBER_SIMD_BOUND_CHILDREN_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#undef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#else
#define LIMBER_SIMD_BOUND_CHILDREN_INL_H
#endif

#include "base/error_bounds.h"
#include "kernels/project-inl.h"
#include "kernels/slab_sphere-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Against divisions by 0. A divisor that is too large only lowers what is divided.
inline constexpr float smallest_divisor = 0x1p-50F, smallest_radius_sum = 0x1p-100F;

/// Returns the children that the search direction does not prune. Sets `bound_sq`, for all children, to the squared gap
/// along it, with the gap of the spheres across it.
LIMBER_KERNEL Mask near_along(const NodePairs& p, const ProjectedDirection& direction, Packet& bound_sq) {
  const Packet3 n = broadcast(direction.direction);
  const Packet cosine = dot(p.normal, n);
  const Packet3 crossed = cross(p.normal, n);
  const Packet sphere_support =
      support(p.radius, select(cosine > zero(), p.upper, p.lower), abs(cosine), sqrt(dot(crossed, crossed)));
  // P is the prune distance, G the gap along n less all errors, deficit = P - G, and missing = P - max(G, 0);
  // pruned_support contains P, the errors, and the place and extent of the other node. Across n, the spheres are apart
  // by `across`. A child is pruned where max(G, 0)^2 + across^2 >= P^2, that is, where across^2 is at least P^2 - (P -
  // missing)^2, `needed_sq`.
  const Packet deficit =
      dot(n, p.center) + min(sphere_support, box_support(p.half, n)) - Packet::set(direction.pruned_support);
  const Packet3 crossed_d = cross(p.d, n);
  const Packet across = max(sqrt(dot(crossed_d, crossed_d)) * Packet::set(base::squares_down) - p.radius_sum, zero());
  const Packet prune_distance = Packet::set(direction.prune_distance), missing = min(deficit, prune_distance);
  const Packet needed_sq = missing * (prune_distance + (prune_distance - missing));
  bound_sq = gap_sq(prune_distance * Packet::set(base::squares_down) - deficit, across);
  return (deficit > zero()) & (needed_sq >= across * across * Packet::set(base::squares_down));
}

/// Gaps along three axes, negative where the boxes overlap.
LIMBER_KERNEL Packet3 box_gaps(const NodePairs& p, const ProjectedNode& other) {
  const Packet3 half_o = broadcast(other.half);
  return {abs(p.d.x) - p.half.x - half_o.x, abs(p.d.y) - p.half.y - half_o.y, abs(p.d.z) - p.half.z - half_o.z};
}
/// Gaps along the axes of the other node's own frame, negative where the boxes overlap.
LIMBER_KERNEL Packet3 own_box_gaps(const NodePairs& p, const ProjectedNode& other, const FrameTransform& transform) {
  const auto gap = [&](int k) {
    const Packet half = dot(p.half, broadcast(transform.rotation_abs[k]));
    return abs(dot(p.d, broadcast(transform.rotation[k]))) - half - Packet::set(other.own_half[k]);
  };
  return {gap(0), gap(1), gap(2)};
}

/// Children and a projected node along the normal of either slab. Names that end in _o are of the other, projected
/// node, or along its normal.
struct Slabs {
  Packet height_o, height, height_o_abs, height_abs;  // of the other center over that of the child
  Cap near_o, near;                                   // the sides that face each other
  Packet gap_o, gap;                                  // negative where they overlap
};

LIMBER_KERNEL Slabs compare_slabs(const NodePairs& p, const ProjectedNode& other) {
  const Packet3 normal_o = broadcast(other.normal);
  const Packet radius_o = Packet::set(other.radius);
  const Cap upper_o = cap(radius_o, Packet::set(other.high)), lower_o = cap(radius_o, Packet::set(-other.low));
  const Packet cosine = dot(p.normal, normal_o);
  const Packet3 crossed = cross(p.normal, normal_o);
  const Packet cosine_abs = abs(cosine), sine = sqrt(dot(crossed, crossed));
  Slabs s;
  s.height_o = dot(p.d, normal_o), s.height = dot(p.d, p.normal);
  s.height_o_abs = abs(s.height_o), s.height_abs = abs(s.height);
  // The sign of each height and of the cosine is decided once. It tells both on which side the other node is and which
  // cap faces it. With two comparisons, a height of 0 or a product that underflows could give one answer here and the
  // other there. From the child, the other node is along +normal_o where is_above_o. So the child's upper cap faces it
  // where is_above_o equals is_acute. From the other node the direction is reversed: its upper cap faces the child
  // where is_above differs from is_acute.
  const Mask is_above_o = s.height_o > zero(), is_above = s.height > zero(), is_acute = cosine > zero();
  s.near_o = select(is_above_o, lower_o, upper_o), s.near = select(is_above, p.upper, p.lower);
  const Packet support_of_child = support(p.radius, select(is_above_o ^ is_acute, p.lower, p.upper), cosine_abs, sine);
  const Packet support_of_other = support(radius_o, select(is_above ^ is_acute, upper_o, lower_o), cosine_abs, sine);
  s.gap_o = s.height_o_abs - support_of_child - s.near_o.height;
  s.gap = s.height_abs - s.near.height - support_of_other;
  return s;
}

/// Squared gap along the normal of either slab, or along the line of centers.
LIMBER_KERNEL Packet slab_sq(const NodePairs& p, const ProjectedNode& other) {
  const Slabs s = compare_slabs(p, other);
  // Bound 3: the gap along either normal, combined with the gap of the spheres across it.
  const Packet rounding = p.d_sq * Packet::set(base::across_error);
  const Packet across_o = sqrt(max(p.d_sq - s.height_o * s.height_o - rounding, zero()));
  const Packet across = sqrt(max(p.d_sq - s.height * s.height - rounding, zero()));
  const Packet best = max(gap_sq(s.gap_o, across_o - p.radius_sum), gap_sq(s.gap, across - p.radius_sum));
  // Bound 4, as support() along d / distance, but with everything multiplied by the distance, which saves divisions:
  // the cosine to a normal is height / distance, the sine across / distance. A sphere's farthest point is inside its
  // slab, and counts, where radius * cosine <= height of the cap; else the rim does. The sines are rounded down above;
  // here they have to be rounded up.
  const Packet radius_o = Packet::set(other.radius);
  const Packet sine_rounding = p.distance * Packet::set(base::sine_error);
  const Packet support_times_d =
      min(box_support(p.half, p.d), select(p.radius * s.height_abs <= s.near.height * p.distance, p.radius * p.distance,
                                           s.near.height * s.height_abs + s.near.rim * (across + sine_rounding)));
  const Packet support_o_times_d =
      select(radius_o * s.height_o_abs <= s.near_o.height * p.distance, radius_o * p.distance,
             s.near_o.height * s.height_o_abs + s.near_o.rim * (across_o + sine_rounding));
  const Packet gap =
      max(p.d_sq - support_times_d - support_o_times_d, zero()) / max(p.distance, Packet::set(smallest_divisor));
  return max(best, gap * gap);
}

/// The largest gap: positive where the volumes are apart. Without gaps across a slab's normal and without the line of
/// centers, which need square roots and a division and hardly tell volumes apart that nothing else does.
LIMBER_KERNEL Packet largest_gap(const NodePairs& p, const ProjectedNode& other, const FrameTransform& transform) {
  const Slabs s = compare_slabs(p, other);
  const Packet3 boxes = box_gaps(p, other), own_boxes = own_box_gaps(p, other, transform);
  const Packet of_boxes = max(max(boxes.x, boxes.y), max(boxes.z, max(max(own_boxes.x, own_boxes.y), own_boxes.z)));
  return max(max(p.sphere_gap, of_boxes), max(s.gap_o, s.gap));
}

/// What bound_children() does, for one packet of children from `i` on. With `overlap_only` the bounds themselves do not
/// matter, only whether they are 0.
template <bool overlap_only>
LIMBER_KERNEL KeptSlots bound_packet(const bvh::ChildBounds& children, std::uint32_t i, const ProjectedNode& other,
                                     const FrameTransform& transform, const ProjectedDirection* direction,
                                     float limit_sq, float* order, float* bound_sq) {
  const NodePairs p = pair_up(children, i, other);
  const Packet limit = Packet::set(limit_sq), down = Packet::set(base::squares_down);
  Packet best;
  if (overlap_only) {
    best = largest_gap(p, other, transform);
  } else {
    const Packet of_boxes =
        max(length_of_gaps_sq(box_gaps(p, other)), length_of_gaps_sq(own_box_gaps(p, other, transform)));
    best = max(max(gap_sq(p.sphere_gap, zero()), of_boxes), slab_sq(p, other)) * down;
  }
  const Packet overlap = p.sphere_gap / max(p.radius_sum, Packet::set(smallest_radius_sum));
  select(best > zero(), best, min(overlap, zero())).store(order + i);  // the bound, or minus the depth of the overlap
  // With `overlap_only` the limit is next to 0, so it does not matter that a gap is not squared.
  unsigned kept = bits(best < limit);
  Packet along_sq = zero();
  if (direction != nullptr) kept &= bits(near_along(p, *direction, along_sq));
  if (bound_sq != nullptr) max(best, along_sq * down).store(bound_sq + i);
  return {kept, kept & bits(best <= zero())};
}

LIMBER_KERNEL KeptSlots bound_children(const bvh::Node& node, const SlotRef& other, const FrameTransform& transform,
                                       const PruneLimits& pruning, float limit_sq, float* order, float* bound_sq) {
  alignas(32) double center[4];
  project_center(*other.node, other.slot, transform, node.origin, center);
  const ProjectedNode projected = project_node(node, other, transform, center);
  ProjectedDirection direction;
  const bool has_direction = pruning.has_direction && pruning.distance * transform.per_unit < base::max_units / 2;
  if (has_direction) direction = project_direction(node, other, transform, pruning, center);
  const bool overlap_only = pruning.distance <= smallest_prune_distance && bound_sq == nullptr;
  KeptSlots kept{0, 0};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const ProjectedDirection* const along = has_direction ? &direction : nullptr;
    const KeptSlots these =
        overlap_only ? bound_packet<true>(node.bounds, i, projected, transform, along, limit_sq, order, bound_sq)
                     : bound_packet<false>(node.bounds, i, projected, transform, along, limit_sq, order, bound_sq);
    kept.all |= these.all << i, kept.overlapping |= these.overlapping << i;
  }
  const unsigned used = (1U << node.child_count) - 1;
  return {kept.all & used, kept.overlapping & used};
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

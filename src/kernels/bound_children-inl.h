// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::bound_children: lower bounds of the distances between the children of a node and one slot of the other tree.
// Each is the largest of (docs/algorithms/bounds.md):
//   1. the gap of the spheres (sphere_gap);
//   2. the distance of the boxes, in the frame of either tree (box_gaps, own_box_gaps);
//   3. the gap along the normal of either slab, with the gap of the spheres across it (slab_sq);
//   4. the gap along the line of centers (slab_sq).
// A fifth, the gap along the search direction, prunes on its own (compare_along). Where a child that is left or the
// other slot is elongated, bound 6 is the distance of the boxes along their slabs, or the gap across the longest axes
// of both (compare_along_slabs).

#if defined(LIMBER_SIMD_BOUND_CHILDREN_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#undef LIMBER_SIMD_BOUND_CHILDREN_INL_H
#else
#define LIMBER_SIMD_BOUND_CHILDREN_INL_H
#endif

#include <cmath>

#include "base/error_bounds.h"
#include "kernels/project-inl.h"
#include "kernels/slab_sides-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

// Against divisions by 0. A divisor that is too large only lowers what is divided.
inline constexpr float smallest_divisor = 0x1p-50F, smallest_radius_sum = 0x1p-100F;

/// How the children are along the search direction.
struct Along {
  Mask are_near;    // the direction does not prune them
  Packet bound_sq;  // the squared gap along it, with the gap of the spheres across it
  Packet extent;    // as Support::extent
};

LIMBER_KERNEL Along compare_along(const NodePairs& p, const ProjectedDirection& direction) {
  const Packet3 n = broadcast(direction.direction);
  const Packet cosine = dot(p.normal, n);
  const Packet3 crossed = cross(p.normal, n);
  const Packet sine = sqrt(dot(crossed, crossed)), cosine_abs = abs(cosine);
  const Cap near = select(cosine > zero(), p.upper, p.lower);
  const Packet along_x = abs(n.x) * p.half.x, along_y = abs(n.y) * p.half.y, along_z = abs(n.z) * p.half.z;
  const Packet box = along_x + along_y + along_z;
  const Packet child_support = min(support(p.radius, near, cosine_abs, sine), box);
  const Packet twice_longest = Packet::set(2) * max(max(along_x, along_y), along_z);
  const Packet touched = max(near.height * cosine_abs - near.rim * sine, twice_longest - box);
  // P is the prune distance, G the gap along n less all errors, deficit = P - G, and missing = P - max(G, 0);
  // pruned_support contains P, the errors, and the place and extent of the other node. Across n, the spheres are apart
  // by `across`. A child is pruned where max(G, 0)^2 + across^2 >= P^2, that is, where across^2 is at least P^2 - (P -
  // missing)^2, `needed_sq`.
  const Packet deficit = dot(n, p.center) + child_support - Packet::set(direction.pruned_support);
  const Packet3 crossed_d = cross(p.d, n);
  const Packet across = max(sqrt(dot(crossed_d, crossed_d)) * Packet::set(base::squares_down) - p.radius_sum, zero());
  const Packet prune_distance = Packet::set(direction.prune_distance), missing = min(deficit, prune_distance);
  const Packet needed_sq = missing * (prune_distance + (prune_distance - missing));
  return {(deficit > zero()) & (needed_sq >= across * across * Packet::set(base::squares_down)),
          gap_sq(prune_distance * Packet::set(base::squares_down) - deficit, across),
          child_support - Packet::set(0.5F) * touched};
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
  const unsigned overlapping = bits(best <= zero());
  Packet extent = Packet::set(0.5F) * (p.upper.height + p.lower.height);
  Packet extent_o = Packet::set(0.5F * (other.high - other.low));
  if (direction != nullptr) {
    const Along along = compare_along(p, *direction);
    kept &= bits(along.are_near);
    if (bound_sq != nullptr) best = max(best, along.bound_sq * down);
    const Mask are_apart = p.sphere_gap > zero();
    extent = select(are_apart, along.extent, extent);
    extent_o = select(are_apart, Packet::set(direction->other_extent), extent_o);
  }
  if (bound_sq != nullptr) best.store(bound_sq + i);
  const Packet more = Packet::set(share_of_radius) * (p.radius - Packet::set(other.radius)) + (extent - extent_o);
  return {kept, kept & overlapping, overlap_only ? 0 : bits(more >= zero())};
}

/// The box along its slab of a slot of the other tree, in every lane.
LIMBER_KERNEL OrientedBoxes oriented_box(const SlotRef& other, const ProjectedNode& p,
                                         const FrameTransform& transform) {
  const bvh::ChildBounds& n = other.node->bounds;
  const bvh::SlabSides& sides = other.node->sides;
  const std::uint32_t k = other.slot;
  const float radius = p.radius - p.error, half_step = radius * (0.5F / bvh::max_side);
  const Packet3 own = in_plane({Packet::set(n.normal_x[k]), Packet::set(n.normal_y[k]), Packet::set(n.normal_z[k])},
                               Packet::set(sides.turn[k]));
  const float(&columns)[3][4] = transform.rotation;
  OrientedBoxes box;
  box.axis[0] = broadcast(p.normal);
  box.axis[1] = broadcast(columns[0]) * own.x + broadcast(columns[1]) * own.y + broadcast(columns[2]) * own.z;
  box.axis[2] = cross(box.axis[0], box.axis[1]);
  box.middle[0] = Packet::set(0.5F * (p.high + p.low)),
  box.half[0] = Packet::set(0.5F * (p.high - p.low) + radius * base::sides_error);
  for (int i = 0; i < 2; ++i) {
    const int low = sides.low[i][k], high = sides.high[i][k];
    box.middle[i + 1] = Packet::set(static_cast<float>(high + low) * half_step);
    box.half[i + 1] = Packet::set(static_cast<float>(high - low) * half_step + p.error);
  }
  return box;
}

/// Gaps along the axes of boxes, negative where they overlap.
struct OrientedGaps {
  Packet3 own, other;
};
LIMBER_KERNEL OrientedGaps oriented_gaps(const OrientedBoxes& boxes, const OrientedBoxes& other, const Packet3& d) {
  Packet own[3], height_o[3], half_o[3];
  for (int j = 0; j < 3; ++j) height_o[j] = dot(other.axis[j], d) + other.middle[j], half_o[j] = other.half[j];
  for (int k = 0; k < 3; ++k) {
    Packet height = dot(boxes.axis[k], d) - boxes.middle[k], half = boxes.half[k];
    for (int j = 0; j < 3; ++j) {
      const Packet cosine = dot(boxes.axis[k], other.axis[j]), cosine_abs = abs(cosine);
      height = height + cosine * other.middle[j], half = half + cosine_abs * other.half[j];
      height_o[j] = height_o[j] - cosine * boxes.middle[k], half_o[j] = half_o[j] + cosine_abs * boxes.half[k];
    }
    own[k] = abs(height) - half;
  }
  return {{own[0], own[1], own[2]},
          {abs(height_o[0]) - half_o[0], abs(height_o[1]) - half_o[1], abs(height_o[2]) - half_o[2]}};
}

// Longest axes that enclose a smaller angle, its squared sine, have no direction across both that rounding leaves.
inline constexpr float least_sine_sq = 0x1p-6F;

/// The gap along the direction across the longest axes of both boxes, which parts two rods that pass each other at an
/// angle. Negative where they overlap; 0 where these axes are nearly parallel.
LIMBER_KERNEL Packet gap_across(const OrientedBoxes& boxes, const OrientedBoxes& other, const Packet3& d) {
  const Packet3 long_axis = select(boxes.half[1] >= boxes.half[2], boxes.axis[1], boxes.axis[2]);
  const Packet3 long_axis_o = select(other.half[1] >= other.half[2], other.axis[1], other.axis[2]);
  const Packet3 normal = cross(long_axis, long_axis_o);
  const Packet sine_sq = dot(normal, normal), height = dot(normal, d);
  const TwoSupports own = supports(boxes, normal), others = supports(other, normal);
  const Packet gap = max(height - own.above - others.below, zero() - height - own.below - others.above);
  const Packet rounding = (abs(d.x) + abs(d.y) + abs(d.z)) * Packet::set(base::projection_error);
  return select(sine_sq >= Packet::set(least_sine_sq), (gap - rounding) / sqrt(sine_sq), zero());
}

/// Raises the bounds of kept children by the boxes along slabs, and returns the children that are left. Apart from
/// bound_children(), as few nodes need it.
LIMBER_KERNEL_APART KeptSlots compare_along_slabs(const bvh::Node& node, const SlotRef& other,
                                                  const FrameTransform& transform, float limit_sq, KeptSlots kept,
                                                  float* order, float* bound_sq) {
  alignas(32) double center[4];
  project_center(*other.node, other.slot, transform, node.origin, center);
  const ProjectedNode projected = project_node(node, other, transform, center);
  const OrientedBoxes box = oriented_box(other, projected, transform);
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const Packet3 d = broadcast(projected.center) - centers(node.bounds, i);
    const OrientedBoxes boxes = oriented_boxes(node, i);
    const OrientedGaps g = oriented_gaps(boxes, box, d);
    const Packet across = max(gap_across(boxes, box, d), zero());
    const Packet gap_sq = max(max(length_of_gaps_sq(g.own), length_of_gaps_sq(g.other)), across * across) *
                          Packet::set(1 - base::sides_error);
    const Mask is_better = gap_sq > zero();
    const Packet before = Packet::load(order + i);
    select(is_better, max(before, gap_sq), before).store(order + i);
    if (bound_sq != nullptr) max(Packet::load(bound_sq + i), gap_sq).store(bound_sq + i);
    kept.overlapping &= ~(bits(is_better) << i), kept.all &= ~(bits(gap_sq >= Packet::set(limit_sq)) << i);
  }
  return kept;
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
  KeptSlots kept{0, 0, 0};
  for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
    const ProjectedDirection* const along = has_direction ? &direction : nullptr;
    const KeptSlots these =
        overlap_only ? bound_packet<true>(node.bounds, i, projected, transform, along, limit_sq, order, bound_sq)
                     : bound_packet<false>(node.bounds, i, projected, transform, along, limit_sq, order, bound_sq);
    kept.all |= these.all << i, kept.overlapping |= these.overlapping << i, kept.larger |= these.larger << i;
  }
  const unsigned used = bvh::used_slots(node);
  kept = {kept.all & used, kept.overlapping & used, kept.larger & used};
  if (kept.all != 0 && ((node.elongated_slots & kept.all) | (other.node->elongated_slots >> other.slot & 1)) != 0)
      [[unlikely]] {
    return compare_along_slabs(node, other, transform, limit_sq, kept, order, bound_sq);
  }
  return kept;
}

// Kernels::bound_leaf: a lower bound of the distance between the triangles of a leaf and a volume of the other tree.
//
// The volume of a leaf of a few large triangles, as of a wall and a floor, contains much space that none of them is in.
// So each triangle is compared with the other volume on its own, by the gap along: the axes of either box, the normal
// of the slab, the normal of the triangle, and the line from the volume's center to the closest point of the triangle,
// approximately.

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

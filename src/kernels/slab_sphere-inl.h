// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A child volume as a sphere cut by a slab, next to a node of the other tree.

#if defined(LIMBER_SIMD_SLAB_SPHERE_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_SLAB_SPHERE_INL_H
#undef LIMBER_SIMD_SLAB_SPHERE_INL_H
#else
#define LIMBER_SIMD_SLAB_SPHERE_INL_H
#endif

#include "kernels/project-inl.h"
#include "layout/node.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// The centers, half sizes of boxes and slab normals of the children `i` and following.
LIMBER_KERNEL Packet3 centers(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.center_x + i), Packet::load(n.center_y + i), Packet::load(n.center_z + i)};
}
LIMBER_KERNEL Packet3 half_sizes(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.half_x + i), Packet::load(n.half_y + i), Packet::load(n.half_z + i)};
}
LIMBER_KERNEL Packet3 normals(const bvh::ChildBounds& n, std::uint32_t i) {
  return {Packet::load(n.normal_x + i), Packet::load(n.normal_y + i), Packet::load(n.normal_z + i)};
}

/// A plane of a slab that cuts a sphere: its height over the sphere's center along the slab's outward normal, negative
/// where the slab does not contain the center, and the radius of the circle in which it cuts the sphere.
struct Cap {
  Packet height, rim;
};

LIMBER_KERNEL Cap cap(Packet radius, Packet height) {
  return {height, sqrt(max(radius * radius - height * height, zero()))};
}
LIMBER_KERNEL Cap select(Mask which, const Cap& a, const Cap& b) {
  return {select(which, a.height, b.height), select(which, a.rim, b.rim)};
}

/// The support of a sphere, less what lies beyond a cut, in a direction at an angle to the cut's outward normal: that
/// of the sphere where its farthest point remains, that of the rim otherwise. Pre: cosine >= 0.
LIMBER_KERNEL Packet support(Packet radius, const Cap& c, Packet cosine, Packet sine) {
  return select(radius * cosine <= c.height, radius, c.height * cosine + c.rim * sine);
}

/// Squared length of a vector with these components, negative ones counting as none.
LIMBER_KERNEL Packet gap_sq(Packet along, Packet across) {
  const Packet u = max(along, zero()), v = max(across, zero());
  return u * u + v * v;
}

/// Squared length of a vector with these components, negative ones counting as none.
LIMBER_KERNEL Packet length_of_gaps_sq(const Packet3& gaps) {
  const Packet3 g{max(gaps.x, zero()), max(gaps.y, zero()), max(gaps.z, zero())};
  return dot(g, g);
}

/// Children `i` and following of a node, and a projected node.
struct NodePairs {
  Packet3 center, half, normal;
  Packet3 d;  // from the children's centers to that of the projected node
  Packet radius, distance, d_sq;
  Packet radius_sum, sphere_gap;  // of both
  Cap upper, lower;
};

LIMBER_KERNEL NodePairs pair_up(const bvh::ChildBounds& children, std::uint32_t i, const ProjectedNode& other) {
  const bvh::ChildBounds& n = children;
  NodePairs p;
  p.center = centers(n, i);
  p.half = half_sizes(n, i);
  p.normal = normals(n, i);
  p.radius = Packet::load(n.radius + i);
  p.upper = cap(p.radius, Packet::load(n.high + i));
  p.lower = cap(p.radius, zero() - Packet::load(n.low + i));
  p.d = broadcast(other.center) - p.center;
  p.d_sq = dot(p.d, p.d);
  p.distance = sqrt(p.d_sq);
  p.radius_sum = p.radius + Packet::set(other.radius);
  p.sphere_gap = p.distance - p.radius_sum;
  return p;
}

LIMBER_KERNEL Packet box_support(const Packet3& half, const Packet3& direction) {
  return abs(direction.x) * half.x + abs(direction.y) * half.y + abs(direction.z) * half.z;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

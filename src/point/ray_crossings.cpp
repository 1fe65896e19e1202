// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point/ray_crossings.h"
#include "limber/distance.h"

#include <bit>

#include "bvh/slot_stack.h"
#include "geometry/winding.h"

namespace limber::point {
namespace {

/// Compares the triangles of a leaf that the ray may cross. False once the point lies on one of them.
bool add_leaf(const PlacedModel& model, const AxisRay& ray, bvh::SlotId slot, Surrounding& surrounding,
              QueryStats& stats) {
  const bvh::LeafInNode at = bvh::first_leaf(model.tree(), slot);
  const bvh::Leaf& leaf = at.leaf;
  unsigned crossed = simd::kernels().find_crossed_triangles(at.node, at.slot, leaf.corners, ray.in_frame);
  for (; crossed != 0; crossed &= crossed - 1) {
    const auto k = static_cast<std::uint32_t>(std::countr_zero(crossed));
    if (k > 0 && leaf.triangle[k] == leaf.triangle[k - 1]) continue;  // the slot is not in use
    ++stats.triangle_tests;
    const Triangle triangle = model.triangle(leaf.vertices[k]);
    if (geometry::lies_on(ray.origin, triangle)) return false;
    surrounding.winding_number += geometry::winding_along(ray.origin, triangle, ray.axis, ray.is_upward);
  }
  return true;
}

}  // namespace

Surrounding surrounding_of(const PlacedModel& model, const Vec3& point, QueryStats& stats) {
  Surrounding surrounding;
  ++stats.node_tests;
  const std::optional<AxisRay> ray = model.ray_from(point);
  if (!ray) return surrounding;
  const bvh::Tree& tree = model.tree();
  bvh::SlotStack waiting;
  waiting.start(0);
  for (bvh::SlotStack::Entry next; waiting.take(0, next);) {
    if (bvh::has_leaf(tree, next.slot)) {
      if (!add_leaf(model, *ray, next.slot, surrounding, stats)) return {.is_on = true};
      continue;
    }
    const std::uint32_t n = bvh::child_of(tree, next.slot);
    stats.node_tests += tree.nodes[n].child_count;
    waiting.add(n, simd::kernels().find_crossed_children(tree.nodes[n], ray->in_frame));
  }
  return surrounding;
}

}  // namespace limber::point

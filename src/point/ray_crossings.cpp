// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "point/ray_crossings.h"
#include "limber/distance.h"

#include <bit>

#include "base/check.h"
#include "geometry/winding.h"

namespace limber::point {
namespace {

/// Compares the triangles of a leaf that the ray may cross. False once the point lies on one of them.
bool add_leaf(const PlacedModel& model, const AxisRay& ray, bvh::SlotId slot, Surrounding& surrounding,
              QueryStats& stats) {
  const bvh::Node& node = model.tree().nodes[bvh::node_of(slot)];
  const bvh::Leaf& leaf = bvh::leaf_of(model.tree(), slot);
  unsigned crossed = simd::kernels().find_crossed_triangles(node, bvh::slot_of(slot), leaf.corners, ray.in_frame);
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
  // Every slot taken adds less than `width` more and goes one level down, of at most 11 (2^32 triangles).
  constexpr std::uint32_t stack_capacity = 96;
  bvh::SlotId waiting[stack_capacity] = {bvh::root};
  std::uint32_t waiting_count = 1;
  while (waiting_count > 0) {
    const bvh::SlotId slot = waiting[--waiting_count];
    if (bvh::has_leaf(tree, slot)) {
      if (!add_leaf(model, *ray, slot, surrounding, stats)) return {.is_on = true};
      continue;
    }
    const std::uint32_t n = bvh::child_of(tree, slot);
    stats.node_tests += tree.nodes[n].child_count;
    LIMBER_ASSERT(waiting_count + bvh::width <= stack_capacity);
    unsigned crossed = simd::kernels().find_crossed_children(tree.nodes[n], ray->in_frame);
    for (; crossed != 0; crossed &= crossed - 1) {
      waiting[waiting_count++] = n * bvh::width + static_cast<std::uint32_t>(std::countr_zero(crossed));
    }
  }
  return surrounding;
}

}  // namespace limber::point

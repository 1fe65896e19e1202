// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bit>
#include <cstdint>

#include "bvh/slot_stack.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "point/placed_model.h"
#include "simd/kernels.h"

namespace limber::point {

/// Calls visit(triangle) for every placed triangle that a ray may cross or begin on, until it returns false. Returns
/// whether all have been visited.
template <typename Visit>
bool visit_crossed(const PlacedModel& model, const AxisRay& ray, QueryStats& stats, const Visit& visit) {
  const bvh::Tree& tree = model.tree();
  bvh::SlotStack waiting;
  waiting.start(0);
  for (bvh::SlotStack::Entry next; waiting.take(0, next);) {
    if (!bvh::has_leaf(tree, next.slot)) {
      const std::uint32_t n = bvh::child_of(tree, next.slot);
      stats.node_tests += tree.nodes[n].child_count;
      waiting.add(n, simd::kernels().find_crossed_children(tree.nodes[n], ray.in_frame));
      continue;
    }
    const bvh::LeafInNode at = bvh::first_leaf(tree, next.slot);
    const bvh::Leaf& leaf = at.leaf;
    unsigned crossed = simd::kernels().find_crossed_triangles(at.node, at.slot, leaf.corners, ray.in_frame);
    for (; crossed != 0; crossed &= crossed - 1) {
      const auto k = static_cast<std::uint32_t>(std::countr_zero(crossed));
      if (!leaf.is_in_use(k)) continue;
      ++stats.primitive_tests;
      if (!visit(model.triangle(leaf.vertices[k]))) return false;
    }
  }
  return true;
}

/// How a closed surface lies around a point.
struct Surrounding {
  bool is_on = false;  ///< whether the point lies on a triangle; then the winding number means nothing
  int winding_number = 0;

  bool is_inside_or_on() const { return is_on || winding_number != 0; }
};

/// Counts how a ray from a point along an axis of the world crosses a closed surface.
///
/// Differs   From rays for pictures: triangles are judged exactly, for the placed corners, and the ray is moved aside
///           by an infinitesimal amount, so it never meets an edge (geometry/winding.h). Of the six directions it takes
///           the one in which it is soonest beyond the model's box.
///
/// Pre      The surface is closed and oriented. The point is finite and at most `max_coordinate` in size.
Surrounding surrounding_of(const PlacedModel& model, const Vec3& point, QueryStats& stats);

}  // namespace limber::point

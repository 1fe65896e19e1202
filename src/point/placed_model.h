// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "base/check.h"
#include "base/error_bounds.h"
#include "bvh/tree.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "simd/kernels.h"

namespace limber::point {

/// A ray along an axis of the world.
struct AxisRay {
  Vec3 origin;
  std::size_t axis;
  bool is_upward;
  simd::QueryRay in_frame;
};

/// The model of a query about points, and where it is. Constant while the query runs.
class PlacedModel {
 public:
  /// Throws   std::invalid_argument unless the model is committed and the pose is rigid.
  explicit PlacedModel(const Placed& placed);
  /// Pre: the tree is that of the mesh, and the pose is rigid.
  PlacedModel(const bvh::Tree& tree, const MeshView& mesh, const Transform& pose);

  const bvh::Tree& tree() const { return *tree_; }
  const MeshView& mesh() const { return mesh_; }
  const Transform& pose() const { return pose_; }
  /// At least the distance of any point of the placed model from the world's origin.
  double magnitude() const { return magnitude_; }

  /// A point of the world in the model's frame.
  Vec3 in_model(const Vec3& point) const { return to_frame_ * (point - pose_.translation); }
  /// A vertex in the world.
  Vec3 position(VertexId v) const {
    LIMBER_ASSERT(v < mesh_.positions.size());
    return pose_(mesh_.positions[v]);
  }

  /// A triangle in the world.
  Triangle triangle(const Corners& corners) const {
    LIMBER_ASSERT(std::max({corners[0], corners[1], corners[2]}) < mesh_.positions.size());
    const auto& positions = mesh_.positions;
    return {pose_(positions[corners[0]]), pose_(positions[corners[1]]), pose_(positions[corners[2]])};
  }

  /// The center of the sphere of a slot, in the world.
  Vec3 center_of(bvh::SlotId slot) const { return pose_(bvh::slot_center(*tree_, slot)); }
  /// The radius of a sphere about it, around all that the slot has below, but for what placing rounds.
  double radius_of(bvh::SlotId slot) const {
    const double units = tree_->nodes[bvh::node_of(slot)].bounds.radius[bvh::slot_of(slot)];
    return (tree_->unit * units + tree_->slack) * (1 + base::rigidity_error);
  }

  /// A point of the world as the kernels need it.
  simd::QueryPoint in_frame(const Vec3& point) const;

  /// The ray from a point of the world that is soonest beyond the model; none if the point is outside of a box around
  /// the model.
  std::optional<AxisRay> ray_from(const Vec3& point) const;
  /// The ray from a point in a given direction, where the point is known up to `off` in each coordinate; none if it is
  /// outside of that box.
  std::optional<AxisRay> ray_along(const Vec3& point, double off, std::size_t axis, bool is_upward) const;

 private:
  /// How far the box around the model reaches from its center along each axis of the world.
  Vec3 half_box() const;
  AxisRay ray(const Vec3& point, const simd::QueryPoint& in, std::size_t axis, bool is_upward) const;

  const bvh::Tree* tree_;
  MeshView mesh_;
  Transform pose_;
  Mat3 to_frame_;  // the inverse rotation
  double magnitude_;
  Vec3 center_;          // of the root's sphere, in the model's frame
  double far_distance_;  // points farther from it are far
};

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scene/world_bounds.h"

#include "base/access.h"
#include "bvh/tree.h"

namespace limber::scene {
namespace {

// At most so many vertices are looked at one by one; where there are more, the children of so many nodes.
constexpr std::size_t most_vertices = 2048;
constexpr std::uint32_t most_nodes = 32;

/// At least the distance, in units, from a point of everything in a slot, without slack: by its sphere, box and slab.
double farthest_in(const bvh::Node& node, std::uint32_t slot, const Vec3& origin_from_point) {
  const bvh::ChildBounds& n = node.bounds;
  const Vec3 d = origin_from_point + bvh::local_slot_center(node, slot);
  const bvh::Reach reach = bvh::reach_of(n, slot, d);
  const Vec3 corner = abs(d) + Vec3{n.half_x[slot], n.half_y[slot], n.half_z[slot]};
  return std::min({reach.by_sphere, length(corner), reach.by_slab});
}

/// The largest distance of a vertex from a point.
double farthest_vertex(const Mesh& mesh, double unit, const Vec3& point) {
  double farthest_sq = 0;  // in units, in which squares are normal numbers
  for (const Vec3& p : mesh.positions()) farthest_sq = std::max(farthest_sq, length_sq((p - point) * (1 / unit)));
  return std::sqrt(farthest_sq) * unit;
}

/// At least the distance from a point of everything in a tree, without slack. The root's own radius is that of a sphere
/// around the volumes of its children, a third too large for a ball; volumes further down follow a surface closely.
double farthest_node(const bvh::Tree& tree, const Vec3& point) {
  std::size_t level = 0;
  while (level + 2 < tree.level_begin.size() &&
         tree.level_begin[level + 2] - tree.level_begin[level + 1] <= most_nodes) {
    ++level;
  }
  double radius = 0;  // in units, in which squares are normal numbers
  for (std::uint32_t i = tree.level_begin[level]; i < tree.level_begin[level + 1]; ++i) {
    const bvh::Node& node = tree.nodes[i];
    const Vec3 from_point = (node.origin - point) * (1 / tree.unit);
    for (std::uint32_t slot = 0; slot < node.child_count; ++slot) {
      radius = std::max(radius, farthest_in(node, slot, from_point));
    }
  }
  return radius * tree.unit;
}

}  // namespace

LocalBounds local_bounds(const Body& body) {
  const Model& model = body.model();
  const bvh::Tree& tree = Access::impl(model).tree;
  const Box box = model.bounding_box();
  const Sphere sphere = model.bounding_sphere();
  const Vec3 c = sphere.center, c_abs = abs(c);
  const double magnitude = c_abs.x + c_abs.y + c_abs.z + 2 * sphere.radius;
  // Vertices that no triangle names may be anywhere.
  const bool is_small = model.mesh().positions().size() <= most_vertices;
  const double about = is_small ? farthest_vertex(model.mesh(), tree.unit, c) : farthest_node(tree, c) + tree.slack;
  const double enlarged = about * (1 + base::root_error) + base::offset_error * magnitude;
  const double swept = body.radius();
  const Vec3 half = max(box.high - c, c - box.low) + Vec3{swept, swept, swept};
  return {c, half, std::min(sphere.radius, enlarged) + swept, magnitude + 2 * swept};
}

}  // namespace limber::scene

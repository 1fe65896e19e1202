// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Quinlan1994] and the thesis this engine follows: top-down, two equal-count groups that are geometrically
//           apart, spheres around spheres.
// Differs   The split is the median along the longest side of the box around the leaves' centers, ties broken by
//           triangle id, so the tree does not depend on the standard library's selection order. Nodes are laid out
//           breadth-first.
#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

#include "base/check.h"
#include "base/float_environment.h"
#include "classic/tree.h"
#include "geometry/primitives.h"

namespace limber::classic {
namespace {

std::size_t longest_axis(std::span<const TriangleId> group, const std::vector<Vec3>& centers) {
  Vec3 low = centers[group.front()], high = low;
  for (const TriangleId t : group) {
    low = min(low, centers[t]);
    high = max(high, centers[t]);
  }
  const Vec3 side = high - low;
  return side.x >= side.y ? (side.x >= side.z ? 0 : 2) : (side.y >= side.z ? 1 : 2);
}

/// Orders the group so that its first half lies before the second along the longest axis; returns the half's size.
std::size_t split(std::span<TriangleId> group, const std::vector<Vec3>& centers) {
  LIMBER_ASSERT(group.size() >= 2);
  const std::size_t axis = longest_axis(group, centers);
  const std::size_t half = (group.size() + 1) / 2;
  std::nth_element(
      group.begin(), group.begin() + static_cast<std::ptrdiff_t>(half), group.end(),
      [&](TriangleId s, TriangleId t) { return std::pair(centers[s][axis], s) < std::pair(centers[t][axis], t); });
  return half;
}

void build_nodes(Tree& tree) {
  const std::size_t count = tree.mesh.triangles().size();
  std::vector<Vec3> centers(count);
  for (TriangleId t = 0; t < count; ++t) centers[t] = geometry::enclosing_sphere(tree.mesh.triangle(t)).center;
  std::vector<TriangleId> order(count);
  std::iota(order.begin(), order.end(), TriangleId{0});

  std::vector<std::span<TriangleId>> group_of{order};  // by node
  tree.nodes.reserve(2 * count - 1);
  group_of.reserve(2 * count - 1);
  tree.nodes.push_back({{}, no_id, no_id, no_id, 0});
  tree.leaf_of.resize(count);
  for (std::uint32_t n = 0; n < tree.nodes.size(); ++n) {
    const std::span<TriangleId> group = group_of[n];
    if (group.size() == 1) {
      tree.nodes[n].triangle = group.front();
      tree.leaf_of[group.front()] = n;
      continue;
    }
    const std::size_t half = split(group, centers);
    tree.nodes[n].first_child = static_cast<std::uint32_t>(tree.nodes.size());
    for (const auto part : {group.first(half), group.subspan(half)}) {
      tree.nodes.push_back({{}, n, no_id, no_id, tree.nodes[n].depth + 1});
      group_of.push_back(part);
    }
  }
  LIMBER_ASSERT(tree.nodes.size() == 2 * count - 1);
}

void list_triangles_at_vertices(Tree& tree) {
  tree.first_triangle_at.assign(tree.mesh.positions().size() + 1, 0);
  for (const Corners& corners : tree.mesh.triangles()) {
    for (const VertexId v : corners) ++tree.first_triangle_at[v + 1];
  }
  std::partial_sum(tree.first_triangle_at.begin(), tree.first_triangle_at.end(), tree.first_triangle_at.begin());
  tree.triangles_at.resize(tree.first_triangle_at.back());
  LIMBER_ASSERT(tree.triangles_at.size() == 3 * tree.mesh.triangles().size());
  std::vector<std::uint32_t> next = tree.first_triangle_at;
  for (TriangleId t = 0; t < tree.mesh.triangles().size(); ++t) {
    for (const VertexId v : tree.mesh.triangles()[t]) tree.triangles_at[next[v]++] = t;
  }
}

/// Reserves what updates list, so that they never allocate.
void make_room_for_repairs(Tree& tree) {
  const bool at_once = tree.options.maintenance == Maintenance::immediate;
  if (!at_once) tree.changed_triangles.reserve(tree.mesh.triangles().size());
  tree.queue_at_depth.resize(tree.nodes.back().depth + 1);
  if (tree.options.maintenance != Maintenance::by_depth) return;
  std::vector<std::size_t> count_at_depth(tree.queue_at_depth.size());
  for (const Node& node : tree.nodes) ++count_at_depth[node.depth];
  for (std::size_t depth = 0; depth < count_at_depth.size(); ++depth) {
    tree.queue_at_depth[depth].reserve(count_at_depth[depth]);
  }
}

}  // namespace

Sphere tight_sphere(const Tree& tree, const Node& node) {
  if (node.is_leaf()) return geometry::enclosing_sphere(tree.mesh.triangle(node.triangle));
  return geometry::enclosing_sphere(tree.nodes[node.first_child].sphere, tree.nodes[node.first_child + 1].sphere);
}

bool sphere_holds(const Tree& tree, const Node& node) {
  if (node.is_leaf()) return geometry::contains(node.sphere, tree.mesh.triangle(node.triangle));
  return geometry::contains(node.sphere, tree.nodes[node.first_child].sphere) &&
         geometry::contains(node.sphere, tree.nodes[node.first_child + 1].sphere);
}

Sphere with_extra_radius(Sphere tight, const Looseness& looseness) {
  tight.radius *= 1 + looseness.extra_radius;  // monotone in rounding: never below the tight radius
  return tight;
}

Tree::Tree(Mesh mesh_to_own, const ModelOptions& model_options) : mesh(std::move(mesh_to_own)), options(model_options) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::classic::Model: the mesh has been moved from");
  LIMBER_REQUIRE(options.looseness.extra_radius >= 0 && options.looseness.extra_radius <= 100,
                 "limber::classic::Model: options.looseness.extra_radius is not between 0 and 100");
  LIMBER_REQUIRE(options.looseness.stale_ratio >= 1 && options.looseness.stale_ratio <= 1e6,
                 "limber::classic::Model: options.looseness.stale_ratio is not between 1 and 1e6");
  build_nodes(*this);
  list_triangles_at_vertices(*this);
  is_changed.assign(mesh.triangles().size(), 0);
  is_queued.assign(nodes.size(), 0);
  make_room_for_repairs(*this);
  for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
    node->sphere = with_extra_radius(tight_sphere(*this, *node), options.looseness);
  }
}

}  // namespace limber::classic

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Quinlan1994] and the thesis that limber follows: top-down, two equal-count groups that are geometrically
//           apart, spheres around spheres; propagation to the root, at once, batched, or ordered by depth; loose
//           spheres.
// Differs   The split is the median along the longest side of the box around the leaves' centers, ties broken by
//           triangle id, so the tree does not depend on the standard library's selection order. The queue ordered by
//           depth is one list per level instead of a heap, which costs O(1) per node. A loose sphere is also recomputed
//           when it has become much larger than needed, because otherwise a shrinking model would keep its largest
//           spheres for ever.
#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "base/check.h"
#include "base/rounding.h"
#include "reference/classic/classic.h"

namespace limber::classic {
namespace {

// Radii are computed from the center as stored, and rounded up, so an inaccurate center (slivers, nearly concentric
// spheres) costs tightness at most.
double radius_around(const Vec3& center, const Triangle& t) {
  return std::max({base::distance_up(center, t.v0), base::distance_up(center, t.v1), base::distance_up(center, t.v2)});
}

double radius_around(const Vec3& center, const Sphere& s) {
  return add_up(base::distance_up(center, s.center), s.radius);
}

/// Center of the smallest sphere: the middle of the longest edge where the angle opposite to it is right or obtuse,
/// else the circumcenter. Edges are divided by the longest first, so that no product overflows or underflows.
Vec3 center_of(const Triangle& t) {
  // Rotate the corners so that (a, b) is the longest edge.
  const double l01 = base::distance_up(t.v0, t.v1);
  const double l12 = base::distance_up(t.v1, t.v2);
  const double l20 = base::distance_up(t.v2, t.v0);
  const double longest = std::max({l01, l12, l20});
  if (longest == 0) return t.v0;
  const Vec3& a = longest == l01 ? t.v0 : longest == l12 ? t.v1 : t.v2;
  const Vec3& b = longest == l01 ? t.v1 : longest == l12 ? t.v2 : t.v0;
  const Vec3& c = longest == l01 ? t.v2 : longest == l12 ? t.v0 : t.v1;

  const Vec3 to_a = (a - c) * (1 / longest);
  const Vec3 to_b = (b - c) * (1 / longest);
  const Vec3 n = cross(to_a, to_b);
  const double n_sq = length_sq(n);
  const bool acute = dot(to_a, to_b) > 0;
  // Below 2^-100 the middle is as good: c is within 2^-50 of an end.
  if (!acute || n_sq < 0x1p-100) return a + (b - a) * 0.5;
  const Vec3 offset = (length_sq(to_a) * cross(to_b, n) + length_sq(to_b) * cross(n, to_a)) * (0.5 / n_sq);
  return c + offset * longest;
}

Sphere enclosing_sphere(const Triangle& triangle) {
  const Vec3 center = center_of(triangle);
  return {center, radius_around(center, triangle)};
}

/// The smallest sphere around two.
Sphere enclosing_sphere(const Sphere& a, const Sphere& b) {
  LIMBER_ASSERT(a.radius >= 0 && b.radius >= 0);
  const Sphere& larger = a.radius >= b.radius ? a : b;
  const Sphere& smaller = a.radius >= b.radius ? b : a;
  const double gap = base::distance_up(larger.center, smaller.center);
  Vec3 center = larger.center;
  if (gap > larger.radius - smaller.radius) {
    const double shift = 0.5 * ((gap - larger.radius) + smaller.radius);  // from the larger center to the new one
    center += (smaller.center - larger.center) * std::clamp(shift / gap, 0.0, 1.0);
  }
  return {center, std::max(radius_around(center, a), radius_around(center, b))};
}

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
  for (TriangleId t = 0; t < count; ++t) centers[t] = enclosing_sphere(tree.mesh.triangle(t)).center;
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

/// The sphere a node would be given now, without extra radius.
Sphere tight_sphere(const Tree& tree, const Node& node) {
  if (node.is_leaf()) return enclosing_sphere(tree.mesh.triangle(node.triangle));
  return enclosing_sphere(tree.nodes[node.first_child].sphere, tree.nodes[node.first_child + 1].sphere);
}

/// Whether a node's sphere contains its triangle or both children's spheres, judged so that rounding can only say no.
bool sphere_holds(const Tree& tree, const Node& node) {
  const auto& [center, radius] = node.sphere;
  if (node.is_leaf()) return radius_around(center, tree.mesh.triangle(node.triangle)) <= radius;
  return radius_around(center, tree.nodes[node.first_child].sphere) <= radius &&
         radius_around(center, tree.nodes[node.first_child + 1].sphere) <= radius;
}

Sphere with_extra_radius(Sphere tight, const Looseness& looseness) {
  tight.radius *= 1 + looseness.extra_radius;  // monotone in rounding: never below the tight radius
  return tight;
}

/// Repairs one node; false when its loose sphere absorbed the change, so that nothing above it needs repair.
bool refit(Tree& tree, Node& node) {
  const Looseness& looseness = tree.options.looseness;
  const Sphere fresh = with_extra_radius(tight_sphere(tree, node), looseness);
  if (looseness.extra_radius > 0 && node.sphere.radius <= looseness.stale_ratio * fresh.radius &&
      sphere_holds(tree, node)) {
    ++tree.stats.absorbed;
    return false;
  }
  node.sphere = fresh;
  LIMBER_ASSERT(sphere_holds(tree, node));
  ++tree.stats.refits;
  return true;
}

/// Repairs the path from a triangle's leaf up to the root, or to the first sphere that absorbs the change.
void refit_path(Tree& tree, TriangleId triangle) {
  LIMBER_ASSERT(triangle < tree.leaf_of.size());
  for (std::uint32_t n = tree.leaf_of[triangle]; n != no_id; n = tree.nodes[n].parent) {
    if (!refit(tree, tree.nodes[n])) return;
  }
}

void enqueue(Tree& tree, std::uint32_t n) {
  LIMBER_ASSERT(n < tree.nodes.size());
  if (tree.is_queued[n] != 0) return;
  tree.is_queued[n] = 1;
  tree.queue_at_depth[tree.nodes[n].depth].push_back(n);
}

/// Repairs every node above a changed triangle once, deepest first.
void refit_by_depth(Tree& tree) {
  for (const TriangleId t : tree.changed_triangles) enqueue(tree, tree.leaf_of[t]);
  for (std::size_t depth = tree.queue_at_depth.size(); depth-- > 0;) {
    for (const std::uint32_t n : tree.queue_at_depth[depth]) {
      tree.is_queued[n] = 0;
      if (refit(tree, tree.nodes[n]) && n != root) enqueue(tree, tree.nodes[n].parent);
    }
    tree.queue_at_depth[depth].clear();
  }
}

bool links_are_valid(const Tree& tree, std::uint32_t n) {
  const Node& node = tree.nodes[n];
  if (node.is_leaf()) return node.first_child == no_id && tree.leaf_of[node.triangle] == n;
  if (node.first_child <= n || std::size_t{node.first_child} + 1 >= tree.nodes.size()) return false;
  for (const std::uint32_t child : {node.first_child, node.first_child + 1}) {
    if (tree.nodes[child].parent != n || tree.nodes[child].depth != node.depth + 1) return false;
  }
  return true;
}

Error broken(const char* what, std::size_t node) {
  return {ErrorCode::broken_invariant, "node " + std::to_string(node) + ": " + what, node};
}

}  // namespace

Model::Model(Mesh mesh, const ModelOptions& options) : tree_(std::move(mesh), options) {
  build_nodes(tree_);
  list_triangles_at_vertices(tree_);
  tree_.is_changed.assign(tree_.mesh.triangles().size(), 0);
  tree_.is_queued.assign(tree_.nodes.size(), 0);
  tree_.queue_at_depth.resize(tree_.nodes.back().depth + 1);
  for (auto node = tree_.nodes.rbegin(); node != tree_.nodes.rend(); ++node) {
    node->sphere = with_extra_radius(tight_sphere(tree_, *node), options.looseness);
  }
}

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  LIMBER_ASSERT(ids.size() == positions.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (auto moved = tree_.mesh.set_position(ids[i], positions[i]); !moved) return moved;
    ++tree_.stats.moved_vertices;
    for (std::uint32_t k = tree_.first_triangle_at[ids[i]]; k < tree_.first_triangle_at[ids[i] + 1]; ++k) {
      const TriangleId t = tree_.triangles_at[k];
      if (tree_.options.maintenance == Maintenance::immediate) {
        refit_path(tree_, t);
      } else if (tree_.is_changed[t] == 0) {
        tree_.is_changed[t] = 1;
        tree_.changed_triangles.push_back(t);
      }
    }
  }
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  std::vector<VertexId> ids(positions.size());
  std::iota(ids.begin(), ids.end(), VertexId{0});
  return move_vertices(ids, positions);
}

void Model::commit() {
  if (tree_.options.maintenance == Maintenance::by_depth) {
    refit_by_depth(tree_);
  } else {
    for (const TriangleId t : tree_.changed_triangles) refit_path(tree_, t);
  }
  for (const TriangleId t : tree_.changed_triangles) tree_.is_changed[t] = 0;
  tree_.changed_triangles.clear();
}

Result<void> Model::validate() const {
  const std::size_t count = tree_.mesh.triangles().size();
  if (tree_.nodes.size() != 2 * count - 1 || tree_.nodes[root].parent != no_id) return broken("is no root", root);
  for (std::uint32_t n = 0; n < tree_.nodes.size(); ++n) {
    if (!links_are_valid(tree_, n)) return broken("is linked wrongly", n);
    if (!sphere_holds(tree_, tree_.nodes[n])) return broken("has too small a sphere", n);
    if (tree_.is_queued[n] != 0) return broken("waits for repair", n);
  }
  const auto balanced_depth = static_cast<std::uint32_t>(std::bit_width(count - 1));  // ceil(log2(count))
  if (tree_.nodes.back().depth != balanced_depth) return broken("is too deep", tree_.nodes.size() - 1);
  if (!is_committed()) return broken("waits for a commit", root);
  return {};
}

}  // namespace limber::classic

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/closed_mesh.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "scenes/scenes.h"

namespace limber::program {
namespace {

/// One corner of each connected part, of which there may be `max_parts` + 1 or more.
std::vector<VertexId> corners_of_parts(MeshView mesh) {
  // Every vertex points to one of its part, and the last of them to itself.
  std::vector<VertexId> next(mesh.positions.size());
  std::iota(next.begin(), next.end(), VertexId{0});
  const auto last_of = [&](VertexId v) {
    while (next[v] != v) v = next[v] = next[next[v]];
    return v;
  };
  for (const Corners& c : mesh.triangles) {
    next[last_of(c[1])] = last_of(c[0]);
    next[last_of(c[2])] = last_of(c[0]);
  }
  std::vector<VertexId> corners;
  for (const Corners& c : mesh.triangles) {
    if (corners.size() > max_parts) break;
    const VertexId last = last_of(c[0]);
    if (std::find(corners.begin(), corners.end(), last) == corners.end()) corners.push_back(last);
  }
  return corners;
}

/// How often a segment crosses a mesh; empty where it meets the border of a triangle, so that crossings say nothing.
std::optional<std::size_t> count_crossings(const Segment& segment, MeshView mesh) {
  std::size_t count = 0;
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    if (!intersects(segment, triangle)) continue;
    const auto passes_edge = [&](std::size_t i) {
      return orient3d(segment.p0, segment.p1, triangle[i], triangle[(i + 1) % 3]) == 0;
    };
    if (passes_edge(0) || passes_edge(1) || passes_edge(2)) return std::nullopt;
    ++count;
  }
  return count;
}

/// Pre: the point is not on the mesh, and 9 `size` away from it along any axis no triangle is left.
bool is_inside(const Vec3& point, MeshView mesh, double size) {
  constexpr int max_rays = 32;  // a ray at random meets a border once in a long time
  scenes::Rng rng(1);
  for (int i = 0; i < max_rays; ++i) {
    const Vec3 direction = scenes::random_rotation(rng).row0;
    const auto crossings = count_crossings({point, point + (16 * size) * direction}, mesh);
    if (crossings) return *crossings % 2 == 1;
  }
  return false;
}

}  // namespace

EdgeCounts count_edges(MeshView mesh) {
  using Edge = std::pair<VertexId, VertexId>;
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Corners& c : mesh.triangles) {
    std::array<Edge, 3> own = {std::minmax(c[0], c[1]), std::minmax(c[1], c[2]), std::minmax(c[2], c[0])};
    std::sort(own.begin(), own.end());
    const auto end = std::unique(own.begin(), own.end());
    std::copy_if(own.begin(), end, std::back_inserter(edges), [](const Edge& e) { return e.first != e.second; });
  }
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last = std::find_if(first, edges.end(), [first](const Edge& e) { return e != *first; });
    ++(last - first == 1 ? counts.open : last - first == 2 ? counts.closed : counts.non_manifold);
    first = last;
  }
  return counts;
}

Box box_of(MeshView mesh) {
  const Vec3& first = mesh.positions[mesh.triangles.front()[0]];
  Box box{first, first};
  for (const Corners& corners : mesh.triangles) {
    for (const VertexId v : corners) {
      box.low = min(box.low, mesh.positions[v]);
      box.high = max(box.high, mesh.positions[v]);
    }
  }
  return box;
}

bool is_in_box(MeshView mesh, const Transform& box_from_mesh, const Box& box) {
  return std::all_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Corners& corners) {
    return std::all_of(corners.begin(), corners.end(), [&](VertexId v) {
      const Vec3 p = box_from_mesh(mesh.positions[v]);
      return min(box.low, p) == box.low && max(box.high, p) == box.high;
    });
  });
}

bool lies_inside(MeshView inner, const Transform& inner_pose, MeshView outer, const Transform& outer_pose) {
  const std::vector<VertexId> corners = corners_of_parts(inner);
  if (corners.size() > max_parts) return false;
  std::vector<Vec3> positions(outer.positions.size());
  std::transform(outer.positions.begin(), outer.positions.end(), positions.begin(), outer_pose);
  const MeshView placed{positions, outer.triangles};
  const Box box = box_of(placed);
  const double size = max_abs(box.high - box.low);
  return std::all_of(corners.begin(), corners.end(),
                     [&](VertexId v) { return is_inside(inner_pose(inner.positions[v]), placed, size); });
}

}  // namespace limber::program

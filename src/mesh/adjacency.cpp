// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/adjacency.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/contacts.h"
#include "limber/elements.h"

namespace limber {
namespace {

/// Which triangles each vertex belongs to.
mesh::VertexLists<TriangleId> triangles_of_vertices(const Mesh& mesh) {
  return {mesh.positions().size(), [&](const auto& add) {
            for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
              for (const VertexId v : mesh.triangles()[t]) add(v, t);
            }
          }};
}

/// Breadth-first searches over the vertices of a mesh. Each begins at the corners of one triangle, and marks what it
/// has seen with the id of that triangle. So nothing has to be cleared before the next search.
class RingSearch {
 public:
  explicit RingSearch(const Mesh& mesh)
      : mesh_(mesh),
        triangles_of_(triangles_of_vertices(mesh)),
        vertex_seen_by_(mesh.positions().size(), no_id),
        triangle_seen_by_(mesh.triangles().size(), no_id) {}

  /// Appends, in ascending order, the triangles that are near `from` and have larger ids. A triangle is near if one of
  /// its vertices is at most `max_edges` edges away from a corner of `from`.
  void append_larger_near(TriangleId from, std::uint32_t max_edges, std::vector<TriangleId>& near) {
    LIMBER_ASSERT(from < mesh_.triangles().size());
    const std::size_t first = near.size();
    next_.clear();
    triangle_seen_by_[from] = from;
    see_vertices_of(from, from);
    for (std::uint32_t edges = 0;; ++edges) {  // the distance of ring_ from `from`
      std::swap(ring_, next_);
      next_.clear();
      for (const VertexId v : ring_) {
        for (const TriangleId t : triangles_of_.of(v)) {
          if (triangle_seen_by_[t] == from) continue;
          triangle_seen_by_[t] = from;
          if (t > from) near.push_back(t);
          see_vertices_of(t, from);
        }
      }
      if (edges == max_edges || next_.empty()) break;
    }
    std::sort(near.begin() + static_cast<std::ptrdiff_t>(first), near.end());
  }

 private:
  void see_vertices_of(TriangleId t, TriangleId from) {
    for (const VertexId v : mesh_.triangles()[t]) {
      if (vertex_seen_by_[v] == from) continue;
      vertex_seen_by_[v] = from;
      next_.push_back(v);
    }
  }

  const Mesh& mesh_;
  const mesh::VertexLists<TriangleId> triangles_of_;
  std::vector<TriangleId> vertex_seen_by_, triangle_seen_by_;  // the id of the last search that saw each
  std::vector<VertexId> ring_, next_;  // vertices at one number of edges from the search's triangle; at one edge more
};

}  // namespace

MeshEdges::MeshEdges(const Mesh& mesh)
    : of_triangles_(mesh.triangles().size()),
      vertex_representatives_(mesh.positions().size(), no_id),
      represented_(mesh.triangles().size()) {
  const std::vector<Corners>& triangles = mesh.triangles();
  LIMBER_REQUIRE(triangles.size() <= std::numeric_limits<EdgeId>::max() / 3,
                 "limber::Model::edges: the mesh has more edges than ids can count");
  vertices_.reserve(triangles.size() * 3 / 2), representatives_.reserve(triangles.size() * 3 / 2);
  for (std::array<EdgeId, 3>& edges : of_triangles_) edges.fill(no_id);
  mesh::for_each_edge(triangles, vertex_count(), [&](VertexId low, std::span<const mesh::TriangleSide> sides) {
    const mesh::TriangleSide& first = sides.front();
    if (low == first.high) return;
    for (const mesh::TriangleSide& side : sides) {
      of_triangles_[side.triangle][side.corner] = static_cast<EdgeId>(vertices_.size());
    }
    vertices_.push_back({low, first.high}), representatives_.push_back(first.triangle);
    represented_[first.triangle] = static_cast<std::uint8_t>(represented_[first.triangle] | 8U << first.corner);
  });
  for (TriangleId t = 0; t < triangles.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      TriangleId& representative = vertex_representatives_[triangles[t][k]];
      if (representative != no_id) continue;
      representative = t;
      represented_[t] = static_cast<std::uint8_t>(represented_[t] | 1U << k);
    }
  }
  LIMBER_ASSERT(vertices_.size() == representatives_.size());
}

// NeighborRings lists for each triangle, the sorted list of near triangles with larger ids.
// These say all, because a triangle is near another if and only if the other is near it.

NeighborRings::NeighborRings(const Mesh& mesh, std::uint32_t max_edges) {
  // Only a mesh after std::move has no triangles.
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::NeighborRings: the mesh has been moved from");
  RingSearch search(mesh);
  begin_.reserve(mesh.triangles().size() + 1);
  begin_.push_back(0);
  std::vector<TriangleId> near;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    search.append_larger_near(t, max_edges, near);
    begin_.push_back(near.size());
  }
  near_.assign(near.begin(), near.end());  // a copy has no spare capacity
}

bool NeighborRings::are_near(TriangleId a, TriangleId b) const {
  LIMBER_REQUIRE(a < triangle_count() && b < triangle_count(), "limber::NeighborRings: the mesh has no such triangle");
  if (a == b) return true;
  const TriangleId smaller = std::min(a, b);
  const std::span<const TriangleId> larger =
      std::span(near_).subspan(begin_[smaller], begin_[smaller + std::size_t{1}] - begin_[smaller]);
  return std::binary_search(larger.begin(), larger.end(), std::max(a, b));
}

namespace mesh {
namespace {

Error not_closed(TriangleId triangle, VertexId low, VertexId high, const std::string& what) {
  return {ErrorCode::not_closed,
          "the surface is not closed: the edge of triangle " + std::to_string(triangle) + " between vertices " +
              std::to_string(low) + " and " + std::to_string(high) + " " + what,
          triangle};
}

/// Names what is wrong with an edge, whose triangles have these sides.
std::string fault_of(std::span<const Corners> triangles, VertexId low, std::span<const TriangleSide> sides) {
  if (low == sides.front().high) return "is a point";
  if (sides.size() == 1) return "belongs to no other triangle";
  if (sides.size() > 2) return "belongs to " + std::to_string(sides.size()) + " triangles";
  const auto is_forward = [&](const TriangleSide& side) { return triangles[side.triangle][side.corner] == low; };
  if (is_forward(sides[0]) == is_forward(sides[1])) {
    return "is run through in the same direction by triangle " + std::to_string(sides[1].triangle);
  }
  return {};
}

}  // namespace

Result<void> check_closed(const Mesh& mesh) {
  TriangleId worst = no_id;
  VertexId worst_low = no_id, worst_high = no_id;
  std::string fault;
  for_each_edge(mesh.triangles(), mesh.positions().size(), [&](VertexId low, std::span<const TriangleSide> sides) {
    if (sides.front().triangle >= worst) return;
    std::string found = fault_of(mesh.triangles(), low, sides);
    if (found.empty()) return;
    worst = sides.front().triangle, worst_low = low, worst_high = sides.front().high;
    fault = std::move(found);
  });
  if (worst != no_id) return not_closed(worst, worst_low, worst_high, fault);
  return {};
}

}  // namespace mesh
}  // namespace limber

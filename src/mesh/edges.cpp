// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "limber/elements.h"
#include "mesh/adjacency.h"

namespace limber {

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

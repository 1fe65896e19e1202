// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <array>
#include <cstdint>
#include <limits>
#include <span>
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

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "base/check.h"
#include "geometry/primitives.h"
#include "limber/elements.h"

namespace limber {
namespace {

/// One side of a triangle: an edge is as many of them as triangles have it.
struct TriangleSide {
  VertexId high;        // the larger vertex id
  std::uint32_t index;  // 3 * triangle + corner
};

}  // namespace

MeshEdges::MeshEdges(const Mesh& mesh)
    : of_triangles_(mesh.triangles().size()),
      vertex_representatives_(mesh.positions().size(), no_id),
      represented_(mesh.triangles().size()) {
  const std::vector<Corners>& triangles = mesh.triangles();
  LIMBER_REQUIRE(triangles.size() <= std::numeric_limits<EdgeId>::max() / 3,
                 "limber::MeshEdges: the mesh has more edges than ids can count");
  // The sides, by their smaller vertex id: those of vertex v begin at begin[v]. Counted one place further on, which
  // leaves them there once all are in place.
  std::vector<std::uint32_t> begin(vertex_count() + 2);
  const auto for_all_sides = [&](const auto& visit) {
    for (TriangleId t = 0; t < triangles.size(); ++t) {
      for (std::uint32_t k = 0; k < 3; ++k) {
        const VertexId v = triangles[t][k], w = triangles[t][geometry::after[k]];
        if (v != w) visit(std::min(v, w), TriangleSide{std::max(v, w), 3 * t + k});
      }
    }
  };
  for_all_sides([&](VertexId low, const TriangleSide&) { ++begin[low + 2]; });
  for (std::size_t v = 2; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<TriangleSide> sides(begin.back());
  for_all_sides([&](VertexId low, const TriangleSide& side) { sides[begin[low + 1]++] = side; });

  vertices_.reserve(sides.size() / 2), representatives_.reserve(sides.size() / 2);
  for (std::array<EdgeId, 3>& edges : of_triangles_) edges.fill(no_id);
  for (VertexId low = 0; low < vertex_count(); ++low) {
    const auto first = sides.begin() + begin[low], last = sides.begin() + begin[low + 1];
    std::sort(first, last, [](const TriangleSide& s, const TriangleSide& t) {
      return s.high != t.high ? s.high < t.high : s.index < t.index;
    });
    for (auto side = first; side != last; ++side) {
      const TriangleId t = side->index / 3;
      const std::uint32_t corner = side->index % 3;
      if (side == first || side->high != (side - 1)->high) {
        vertices_.push_back({low, side->high}), representatives_.push_back(t);
        represented_[t] = static_cast<std::uint8_t>(represented_[t] | 8U << corner);
      }
      of_triangles_[t][corner] = static_cast<EdgeId>(vertices_.size() - 1);
    }
  }
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

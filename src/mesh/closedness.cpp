// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "mesh/closedness.h"

#include <span>
#include <string>
#include <utility>

#include "mesh/adjacency.h"

namespace limber::mesh {
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

}  // namespace limber::mesh

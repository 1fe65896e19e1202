// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/mesh.h"

#include <limits>
#include <string>
#include <utility>

#include "core/check.h"

namespace limber {
namespace {

// Ids and node indices are 32-bit; a binary tree over n triangles has 2 n - 1 nodes.
constexpr std::size_t max_elements = std::size_t{1} << 31;

Error at_vertex(ErrorCode code, std::size_t vertex, const char* what) {
  return {code, "vertex " + std::to_string(vertex) + " " + what, vertex};
}

}  // namespace

Result<void> check_positions(std::span<const Vec3> positions) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    if (!is_finite(positions[v])) return at_vertex(ErrorCode::non_finite, v, "is not finite");
    if (max_abs(positions[v]) > max_coordinate) {
      return at_vertex(ErrorCode::too_large, v, "has a coordinate above the limit of 2^200");
    }
  }
  return {};
}

Result<void> check_mesh(MeshView mesh) {
  if (mesh.triangles.empty()) return Error{ErrorCode::empty_mesh, "the mesh has no triangle", {}};
  if (mesh.positions.size() >= max_elements || mesh.triangles.size() >= max_elements) {
    return Error{ErrorCode::too_large, "the mesh has 2^31 or more vertices or triangles", {}};
  }
  if (auto positions = check_positions(mesh.positions); !positions) return positions;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const VertexId v : mesh.triangles[t]) {
      if (v < mesh.positions.size()) continue;
      return Error{ErrorCode::index_out_of_range,
                   "triangle " + std::to_string(t) + " names vertex " + std::to_string(v) + ", but there are only " +
                       std::to_string(mesh.positions.size()) + " vertices",
                   t};
    }
  }
  return {};
}

Result<Mesh> Mesh::create(std::vector<Vec3> positions, std::vector<Corners> triangles) {
  if (auto sound = check_mesh({positions, triangles}); !sound) return sound.error();
  return Mesh(std::move(positions), std::move(triangles));
}

Mesh::Mesh(std::vector<Vec3> positions, std::vector<Corners> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)) {}

void Mesh::set_position(VertexId id, const Vec3& position) {
  LIMBER_ASSERT(id < positions_.size());
  LIMBER_ASSERT(is_finite(position) && max_abs(position) <= max_coordinate);
  positions_[id] = position;
}

}  // namespace limber

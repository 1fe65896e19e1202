// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "io/gltf_accessors.h"
#include "io/gltf_scene.h"

namespace limber::io {

/// How a primitive joins its corners.
enum class GltfMode : std::uint64_t { triangles = 4, triangle_strip = 5, triangle_fan = 6 };

/// Triangles of a mesh that share one material.
struct GltfPrimitive {
  std::string name;
  GltfMode mode{};
  std::size_t positions = 0;  ///< in GltfMesh::positions
  std::optional<GltfAccessor> indices;
  std::size_t triangle_count = 0;
};

/// A checked mesh of which nothing is read yet. Positions that several primitives use are listed once.
struct GltfMesh {
  std::vector<GltfAccessor> positions;
  std::vector<GltfPrimitive> primitives;
  std::uint64_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
};

/// Checks the meshes of a file, each when it is first asked for. Errors as in gltf_json.h.
class GltfMeshes {
 public:
  GltfMeshes(const JsonItem& description, GltfBuffers& buffers)
      : description_(description), accessors_(description, buffers) {}

  const GltfMesh& mesh(std::uint64_t index, const JsonItem& user);

 private:
  GltfMesh check(const JsonItem& mesh);
  /// Adds a primitive that holds triangles.
  void add(const JsonItem& primitive, GltfMesh& mesh, std::map<std::uint64_t, std::size_t>& known_positions);

  const JsonItem& description_;
  GltfAccessors accessors_;
  std::map<std::uint64_t, GltfMesh> checked_;
};

/// Appends a mesh as its node places it. Memory for it has been reserved.
///
/// Errors   `index_out_of_range` naming the face, `malformed_file`.
void append(Soup& soup, const GltfMesh& mesh, const AffineMap& world_from_mesh);

}  // namespace limber::io

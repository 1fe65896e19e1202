// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
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
  std::size_t vertices = 0;  ///< in GltfMesh::vertices
  std::optional<GltfAccessor> indices;
  std::size_t triangle_count = 0;
};

/// Vertices of one or several primitives.
struct GltfVertices {
  GltfAccessor positions;
  std::vector<std::uint64_t> influences;  ///< accessors of joints and of their weights, in turn, four for each vertex
};

/// A checked mesh of which nothing is read yet. Vertices that several primitives use are listed once.
struct GltfMesh {
  std::string name;         ///< as in the file
  bool is_morphed = false;  ///< by weights of its own
  std::vector<GltfVertices> vertices;
  std::vector<GltfPrimitive> primitives;
  std::uint64_t vertex_count = 0;
  std::uint64_t triangle_count = 0;
};

/// Checks the meshes of a file, each when it is first asked for, and reads them.
class GltfMeshes {
 public:
  GltfMeshes(const JsonItem& description, GltfBuffers& buffers)
      : description_(description), accessors_(description, buffers) {}

  const GltfMesh& mesh(const MeshInstance& shown);

  /// How often a node shows its mesh: once, or for each instance of EXT_mesh_gpu_instancing.
  std::size_t shown_count(const JsonItem& node) { return instancing(node).count; }

  /// Vertices and triangles, and what is read besides to place them, each time that the mesh is shown.
  double element_count(const MeshInstance& shown);

  /// Appends a mesh as its node shows it, each time as a part. Memory for it has been reserved.
  ///
  /// A triangle is turned over where most of its corners are mirrored. The node's map places all corners; of a node
  /// with a skin, it does not count, and the joints' maps are blended for each.
  /// Errors   `index_out_of_range` naming the face, `malformed_file`.
  void append(Soup& soup, const MeshInstance& shown, const GltfScene& scene);

 private:
  struct Instancing {
    std::array<std::optional<GltfAccessor>, 3> parts;  // translations, rotations, scales
    std::size_t count = 1;
  };

  GltfMesh check(const JsonItem& mesh);
  /// Adds a primitive that holds triangles.
  void add(const JsonItem& primitive, GltfMesh& mesh,
           std::map<std::vector<std::uint64_t>, std::size_t>& known_vertices);
  Instancing instancing(const JsonItem& node);
  std::vector<AffineMap> joint_maps(const JsonItem& node, const GltfScene& scene);
  void append(Soup& soup, const GltfMesh& mesh, const JsonItem& node, const std::vector<AffineMap>& maps);
  /// Returns the orientation of each vertex's map.
  std::vector<float> append_vertices(Soup& soup, const GltfVertices& vertices, const JsonItem& node,
                                     const std::vector<AffineMap>& maps);

  const JsonItem& description_;
  GltfAccessors accessors_;
  std::map<std::uint64_t, GltfMesh> checked_;
};

}  // namespace limber::io

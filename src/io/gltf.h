// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/soup.h"
#include "limber/math.h"

/// The steps of the reader of glTF files: the JSON description, the accessors of buffers, the nodes of a scene, and the
/// meshes that they show.
namespace limber::io {

// --- gltf_json.cpp

using Json = nlohmann::json;

/// Parses a description.
///
/// Errors   `malformed_file` for what is not JSON and for names that an object has twice; `too_large` beyond
///          `mesh_file_limits::gltf_json_depth` or `gltf_json_values`.
Json parse_json(std::string_view text);

/// An object of the description with its name for messages, as "accessor 3"; the whole description has none.
class JsonItem {
 public:
  /// Errors   `malformed_file` unless `json` is an object.
  JsonItem(const Json& json, std::string name);

  const std::string& name() const { return name_; }
  bool has(const char* key) const { return json_->contains(key); }

  /// A whole number >= 0; without a default it must be there.
  std::uint64_t whole(const char* key, std::optional<std::uint64_t> otherwise = {}) const;
  std::string_view text(const char* key, std::optional<std::string_view> otherwise = {}) const;
  bool flag(const char* key, bool otherwise = false) const;
  /// The numbers of a list, `otherwise` when the property is missing.
  ///
  /// Errors   `malformed_file` unless there are `count`, where that is given.
  std::vector<double> numbers(const char* key, std::optional<std::size_t> count = {},
                              std::vector<double> otherwise = {}) const;
  /// The entries of a list, none when the property is missing.
  const Json::array_t& list(const char* key) const;
  JsonItem item(const char* key) const;
  std::optional<JsonItem> extension(const char* name) const;
  /// Entry `index` of a list of objects, named `kind` and index.
  JsonItem item(const char* key, std::uint64_t index, const char* kind, const JsonItem& user) const;

  [[noreturn]] void refuse(const std::string& reason, ErrorCode code = ErrorCode::malformed_file) const;

 private:
  const Json& at(const char* key) const;

  const Json* json_;
  std::string name_;
};

/// A whole number >= 0 that stands in a list of `user`.
std::uint64_t whole_entry(const Json& entry, const JsonItem& user, const char* key);

// --- gltf_accessors.cpp

/// The buffers of a glTF file: the binary chunk, data in the description, and files beside it. Each is read when it is
/// first asked for, and a file that several buffers name is read once.
class GltfBuffers {
 public:
  /// `chunk` is the binary chunk of a .glb file; `max_bytes` bounds the buffer files together. All must outlive this.
  GltfBuffers(const JsonItem& description, std::optional<std::string_view> chunk, const BufferSource& external,
              std::uint64_t max_bytes);

  /// The first `byteLength` bytes of a buffer, which must have as many.
  std::string_view bytes(std::uint64_t index, const JsonItem& user);

  /// How much has been read from files so far.
  std::uint64_t file_bytes() const { return max_bytes_ - bytes_left_; }

 private:
  std::string_view load(const JsonItem& buffer, std::uint64_t index);
  std::string_view load_file(const JsonItem& buffer, std::string_view uri);

  const JsonItem& description_;
  std::optional<std::string_view> chunk_;
  const BufferSource& external_;
  std::uint64_t max_bytes_, bytes_left_;
  std::vector<std::optional<std::string_view>> loaded_;
  std::map<std::uint64_t, std::string> decoded_;           // by index of the buffer
  std::map<std::string, std::string, std::less<>> files_;  // by path
};

/// Elements in a row, or at equal steps, in a buffer.
struct GltfElements {
  std::string_view bytes;   ///< from the first element on
  std::size_t stride = 0;   ///< bytes from one element to the next
  bool is_present = false;  ///< otherwise all elements are zero
};

/// What the elements of an accessor must be. A set of component types has bit i for the type 5120 + i.
struct GltfElementKind {
  const char* what;  ///< in messages
  std::string_view type;
  std::size_t component_count;
  unsigned plain_types, normalized_types;
  bool may_have_stride;
};

namespace gltf_kinds {
inline constexpr unsigned bytes = 1, unsigned_bytes = 2, shorts = 4, unsigned_shorts = 8, unsigned_ints = 32,
                          floats = 64;
inline constexpr unsigned quantized = bytes | unsigned_bytes | shorts | unsigned_shorts;  // KHR_mesh_quantization

inline constexpr GltfElementKind positions = {"positions", "VEC3", 3, quantized | floats, quantized, true};
inline constexpr GltfElementKind indices = {"indices", "SCALAR", 1, unsigned_bytes | unsigned_shorts | unsigned_ints,
                                            0,         false};
inline constexpr GltfElementKind joints = {"joints", "VEC4", 4, unsigned_bytes | unsigned_shorts, 0, true};
inline constexpr GltfElementKind weights = {"weights", "VEC4", 4, floats, unsigned_bytes | unsigned_shorts, true};
inline constexpr GltfElementKind matrices = {"matrices", "MAT4", 16, floats, 0, true};
inline constexpr GltfElementKind vectors = {"vectors", "VEC3", 3, floats, 0, true};
inline constexpr GltfElementKind rotations = {"rotations", "VEC4", 4, floats, bytes | shorts, true};
}  // namespace gltf_kinds

/// A checked accessor: every element it names lies in its buffer view.
struct GltfAccessor {
  std::string name;
  std::size_t count = 0;
  std::size_t component_count = 0, component_bytes = 0;
  std::uint64_t component_type = 0;
  bool is_normalized = false;
  GltfElements elements;

  // Elements that stand in for those of the list above.
  std::size_t sparse_count = 0;
  std::size_t sparse_index_bytes = 0;
  std::string_view sparse_indices, sparse_values;
};

/// Checks accessors as section 5.1 of the glTF 2.0 specification asks, and reads them.
class GltfAccessors {
 public:
  GltfAccessors(const JsonItem& description, GltfBuffers& buffers) : description_(description), buffers_(buffers) {}

  GltfAccessor check(std::uint64_t index, const JsonItem& user, const GltfElementKind& kind);

 private:
  /// `count` elements of `element_bytes`, aligned to `component_bytes`, from the item's `byteOffset` on.
  GltfElements elements(const JsonItem& item, std::uint64_t count, std::size_t element_bytes,
                        std::size_t component_bytes, bool may_have_stride);
  void check_sparse(const JsonItem& accessor, std::size_t element_bytes, GltfAccessor& result);

  const JsonItem& description_;
  GltfBuffers& buffers_;
};

/// The components of all elements, one element after the other.
std::vector<double> read_numbers(const GltfAccessor& accessor);

// --- read_gltf.cpp

/// An affine map; unlike Transform it may scale, shear and mirror.
struct AffineMap {
  Mat3 linear;
  Vec3 translation;
  int orientation = 1;  ///< the sign of the determinant: -1 for a map that mirrors

  Vec3 operator()(const Vec3& p) const { return linear * p + translation; }
};

/// The orientation is the product of theirs, which rounding cannot change.
AffineMap operator*(const AffineMap& a_from_b, const AffineMap& b_from_c);

/// The map of a 4 x 4 matrix by columns. `user` is what has the matrix, for messages.
AffineMap map_of_matrix(std::span<const double> matrix, const JsonItem& user);

/// Scales by s along the axes, turns by q, a quaternion x, y, z, w of any length but zero, then shifts by t.
AffineMap map_of_parts(std::span<const double> t, std::span<const double> q, std::span<const double> s,
                       const JsonItem& user);

/// A mesh as one node shows it.
struct MeshInstance {
  std::uint64_t mesh = 0;
  AffineMap world_from_mesh;
  JsonItem node;
};

/// The default scene of a file, or the first where none is named.
struct GltfScene {
  std::vector<MeshInstance> instances;                    ///< nodes before their children, and these in order
  std::vector<std::optional<AffineMap>> world_from_node;  ///< none for nodes of other scenes; empty without skins
};

/// Nodes that `KHR_node_visibility` hides show no mesh, nor do their children.
///
/// Errors   `malformed_file` unless the nodes are trees and the scene lists roots, each once;
///          `empty_mesh` when there is no scene.
/// Cost     O(number of nodes), without recursion.
GltfScene read_scene(const JsonItem& description);

// --- gltf_meshes.cpp

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

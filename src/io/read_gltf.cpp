// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A glTF file as a whole:
// 1. split() takes it apart: a .gltf file is a JSON description, a .glb file holds one and a binary chunk.
// 2. check_version() and check_extensions() refuse what would be read wrongly.
// 3. read_scene() walks the nodes of one scene, and lists which mesh is shown where.
// 4. read_gltf() counts what is shown, before it takes memory for it and has the meshes appended.
#include "io/gltf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/scan.h"
#include "limber/geometry.h"
#include "limber/io.h"

namespace limber::io {
namespace {

struct GltfContents {
  std::string_view description;
  std::optional<std::string_view> binary_chunk;
};

/// Splits a .glb file: a header, then chunks of a length, a type and that many bytes. Chunks of unknown types are
/// passed over, and so are up to 7 bytes after the last one, too few for another.
GltfContents split_binary(std::string_view file) {
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  constexpr std::string_view json_type = "JSON", binary_type = std::string_view("BIN\0", 4);
  const auto refuse_beyond = [](std::uint64_t promised, std::size_t there) {
    if (promised <= there) return;
    throw malformed("promises " + std::to_string(promised) + " bytes but has " + std::to_string(there));
  };
  if (file.size() < header_bytes + chunk_header_bytes) throw malformed("ends inside its header");
  if (const std::uint64_t version = unsigned_number(file.substr(4, 4)); version != 2) {
    const std::string text = "is a binary glTF file of version " + std::to_string(version);
    throw BadResult({ErrorCode::unsupported_format, text + ", only version 2 is read", {}});
  }
  const std::uint64_t length = unsigned_number(file.substr(8, 4));
  refuse_beyond(length, file.size());
  if (length < header_bytes + chunk_header_bytes) {
    throw malformed("its header promises " + std::to_string(length) + " bytes, which leave no room for a chunk");
  }
  file = file.substr(0, static_cast<std::size_t>(length));

  GltfContents contents;
  std::size_t at = header_bytes;
  for (bool is_first = true; at + chunk_header_bytes <= file.size(); is_first = false) {
    const std::uint64_t chunk_bytes = unsigned_number(file.substr(at, 4));
    const std::string_view type = file.substr(at + 4, 4);
    at += chunk_header_bytes;
    refuse_beyond(at + chunk_bytes, file.size());
    const std::string_view chunk = file.substr(at, static_cast<std::size_t>(chunk_bytes));
    at += static_cast<std::size_t>(chunk_bytes);
    if (is_first != (type == json_type)) throw malformed("its first chunk alone must be JSON");
    if (is_first) contents.description = chunk;
    if (type == binary_type && !contents.binary_chunk) contents.binary_chunk = chunk;
  }
  return contents;
}

GltfContents split(std::string_view file) {
  if (file.starts_with("glTF")) return split_binary(file);
  if (!trimmed(without_byte_order_mark(file)).starts_with('{')) throw malformed("is not a glTF file");
  return {file, {}};
}

void check_version(const JsonItem& description) {
  const JsonItem asset = description.item("asset");
  const bool is_minimum = asset.has("minVersion");
  const char* const key = is_minimum ? "minVersion" : "version";
  const std::string_view version = asset.text(key);
  if (is_minimum ? version == "2.0" : version.starts_with("2.")) return;
  asset.refuse(std::string(key) + " " + in_quotes(version) + " is not read, only version 2.x and minVersion 2.0",
               ErrorCode::unsupported_format);
}

/// Refuses files that require an extension, unless it is read or cannot change where vertices are and how they are
/// joined. An extension that changes the geometry must be required, by its own rules. Only EXT_mesh_gpu_instancing and
/// KHR_node_visibility need not be: they are read wherever a node has them.
void check_extensions(const JsonItem& description) {
  constexpr std::array<std::string_view, 7> harmless = {"KHR_materials_", "KHR_texture_", "KHR_lights_",  "KHR_xmp",
                                                        "EXT_texture_",   "EXT_lights_",  "MSFT_texture_"};
  constexpr std::array<std::string_view, 3> read = {"KHR_mesh_quantization", "EXT_mesh_gpu_instancing",
                                                    "KHR_node_visibility"};
  for (const Json& entry : description.list("extensionsRequired")) {
    if (!entry.is_string()) description.refuse("extensionsRequired holds something that is not a string");
    const std::string_view name = entry.get_ref<const std::string&>();
    if (std::any_of(harmless.begin(), harmless.end(), [&](auto prefix) { return name.starts_with(prefix); })) continue;
    if (std::find(read.begin(), read.end(), name) != read.end()) continue;
    constexpr std::size_t shown_name_length = 80;  // room for a whole name, which words of a file rarely need
    description.refuse("requires the glTF extension " + in_quotes(name, shown_name_length) + ", which is not read",
                       ErrorCode::unsupported_format);
  }
}

/// The children of each node, and last the roots that a scene lists.
///
/// Errors   `malformed_file` where they name no node, or one twice: nodes must be trees, whose roots the scene lists.
std::vector<std::vector<std::size_t>> lists_of_nodes(const JsonItem& description, const JsonItem& scene) {
  constexpr auto none = static_cast<std::size_t>(-1);
  const std::size_t node_count = description.list("nodes").size();
  std::vector<std::vector<std::size_t>> lists(node_count + 1);
  std::vector<std::size_t> listed_by(node_count, none);
  for (std::size_t n = 0; n <= node_count; ++n) {
    const JsonItem user = n < node_count ? description.item("nodes", n, "node", description) : scene;
    const char* const key = n < node_count ? "children" : "nodes";
    for (const Json& entry : user.list(key)) {
      const std::uint64_t index = whole_entry(entry, user, key);
      const JsonItem listed = description.item("nodes", index, "node", user);  // refuses what does not exist
      const std::size_t earlier = std::exchange(listed_by[static_cast<std::size_t>(index)], n);
      if (earlier != none) {
        const std::string name = earlier < node_count ? "node " + std::to_string(earlier) : scene.name();
        listed.refuse("is listed by " + name + " and again by " + user.name() + ", but nodes must form trees");
      }
      lists[n].push_back(static_cast<std::size_t>(index));
    }
  }
  return lists;
}

AffineMap parent_from_node(const JsonItem& node) {
  if (!node.has("matrix")) {
    return map_of_parts(node.numbers("translation", 3, {0, 0, 0}), node.numbers("rotation", 4, {0, 0, 0, 1}),
                        node.numbers("scale", 3, {1, 1, 1}), node);
  }
  if (node.has("translation") || node.has("rotation") || node.has("scale")) {
    node.refuse("has both a matrix and a translation, rotation or scale");
  }
  return map_of_matrix(node.numbers("matrix", 16), node);
}

/// Refuses a scene that would fill the memory. `element_count` counts all that is shown up to this node, which shows
/// `mesh`; `file_bytes` are those of all files that were read.
void check_total(double element_count, std::uint64_t file_bytes, const GltfMesh& mesh, const JsonItem& node) {
  constexpr std::uint64_t most_ids = 0x7fff'ffffU;  // with a factor of 2 below no_id
  const std::uint64_t limit = std::min(
      most_ids, std::max(mesh_file_limits::gltf_elements, mesh_file_limits::gltf_elements_per_byte * file_bytes));
  if (element_count <= static_cast<double>(limit)) return;
  node.refuse("shows a mesh of " + std::to_string(mesh.vertex_count) + " vertices and " +
                  std::to_string(mesh.triangle_count) + " triangles, with which the scene exceeds the limit of " +
                  std::to_string(limit) + " vertices and triangles, counted each time they are shown",
              ErrorCode::too_large);
}

}  // namespace

AffineMap operator*(const AffineMap& a_from_b, const AffineMap& b_from_c) {
  return {a_from_b.linear * b_from_c.linear, a_from_b(b_from_c.translation),
          a_from_b.orientation * b_from_c.orientation};
}

AffineMap map_of_matrix(std::span<const double> m, const JsonItem& user) {
  const Mat3 linear = {{m[0], m[4], m[8]}, {m[1], m[5], m[9]}, {m[2], m[6], m[10]}};
  if (!is_finite(linear.row0) || !is_finite(linear.row1) || !is_finite(linear.row2)) {
    user.refuse("has a matrix that is not finite");
  }
  if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1) user.refuse("the last row of its matrix is not 0 0 0 1");
  return {linear, {m[12], m[13], m[14]}, orient3d({}, linear.row0, linear.row1, linear.row2)};
}

AffineMap map_of_parts(std::span<const double> t, std::span<const double> q, std::span<const double> s,
                       const JsonItem& user) {
  // The matrix of the unit quaternion, with its columns scaled.
  const double norm = std::hypot(std::hypot(q[0], q[1]), std::hypot(q[2], q[3]));
  if (!(norm > 0) || !std::isfinite(norm)) user.refuse("its rotation is not a quaternion of finite length above 0");
  const double x = q[0] / norm, y = q[1] / norm, z = q[2] / norm, w = q[3] / norm;
  int orientation = 1;
  for (const double along_axis : s) orientation *= (along_axis > 0 ? 1 : 0) - (along_axis < 0 ? 1 : 0);
  return {{{s[0] * (1 - 2 * (y * y + z * z)), s[1] * (2 * (x * y - w * z)), s[2] * (2 * (x * z + w * y))},
           {s[0] * (2 * (x * y + w * z)), s[1] * (1 - 2 * (x * x + z * z)), s[2] * (2 * (y * z - w * x))},
           {s[0] * (2 * (x * z - w * y)), s[1] * (2 * (y * z + w * x)), s[2] * (1 - 2 * (x * x + y * y))}},
          {t[0], t[1], t[2]},
          orientation};
}

GltfScene read_scene(const JsonItem& description) {
  if (description.list("scenes").empty()) description.refuse("has no scene", ErrorCode::empty_mesh);
  const JsonItem scene = description.item("scenes", description.whole("scene", 0), "scene", description);
  const auto lists = lists_of_nodes(description, scene);

  // No node is listed twice: the walk meets each at most once, so it ends.
  struct Visit {
    std::size_t node;
    AffineMap world_from_parent;
    bool is_visible;
  };
  std::vector<Visit> open;
  const auto push = [&](const std::vector<std::size_t>& found, const AffineMap& world_from_parent, bool is_visible) {
    for (std::size_t i = found.size(); i-- > 0;) open.push_back({found[i], world_from_parent, is_visible});
  };
  GltfScene result;
  if (description.has("skins")) result.world_from_node.resize(description.list("nodes").size());
  push(lists.back(), {}, true);
  while (!open.empty()) {
    const Visit visit = open.back();
    open.pop_back();
    const JsonItem node = description.item("nodes", visit.node, "node", scene);
    const AffineMap world_from_node = visit.world_from_parent * parent_from_node(node);
    const std::optional<JsonItem> visibility = node.extension("KHR_node_visibility");
    const bool is_visible = visit.is_visible && (!visibility || visibility->flag("visible", true));
    if (is_visible && node.has("mesh")) result.instances.push_back({node.whole("mesh"), world_from_node, node});
    if (!result.world_from_node.empty()) result.world_from_node[visit.node] = world_from_node;
    push(lists[visit.node], world_from_node, is_visible);
  }
  return result;
}

Soup read_gltf(std::string_view file, const BufferSource& external) {
  const GltfContents contents = split(file);
  const Json json = parse_json(contents.description);
  const JsonItem description(json, "");
  check_version(description);
  check_extensions(description);
  const std::uint64_t most_buffer_bytes =  // all files together have the limit of one
      mesh_file_limits::bytes - std::min<std::uint64_t>(mesh_file_limits::bytes, file.size());
  GltfBuffers buffers(description, contents.binary_chunk, external, most_buffer_bytes);
  GltfMeshes meshes(description, buffers);
  const GltfScene scene = read_scene(description);

  // Everything is counted before memory is taken for any of it.
  std::uint64_t vertex_count = 0, triangle_count = 0;
  double element_count = 0;  // a type that does not overflow
  for (const MeshInstance& instance : scene.instances) {
    const GltfMesh& mesh = meshes.mesh(instance);
    const std::size_t shown_count = meshes.shown_count(instance.node);
    // Each of several instances has a transform and a name, which take about as much memory as 4 vertices.
    const double own_count = shown_count == 1 ? 0 : 4;
    element_count += static_cast<double>(shown_count) * (own_count + meshes.element_count(instance));
    check_total(element_count, file.size() + buffers.file_bytes(), mesh, instance.node);
    vertex_count += shown_count * mesh.vertex_count;
    triangle_count += shown_count * mesh.triangle_count;
  }
  Soup soup;
  soup.positions.reserve(static_cast<std::size_t>(vertex_count));
  soup.faces.corners.reserve(3 * static_cast<std::size_t>(triangle_count));
  soup.faces.ends.reserve(static_cast<std::size_t>(triangle_count));
  for (const MeshInstance& instance : scene.instances) meshes.append(soup, instance, scene);
  return soup;
}

}  // namespace limber::io

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "io/gltf_meshes.h"
#include "io/scan.h"
#include "limber/io.h"

namespace limber::io {
namespace {

/// The parts of a .gltf file, which is all description, or of a .glb file.
struct Parts {
  std::string_view description;
  std::optional<std::string_view> binary_chunk;
};

/// Splits a .glb file: a header, then chunks of a length, a type and that many bytes. Unknown chunks are passed over.
Parts split_binary(std::string_view file) {
  constexpr std::size_t header_bytes = 12, chunk_header_bytes = 8;
  constexpr std::string_view json_type = "JSON", binary_type = std::string_view("BIN\0", 4);
  if (file.size() < header_bytes + chunk_header_bytes) throw malformed("ends inside its header");
  const std::uint64_t version = unsigned_number(file.substr(4, 4));
  if (version != 2) {
    throw BadResult({ErrorCode::unsupported_format,
                     "is a binary glTF file of version " + std::to_string(version) + ", only version 2 is read",
                     {}});
  }
  const auto refuse_beyond = [&](std::uint64_t promised, std::size_t there) {
    if (promised <= there) return;
    throw malformed("promises " + std::to_string(promised) + " bytes but has " + std::to_string(there));
  };
  const std::uint64_t length = unsigned_number(file.substr(8, 4));
  refuse_beyond(length, file.size());
  file = file.substr(0, static_cast<std::size_t>(length));

  Parts parts;
  std::size_t at = header_bytes;
  for (bool is_first = true; at + chunk_header_bytes <= file.size(); is_first = false) {
    const std::uint64_t chunk_bytes = unsigned_number(file.substr(at, 4));
    const std::string_view type = file.substr(at + 4, 4);
    at += chunk_header_bytes;
    refuse_beyond(at + chunk_bytes, file.size());
    const std::string_view chunk = file.substr(at, static_cast<std::size_t>(chunk_bytes));
    at += static_cast<std::size_t>(chunk_bytes);
    if (is_first != (type == json_type)) throw malformed("its first chunk alone must be JSON");
    if (is_first) parts.description = chunk;
    if (type == binary_type && !parts.binary_chunk) parts.binary_chunk = chunk;
  }
  return parts;
}

Parts split(std::string_view file) {
  if (file.starts_with("glTF")) return split_binary(file);
  const std::size_t first = std::min(file.find_first_not_of(" \t\r\n\xEF\xBB\xBF"), file.size());
  if (!file.substr(first).starts_with('{')) throw malformed("is not a glTF file");
  return {file, {}};
}

void check_version(const JsonItem& description) {
  const JsonItem asset = description.item("asset");
  const char* const key = asset.has("minVersion") ? "minVersion" : "version";
  const std::string_view version = asset.text(key);
  if (key == std::string_view("minVersion") ? version == "2.0" : version.starts_with("2.")) return;
  asset.refuse(std::string(key) + " " + in_quotes(version) + " is not read, only glTF 2.0",
               ErrorCode::unsupported_format);
}

/// Refuses files that require an extension, unless it is read or cannot change where vertices are and how they are
/// joined. An extension that changes the geometry must be required, by its own rules, except the two of nodes.
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
    constexpr std::size_t shown_name_length = 80;
    description.refuse("requires the glTF extension " + in_quotes(name, shown_name_length) + ", which is not read",
                       ErrorCode::unsupported_format);
  }
}

/// Refuses scenes that would fill the memory.
void check_total(double element_count, std::uint64_t file_bytes, const GltfMesh& mesh, const JsonItem& node) {
  constexpr std::uint64_t most_ids = 0x7fff'ffffU;
  const std::uint64_t limit = std::min(
      most_ids, std::max(mesh_file_limits::gltf_elements, mesh_file_limits::gltf_elements_per_byte * file_bytes));
  if (element_count <= static_cast<double>(limit)) return;
  node.refuse("shows a mesh of " + std::to_string(mesh.vertex_count) + " vertices and " +
                  std::to_string(mesh.triangle_count) + " triangles, with which the scene exceeds the limit of " +
                  std::to_string(limit) + " vertices and triangles, counted each time they are shown",
              ErrorCode::too_large);
}

}  // namespace

Soup read_gltf(std::string_view file, const BufferSource& external) {
  const Parts parts = split(file);
  const Json json = parse_json(parts.description);
  const JsonItem description(json, "");
  check_version(description);
  check_extensions(description);
  GltfBuffers buffers(description, parts.binary_chunk, external,
                      mesh_file_limits::bytes - std::min<std::uint64_t>(mesh_file_limits::bytes, file.size()));
  GltfMeshes meshes(description, buffers);
  const GltfScene scene = read_scene(description);

  // Everything is counted before memory is taken for any of it.
  std::uint64_t vertex_count = 0, triangle_count = 0;
  double element_count = 0;  // a type that does not overflow
  for (const MeshInstance& instance : scene.instances) {
    const GltfMesh& mesh = meshes.mesh(instance);
    const std::size_t shown_count = meshes.shown_count(instance.node);
    const double own_count = shown_count == 1 ? 0 : 4;  // an instance has a transform and a name
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <utility>

#include "base/check.h"

namespace limber::io {
namespace {

/// Corners of triangle `t` in the list of a primitive's indices; section 3.7.2.1 of the glTF 2.0 specification.
std::array<std::size_t, 3> corners_of(GltfMode mode, std::size_t t) {
  switch (mode) {
    case GltfMode::triangles:
      return {3 * t, 3 * t + 1, 3 * t + 2};
    case GltfMode::triangle_strip:
      return {t, t + 1 + t % 2, t + 2 - t % 2};
    case GltfMode::triangle_fan:
      break;
  }
  return {t + 1, t + 2, 0};
}

std::size_t count_triangles(GltfMode mode, std::size_t corner_count, const JsonItem& primitive) {
  const bool is_list = mode == GltfMode::triangles;
  if (is_list ? corner_count % 3 != 0 : corner_count < 3) {
    primitive.refuse(std::to_string(corner_count) + " corners do not make up whole triangles");
  }
  return is_list ? corner_count / 3 : corner_count - 2;
}

/// Whether a node or a mesh has weights of morph targets other than 0.
bool has_weights(const JsonItem& item) {
  const Json::array_t& weights = item.list("weights");
  return std::any_of(weights.begin(), weights.end(), [](const Json& weight) { return weight != 0; });
}

/// The vertex of each corner of a primitive.
std::vector<std::uint32_t> read_corners(const GltfPrimitive& primitive, std::size_t vertex_count,
                                        std::size_t first_face) {
  std::vector<std::uint32_t> corners(primitive.indices ? primitive.indices->count : vertex_count);
  std::iota(corners.begin(), corners.end(), 0U);
  if (!primitive.indices) return corners;
  const std::vector<double> indices = read_numbers(*primitive.indices);
  for (std::size_t i = 0; i < corners.size(); ++i) corners[i] = static_cast<std::uint32_t>(indices[i]);
  const auto restart = static_cast<std::uint32_t>((std::uint64_t{1} << (8 * primitive.indices->component_bytes)) - 1);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    if (corners[i] < vertex_count && corners[i] != restart) continue;
    const std::size_t triangle = primitive.mode == GltfMode::triangles ? i / 3 : i < 2 ? 0 : i - 2;
    const std::string where =
        primitive.name + ": triangle " + std::to_string(triangle) + " names vertex " + std::to_string(corners[i]);
    throw BadResult(
        {ErrorCode::index_out_of_range,
         where + (corners[i] < vertex_count ? ", the largest number of its type, which glTF does not allow"
                                            : ", but there are only " + std::to_string(vertex_count) + " vertices"),
         first_face + triangle});
  }
  return corners;
}

}  // namespace

const GltfMesh& GltfMeshes::mesh(const MeshInstance& shown) {
  auto known = checked_.find(shown.mesh);
  if (known == checked_.end()) {
    known = checked_.emplace(shown.mesh, check(description_.item("meshes", shown.mesh, "mesh", shown.node))).first;
  }
  return known->second;
}

GltfMesh GltfMeshes::check(const JsonItem& mesh) {
  GltfMesh result;
  result.name = mesh.text("name", "");
  result.is_morphed = has_weights(mesh);
  std::map<std::vector<std::uint64_t>, std::size_t> known_vertices;
  const Json::array_t& primitives = mesh.list("primitives");
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const JsonItem primitive(primitives[p], mesh.name() + " primitive " + std::to_string(p));
    const std::uint64_t mode = primitive.whole("mode", static_cast<std::uint64_t>(GltfMode::triangles));
    if (mode > static_cast<std::uint64_t>(GltfMode::triangle_fan)) {
      primitive.refuse("mode " + std::to_string(mode) + " does not exist");
    }
    const bool has_triangles = mode >= static_cast<std::uint64_t>(GltfMode::triangles);  // not points or lines
    if (has_triangles && primitive.item("attributes").has("POSITION")) add(primitive, result, known_vertices);
  }
  return result;
}

void GltfMeshes::add(const JsonItem& primitive, GltfMesh& mesh,
                     std::map<std::vector<std::uint64_t>, std::size_t>& known_vertices) {
  GltfPrimitive result;
  result.name = primitive.name();
  result.mode = GltfMode{primitive.whole("mode", static_cast<std::uint64_t>(GltfMode::triangles))};
  const JsonItem attributes = primitive.item("attributes");
  std::vector<std::uint64_t> accessors = {attributes.whole("POSITION")};
  for (std::string set = "_0"; attributes.has(("JOINTS" + set).c_str());
       set = std::string("_") + std::to_string(accessors.size() / 2)) {
    accessors.push_back(attributes.whole(("JOINTS" + set).c_str()));
    accessors.push_back(attributes.whole(("WEIGHTS" + set).c_str()));
  }
  const auto [known, is_new] = known_vertices.emplace(accessors, mesh.vertices.size());
  result.vertices = known->second;
  if (is_new) {
    mesh.vertices.push_back(
        {accessors_.check(accessors[0], attributes, gltf_kinds::positions), {accessors.begin() + 1, accessors.end()}});
    mesh.vertex_count += mesh.vertices.back().positions.count;
  }
  const GltfAccessor& positions = mesh.vertices[result.vertices].positions;
  std::size_t corner_count = positions.count;
  if (primitive.has("indices")) {
    result.indices = accessors_.check(primitive.whole("indices"), primitive, gltf_kinds::indices);
    corner_count = result.indices->count;
  }
  const bool has_plain_data = positions.elements.is_present && (!result.indices || result.indices->elements.is_present);
  if (!has_plain_data && primitive.extension("KHR_draco_mesh_compression")) {
    primitive.refuse("uses the glTF extension KHR_draco_mesh_compression, which is not read",
                     ErrorCode::unsupported_format);
  }
  result.triangle_count = count_triangles(result.mode, corner_count, primitive);
  mesh.triangle_count += result.triangle_count;
  mesh.primitives.push_back(std::move(result));
}

GltfMeshes::Instancing GltfMeshes::instancing(const JsonItem& node) {
  Instancing result;
  const std::optional<JsonItem> extension = node.extension("EXT_mesh_gpu_instancing");
  if (!extension) return result;
  if (node.has("skin")) node.refuse("has both a skin and EXT_mesh_gpu_instancing");
  const JsonItem attributes = extension->item("attributes");
  std::optional<std::size_t> count;
  const auto add = [&](std::size_t part, const char* key, const GltfElementKind& kind) {
    if (!attributes.has(key)) return;
    result.parts[part] = accessors_.check(attributes.whole(key), attributes, kind);
    if (count.value_or(result.parts[part]->count) != result.parts[part]->count) {
      node.refuse("has instances whose attributes differ in number");
    }
    result.count = *(count = result.parts[part]->count);
  };
  add(0, "TRANSLATION", gltf_kinds::vectors);
  add(1, "ROTATION", gltf_kinds::rotations);
  add(2, "SCALE", gltf_kinds::vectors);
  return result;
}

double GltfMeshes::element_count(const MeshInstance& shown) {
  const GltfMesh& mesh = this->mesh(shown);
  if (shown.node.has("weights") ? has_weights(shown.node) : mesh.is_morphed) {
    shown.node.refuse("shows its mesh with weights of morph targets, which are not read",
                      ErrorCode::unsupported_format);
  }
  constexpr std::size_t name_bytes_of_element = 16;
  const std::size_t name_bytes = std::max(mesh.name.size(), shown.node.text("name", "").size());
  const std::uint64_t counted = mesh.triangle_count + name_bytes / name_bytes_of_element;
  auto count = static_cast<double>(counted);
  const bool is_skinned = shown.node.has("skin");
  for (const GltfVertices& vertices : mesh.vertices) {
    const auto read_count = static_cast<double>(1 + (is_skinned ? 2 * vertices.influences.size() : 0));
    count += read_count * static_cast<double>(vertices.positions.count);
  }
  if (is_skinned) {
    const JsonItem skin = description_.item("skins", shown.node.whole("skin"), "skin", shown.node);
    count += 8 * static_cast<double>(skin.list("joints").size());
  }
  return std::max(count, 1.0);
}

std::vector<AffineMap> GltfMeshes::joint_maps(const JsonItem& node, const GltfScene& scene) {
  const JsonItem skin = description_.item("skins", node.whole("skin"), "skin", node);
  std::vector<AffineMap> maps;
  for (const Json& entry : skin.list("joints")) {
    const std::uint64_t joint = whole_entry(entry, skin, "joints");
    const auto node_of_joint = static_cast<std::size_t>(std::min<std::uint64_t>(joint, scene.world_from_node.size()));
    const bool is_in_scene = node_of_joint < scene.world_from_node.size() && scene.world_from_node[node_of_joint];
    if (!is_in_scene) skin.refuse("its joint node " + std::to_string(joint) + " is not in the scene");
    maps.push_back(*scene.world_from_node[node_of_joint]);
  }
  if (!skin.has("inverseBindMatrices")) return maps;
  GltfAccessor binds = accessors_.check(skin.whole("inverseBindMatrices"), skin, gltf_kinds::matrices);
  if (binds.count < maps.size()) skin.refuse(binds.name + " does not have a matrix for each joint");
  binds.count = maps.size();
  const std::vector<double> matrices = read_numbers(binds);
  for (std::size_t j = 0; j < maps.size(); ++j) {
    maps[j] = maps[j] * map_of_matrix(std::span(matrices).subspan(16 * j, 16), skin);
  }
  return maps;
}

void GltfMeshes::append(Soup& soup, const MeshInstance& shown, const GltfScene& scene) {
  const GltfMesh& mesh = this->mesh(shown);
  if (mesh.triangle_count == 0) return;
  const Instancing instances = instancing(shown.node);
  std::array<std::vector<double>, 3> parts = {{{0, 0, 0}, {0, 0, 0, 1}, {1, 1, 1}}};
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (instances.parts[i]) parts[i] = read_numbers(*instances.parts[i]);
  }
  const auto part = [&](std::size_t i, std::size_t size, std::size_t instance) {
    return std::span(parts[i]).subspan(instances.parts[i] ? size * instance : 0, size);
  };
  std::string name(shown.node.text("name", ""));
  if (name.empty()) name = mesh.name.empty() ? shown.node.name() : mesh.name;
  const bool is_skinned = shown.node.has("skin");
  std::vector<AffineMap> maps = is_skinned ? joint_maps(shown.node, scene) : std::vector<AffineMap>(1);
  for (std::size_t i = 0; i < instances.count; ++i) {
    if (!is_skinned)
      maps[0] = shown.world_from_mesh * map_of_parts(part(0, 3, i), part(1, 4, i), part(2, 3, i), shown.node);
    append(soup, mesh, shown.node, maps);
    soup.part_of_face.resize(soup.faces.size(), static_cast<std::uint32_t>(soup.parts.size()));
    soup.parts.push_back(instances.count == 1 ? name : name + "[" + std::to_string(i) + "]");
  }
}

void GltfMeshes::append(Soup& soup, const GltfMesh& mesh, const JsonItem& node, const std::vector<AffineMap>& maps) {
  LIMBER_ASSERT(soup.positions.capacity() - soup.positions.size() >= mesh.vertex_count);
  LIMBER_ASSERT(soup.faces.ends.capacity() - soup.faces.ends.size() >= mesh.triangle_count);
  std::vector<std::size_t> first_vertices;
  std::vector<std::vector<float>> orientations;
  for (const GltfVertices& vertices : mesh.vertices) {
    first_vertices.push_back(soup.positions.size());
    orientations.push_back(append_vertices(soup, vertices, node, maps));
  }
  for (const GltfPrimitive& primitive : mesh.primitives) {
    const std::vector<float>& orientation = orientations[primitive.vertices];
    const auto corners = read_corners(primitive, orientation.size(), soup.faces.size());
    const auto first_vertex = static_cast<std::uint32_t>(first_vertices[primitive.vertices]);
    for (std::size_t t = 0; t < primitive.triangle_count; ++t) {
      float sum = 0;
      for (const std::size_t corner : corners_of(primitive.mode, t)) {
        LIMBER_ASSERT(corner < corners.size());
        soup.faces.corners.push_back(first_vertex + corners[corner]);
        sum += orientation[corners[corner]];
      }
      if (sum < 0) std::swap(soup.faces.corners.back(), *(soup.faces.corners.end() - 2));
      soup.faces.ends.push_back(soup.faces.corners.size());
    }
  }
}

std::vector<float> GltfMeshes::append_vertices(Soup& soup, const GltfVertices& vertices, const JsonItem& node,
                                               const std::vector<AffineMap>& maps) {
  const std::size_t count = vertices.positions.count;
  const std::vector<double> positions = read_numbers(vertices.positions);
  const auto position = [&](std::size_t v) {
    return Vec3{positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]};
  };
  if (!node.has("skin")) {
    for (std::size_t v = 0; v < count; ++v) soup.positions.push_back(maps[0](position(v)));
    return std::vector<float>(count, static_cast<float>(maps[0].orientation));
  }

  std::vector<std::vector<double>> joints, weights;
  for (const std::uint64_t accessor : vertices.influences) {
    const bool has_joints = joints.size() == weights.size();
    const auto checked = accessors_.check(accessor, node, has_joints ? gltf_kinds::joints : gltf_kinds::weights);
    if (checked.count != count) node.refuse(checked.name + " does not have an element for each vertex of its mesh");
    (has_joints ? joints : weights).push_back(read_numbers(checked));
  }
  std::vector<float> orientations(count);
  for (std::size_t v = 0; v < count; ++v) {
    const auto refuse = [&](const std::string& what) {
      node.refuse("vertex " + std::to_string(v) + " of its mesh " + what);
    };
    double total = 0;
    for (const std::vector<double>& set : weights) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) total += set[i] >= 0 ? set[i] : std::nan("");
    }
    if (!(total > 0)) refuse("has no joint of a weight above 0, or a weight below 0");
    Vec3 sum;
    for (std::size_t s = 0; s < weights.size(); ++s) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
        if (weights[s][i] == 0) continue;
        if (!(joints[s][i] < static_cast<double>(maps.size()))) refuse("names a joint that the skin does not have");
        const AffineMap& map = maps[static_cast<std::size_t>(joints[s][i])];
        sum += weights[s][i] / total * map(position(v));
        orientations[v] += static_cast<float>(weights[s][i] / total * map.orientation);
      }
    }
    soup.positions.push_back(sum);
  }
  return orientations;
}

}  // namespace limber::io

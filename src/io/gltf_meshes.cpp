// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/gltf_meshes.h"

#include <array>
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

/// The vertex of each corner of a primitive.
std::vector<std::uint32_t> read_corners(const GltfPrimitive& primitive, std::size_t vertex_count,
                                        std::size_t first_face) {
  std::vector<std::uint32_t> corners;
  if (!primitive.indices) {
    corners.resize(vertex_count);
    for (std::size_t v = 0; v < vertex_count; ++v) corners[v] = static_cast<std::uint32_t>(v);
    return corners;
  }
  corners = read_indices(*primitive.indices);
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

const GltfMesh& GltfMeshes::mesh(std::uint64_t index, const JsonItem& user) {
  const auto known = checked_.find(index);
  if (known != checked_.end()) return known->second;
  return checked_.emplace(index, check(description_.item("meshes", index, "mesh", user))).first->second;
}

GltfMesh GltfMeshes::check(const JsonItem& mesh) {
  GltfMesh result;
  std::map<std::uint64_t, std::size_t> known_positions;
  const Json::array_t& primitives = mesh.list("primitives");
  for (std::size_t p = 0; p < primitives.size(); ++p) {
    const JsonItem primitive(primitives[p], mesh.name() + " primitive " + std::to_string(p));
    const std::uint64_t mode = primitive.whole("mode", static_cast<std::uint64_t>(GltfMode::triangles));
    if (mode > static_cast<std::uint64_t>(GltfMode::triangle_fan)) {
      primitive.refuse("mode " + std::to_string(mode) + " does not exist");
    }
    const bool has_triangles = mode >= static_cast<std::uint64_t>(GltfMode::triangles);  // not points or lines
    if (has_triangles && primitive.item("attributes").has("POSITION")) add(primitive, result, known_positions);
  }
  return result;
}

void GltfMeshes::add(const JsonItem& primitive, GltfMesh& mesh, std::map<std::uint64_t, std::size_t>& known_positions) {
  GltfPrimitive result;
  result.name = primitive.name();
  result.mode = GltfMode{primitive.whole("mode", static_cast<std::uint64_t>(GltfMode::triangles))};
  const JsonItem attributes = primitive.item("attributes");
  const std::uint64_t accessor = attributes.whole("POSITION");
  const auto [known, is_new] = known_positions.emplace(accessor, mesh.positions.size());
  result.positions = known->second;
  if (is_new) {
    mesh.positions.push_back(accessors_.positions(accessor, attributes));
    mesh.vertex_count += mesh.positions.back().count;
  }
  std::size_t corner_count = mesh.positions[result.positions].count;
  if (primitive.has("indices")) {
    result.indices = accessors_.indices(primitive.whole("indices"), primitive);
    corner_count = result.indices->count;
  }
  const bool has_plain_data =
      mesh.positions[result.positions].elements.is_present && (!result.indices || result.indices->elements.is_present);
  if (!has_plain_data && primitive.has("extensions") &&
      primitive.item("extensions").has("KHR_draco_mesh_compression")) {
    primitive.refuse("uses the glTF extension KHR_draco_mesh_compression, which is not read",
                     ErrorCode::unsupported_format);
  }
  result.triangle_count = count_triangles(result.mode, corner_count, primitive);
  mesh.triangle_count += result.triangle_count;
  mesh.primitives.push_back(std::move(result));
}

void append(Soup& soup, const GltfMesh& mesh, const AffineMap& world_from_mesh) {
  LIMBER_ASSERT(soup.positions.capacity() - soup.positions.size() >= mesh.vertex_count);
  LIMBER_ASSERT(soup.faces.ends.capacity() - soup.faces.ends.size() >= mesh.triangle_count);
  std::vector<std::size_t> first_vertices;
  for (const GltfAccessor& accessor : mesh.positions) {
    first_vertices.push_back(soup.positions.size());
    for (const Vec3& position : read_positions(accessor)) soup.positions.push_back(world_from_mesh(position));
  }
  for (const GltfPrimitive& primitive : mesh.primitives) {
    const std::size_t vertex_count = mesh.positions[primitive.positions].count;
    const auto corners = read_corners(primitive, vertex_count, soup.faces.size());
    const auto first_vertex = static_cast<std::uint32_t>(first_vertices[primitive.positions]);
    for (std::size_t t = 0; t < primitive.triangle_count; ++t) {
      for (const std::size_t corner : corners_of(primitive.mode, t)) {
        LIMBER_ASSERT(corner < corners.size());
        soup.faces.corners.push_back(first_vertex + corners[corner]);
      }
      soup.faces.ends.push_back(soup.faces.corners.size());
    }
  }
}

}  // namespace limber::io

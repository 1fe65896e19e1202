// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/file_parts.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <string_view>
#include <utility>

#include "command/run_files.h"
#include "command/text.h"

namespace limber::program {

bool is_mesh_file(const std::string& path) {
  constexpr std::array<std::string_view, 6> endings = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

std::vector<FilePart> read_file_parts(const std::string& path) {
  const MeshFile whole = value_or_bad_input(read_mesh_file(path, {.parts = true}));
  for (const std::filesystem::path& read : whole.files) add_input(read);
  const MeshView mesh = whole.mesh;
  std::vector<std::vector<TriangleId>> triangles_of(whole.parts.size());
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) triangles_of[whole.part_of_triangle[t]].push_back(t);
  std::vector<std::size_t> named_by(mesh.positions.size(), triangles_of.size());  // the part that named a vertex last
  std::vector<VertexId> number_in_part(mesh.positions.size());
  std::vector<FilePart> parts;
  for (std::size_t part = 0; part < triangles_of.size(); ++part) {
    std::vector<Vec3> positions;
    std::vector<Corners> triangles;
    std::vector<std::uint32_t> faces;
    for (const TriangleId t : triangles_of[part]) {
      Corners corners = mesh.triangles[t];
      for (VertexId& v : corners) {
        if (std::exchange(named_by[v], part) != part) {
          number_in_part[v] = static_cast<VertexId>(positions.size());
          positions.push_back(mesh.positions[v]);
        }
        v = number_in_part[v];
      }
      triangles.push_back(corners);
      faces.push_back(whole.face_of_triangle[t]);
    }
    Mesh own = value_or_bad_input(Mesh::create(std::move(positions), std::move(triangles)));
    MeshFile& file = parts.emplace_back(FilePart{whole.parts[part], {std::move(own), faces, 0, {}, {}, {}, {}}}).file;
    file.face_count = static_cast<std::size_t>(std::unique(faces.begin(), faces.end()) - faces.begin());
  }
  return parts;
}

}  // namespace limber::program

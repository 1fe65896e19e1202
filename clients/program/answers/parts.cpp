// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string_view>
#include <system_error>
#include <utility>

#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv.h"
#include "limber/io.h"
#include "limber/scene.h"

namespace limber::program {
namespace {

/// Whether a file has an extension that read_mesh_file() takes, in capitals or not. Other files are tables.
bool is_mesh_file(const std::string& path) {
  constexpr std::array<std::string_view, 6> extensions = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

/// Adds the parts of one mesh file, such as the nodes of a glTF scene or the objects of an OBJ file, each as a model of
/// its own: with its triangles in the file's order, and faces numbered as in the whole file. Parts without a triangle
/// are left out, such as an object whose faces are lines of two corners.
void add_parts_of_mesh(AskedPairs& asked, const std::string& path) {
  const MeshFile whole = value_or_bad_input(read_mesh_file(path, {.parts = true}));
  for (const std::filesystem::path& read : whole.files) add_input(read);
  const MeshView mesh = whole.mesh;
  std::vector<std::vector<TriangleId>> triangles_of(whole.parts.size());
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) triangles_of[whole.part_of_triangle[t]].push_back(t);
  std::vector<std::size_t> last_part_of_vertex(mesh.positions.size(), triangles_of.size());  // first that of none
  std::vector<VertexId> number_in_part(mesh.positions.size());                               // in that part
  for (std::size_t part = 0; part < triangles_of.size(); ++part) {
    if (triangles_of[part].empty()) continue;
    std::vector<Vec3> positions;
    std::vector<Corners> triangles;
    std::vector<std::uint32_t> faces;
    std::size_t face_count = 0;
    for (const TriangleId t : triangles_of[part]) {
      Corners corners = mesh.triangles[t];
      for (VertexId& v : corners) {
        if (std::exchange(last_part_of_vertex[v], part) != part) {
          number_in_part[v] = static_cast<VertexId>(positions.size());
          positions.push_back(mesh.positions[v]);
        }
        v = number_in_part[v];
      }
      triangles.push_back(corners);
      const std::uint32_t face = whole.face_of_triangle[t];
      if (faces.empty() || faces.back() != face) ++face_count;  // the triangles of a face come one after the other
      faces.push_back(face);
    }
    Mesh own_mesh = value_or_bad_input(Mesh::create(std::move(positions), std::move(triangles)));
    MeshFile own{std::move(own_mesh), std::move(faces), face_count, {}, {}, {}, {}};  // the rest is about whole files
    auto& model = asked.models[fmt::format("part {}", part)] = std::make_unique<RigidModel>(std::move(own));
    const std::string& name = whole.parts[part];
    asked.parts.push_back({name.empty() ? shown_name(path) : name, path, model.get(), {}});
  }
}

/// The key of a model: names of one file, such as a link and its target, have the same key.
std::string key_of(const std::string& argument) {
  if (is_scene(argument)) return argument;
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::weakly_canonical(argument, failed);
  return failed ? argument : path.string();
}

/// Adds the models in the rows of a table, as read_models() has them: for each row one model for each suffix, in turn.
void add_rows(AskedPairs& asked, const std::string& path, const std::vector<std::string>& suffixes) {
  for (const ModelRow& row : read_models(path, suffixes)) {
    std::unique_ptr<RigidModel>& model = asked.models[key_of(row.model)];
    try {
      if (!model) {
        MeshFile file = load_mesh_argument(row.model);
        file.parts.clear();  // rows have no cells for their names
        model = std::make_unique<RigidModel>(std::move(file));
      }
    } catch (const BadInput& error) {
      throw BadInput(fmt::format("{}: line {}: column {}: {}", path, row.line, row.column, error.what()));
    }
    asked.parts.push_back({row.name.empty() ? shown_name(row.model) : row.name, row.model, model.get(), row.pose});
  }
}

}  // namespace

AskedPairs pairs_of_file(const std::string& path) {
  AskedPairs asked;
  add_rows(asked, path, {"_a", "_b"});  // parts are now a and b of the first row, a and b of the second, and so on
  for (std::size_t i = 0; i < asked.parts.size(); i += 2) asked.pairs.push_back({i, i + 1});
  return asked;
}

AskedPairs pairs_of_parts(const std::string& path, double max_distance) {
  AskedPairs asked;
  asked.kind = StudyKind::parts;
  if (is_mesh_file(path)) {
    add_parts_of_mesh(asked, path);
  } else {
    add_rows(asked, path, {""});
  }
  const std::size_t count = asked.parts.size();
  if (count < 2) throw BadInput(path + (count == 0 ? ": has no part" : ": has one part alone, which makes no pair"));
  if (!std::isfinite(max_distance)) {
    for (std::size_t a = 0; a < count; ++a) {
      for (std::size_t b = a + 1; b < count; ++b) asked.pairs.push_back({a, b});
    }
    return asked;
  }
  Scene scene;
  for (std::size_t part = 0; part < count; ++part) {
    const ObjectId id = scene.add({asked.parts[part].model->model(), asked.parts[part].pose});
    if (id != part) throw std::logic_error("the ids of a new scene do not count from 0");
  }
  scene.commit();
  scene.visit_candidate_pairs(max_distance, [&](const ObjectPair& pair) {
    asked.pairs.push_back({pair.a, pair.b});
    return true;
  });
  std::sort(asked.pairs.begin(), asked.pairs.end());
  return asked;
}

std::string shown_name(const std::string& argument) {
  return is_scene(argument) ? argument : std::filesystem::path(argument).filename().string();
}

}  // namespace limber::program

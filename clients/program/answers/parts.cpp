// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "command/run_files.h"
#include "command/text.h"
#include "formats/csv.h"
#include "limber/io.h"
#include "limber/scene.h"

namespace limber::program {
namespace {

/// Whether a name ends as those of mesh files do.
bool is_mesh_file(const std::string& path) {
  constexpr std::array endings = {".obj", ".ply", ".stl", ".off", ".gltf", ".glb"};
  std::string ending = std::filesystem::path(path).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

/// Adds the parts of one mesh file, such as the nodes of a glTF scene or the objects of an OBJ file, as models of their
/// own: their triangles in their order, faces numbered as in the whole file.
void add_parts_of_mesh(AskedPairs& asked, const std::string& path) {
  const MeshFile whole = value_or_bad_input(read_mesh_file(path, {.parts = true}));
  for (const std::filesystem::path& read : whole.files) add_input(read);
  const MeshView mesh = whole.mesh;
  std::vector<std::vector<TriangleId>> triangles_of(whole.parts.size());
  for (TriangleId t = 0; t < mesh.triangles.size(); ++t) triangles_of[whole.part_of_triangle[t]].push_back(t);
  std::vector<std::size_t> named_by(mesh.positions.size(), triangles_of.size());  // the part that named a vertex last
  std::vector<VertexId> number_in_part(mesh.positions.size());
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
    MeshFile own{
        value_or_bad_input(Mesh::create(std::move(positions), std::move(triangles))), faces, 0, {}, {}, {}, {}};
    own.face_count = static_cast<std::size_t>(std::unique(faces.begin(), faces.end()) - faces.begin());
    auto& model = asked.models[fmt::format("part {}", part)] = std::make_unique<RigidModel>(std::move(own));
    const std::string& name = whole.parts[part];
    asked.parts.push_back({name.empty() ? shown_name(path) : name, path, model.get(), {}});
  }
}

/// A key of a model: names of one file, such as a link and its target, have the same key.
std::string key_of(const std::string& argument) {
  if (is_scene(argument)) return argument;
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::weakly_canonical(argument, failed);
  return failed ? argument : path.string();
}

/// Adds the models that stand in the rows of a file.
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
  add_rows(asked, path, {"_a", "_b"});
  for (std::size_t i = 0; i < asked.parts.size(); i += 2) asked.pairs.push_back({i, i + 1});
  return asked;
}

AskedPairs pairs_of_parts(const std::string& path, double max_distance) {
  AskedPairs asked;
  asked.kind = StudyKind::parts;
  is_mesh_file(path) ? add_parts_of_mesh(asked, path) : add_rows(asked, path, {""});
  const std::size_t count = asked.parts.size();
  if (count < 2) throw BadInput(path + ": has one part alone, which makes no pair");
  for (std::size_t a = 0; !std::isfinite(max_distance) && a < count; ++a) {
    for (std::size_t b = a + 1; b < count; ++b) asked.pairs.push_back({a, b});
  }
  if (!asked.pairs.empty()) return asked;
  Scene scene;
  for (const StudyPart& part : asked.parts) static_cast<void>(scene.add({part.model->model(), part.pose}));
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

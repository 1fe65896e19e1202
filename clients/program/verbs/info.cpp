// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "answers/models.h"
#include "command/options.h"
#include "command/output.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/model.h"

namespace limber::program {
namespace {

struct InfoArguments {
  std::string model;
  bool json = false;
};

/// Triangles without area, decided exactly.
std::size_t count_degenerate(const Mesh& mesh) {
  std::size_t count = 0;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle triangle = mesh.triangle(t);
    const auto is_collinear = [&](std::size_t axis) {
      return orient2d(triangle.v0, triangle.v1, triangle.v2, axis) == 0;
    };
    if (is_collinear(0) && is_collinear(1) && is_collinear(2)) ++count;
  }
  return count;
}

/// Triangles with the same corners as an earlier one, in any order.
std::size_t count_duplicates(const Mesh& mesh) {
  std::vector<Corners> sorted = mesh.triangles();
  for (Corners& corners : sorted) std::sort(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  return static_cast<std::size_t>(sorted.end() - std::unique(sorted.begin(), sorted.end()));
}

std::size_t count_unreferenced(const Mesh& mesh) {
  std::vector<bool> is_referenced(mesh.positions().size(), false);
  for (const Corners& corners : mesh.triangles()) {
    for (const VertexId v : corners) is_referenced[v] = true;
  }
  return static_cast<std::size_t>(std::count(is_referenced.begin(), is_referenced.end(), false));
}

/// A part of the file, by itself.
struct PartInfo {
  std::string name;
  std::size_t triangles = 0;
  Box box;
  bool is_closed = false;
};

std::vector<PartInfo> examine_parts(const MeshFile& file) {
  std::vector<std::vector<Corners>> triangles(file.parts.size());
  for (TriangleId t = 0; t < file.part_of_triangle.size(); ++t) {
    triangles[file.part_of_triangle[t]].push_back(file.mesh.triangles()[t]);
  }
  std::vector<PartInfo> parts;
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    const MeshView part{file.mesh.positions(), triangles[p]};
    if (!triangles[p].empty()) {  // faces of fewer than three corners may be all it has
      parts.push_back({file.parts[p], triangles[p].size(), box_of(part), count_edges(part).are_closed()});
    }
  }
  return parts;
}

struct Info {
  std::size_t vertices = 0, triangles = 0, faces = 0;
  Box box;
  EdgeCounts edges;
  std::size_t degenerate = 0, duplicates = 0, unreferenced = 0;
  std::vector<PartInfo> parts;
  TreeStats tree;
  double load_us = 0, build_us = 0;

  double diagonal() const { return length(box.high - box.low); }
  double bytes_per_triangle() const { return static_cast<double>(tree.bytes) / static_cast<double>(triangles); }
};

Info examine(const std::string& argument) {
  const Stopwatch loading;
  MeshFile file = load_mesh_argument(argument);
  const double load_us = loading.microseconds();
  const Mesh& mesh = file.mesh;
  Info info;
  info.vertices = mesh.positions().size();
  info.triangles = mesh.triangles().size();
  info.faces = file.face_count;
  info.box = box_of(mesh);
  info.edges = count_edges(mesh);
  info.parts = examine_parts(file);
  info.degenerate = count_degenerate(mesh);
  info.duplicates = count_duplicates(mesh);
  info.unreferenced = count_unreferenced(mesh);
  const Stopwatch building;
  const Model model(std::move(file.mesh));
  info.build_us = building.microseconds();
  info.load_us = load_us;
  info.tree = model.tree_stats();
  return info;
}

Json as_json(const Info& info) {
  Json parts = Json::array();
  for (const PartInfo& part : info.parts) {
    parts.push_back({{"name", part.name},
                     {"triangles", part.triangles},
                     {"extent", {{"low", to_json(part.box.low)}, {"high", to_json(part.box.high)}}},
                     {"closed", part.is_closed}});
  }
  return {
      {"query", "info"},
      {"vertices", info.vertices},
      {"triangles", info.triangles},
      {"faces", info.faces},
      {"extent", {{"low", to_json(info.box.low)}, {"high", to_json(info.box.high)}, {"diagonal", info.diagonal()}}},
      {"open_edges", info.edges.open},
      {"non_manifold_edges", info.edges.non_manifold},
      {"closed", info.edges.are_closed()},
      {"degenerate_triangles", info.degenerate},
      {"duplicate_triangles", info.duplicates},
      {"unreferenced_vertices", info.unreferenced},
      {"parts", std::move(parts)},
      {"tree",
       {{"levels", info.tree.levels},
        {"nodes", info.tree.nodes},
        {"leaves", info.tree.leaves},
        {"bytes", info.tree.bytes},
        {"bytes_per_triangle", info.bytes_per_triangle()}}},
      {"load_us", info.load_us},
      {"build_us", info.build_us},
  };
}

void write_lines(const Info& info) {
  write_line("vertices               {}", info.vertices);
  write_line("triangles              {}", info.triangles);
  write_line("faces                  {}", info.faces);
  write_line("extent low             {}", to_text(info.box.low, " "));
  write_line("extent high            {}", to_text(info.box.high, " "));
  write_line("diagonal               {}", to_text(info.diagonal()));
  write_line("open edges             {}", info.edges.open);
  write_line("non-manifold edges     {}", info.edges.non_manifold);
  write_line("closed                 {}", info.edges.are_closed() ? "yes" : "no");
  write_line("degenerate triangles   {}", info.degenerate);
  write_line("duplicate triangles    {}", info.duplicates);
  write_line("unreferenced vertices  {}", info.unreferenced);
  write_line("parts                  {}", info.parts.size());
  for (const PartInfo& part : info.parts) {
    if (info.parts.size() == 1 && part.name.empty()) break;
    write_line("  {}: {} triangles, {} to {}, {}", part.name.empty() ? "(no name)" : part.name, part.triangles,
               to_text(part.box.low, " "), to_text(part.box.high, " "), part.is_closed ? "closed" : "open");
  }
  write_line("tree levels            {}", info.tree.levels);
  write_line("tree nodes             {}, {} of them leaves", info.tree.nodes, info.tree.leaves);
  write_line("tree size              {} bytes, {:.1f} per triangle", info.tree.bytes, info.bytes_per_triangle());
  write_line("time                   load {} us, build {} us", to_text(info.load_us), to_text(info.build_us));
}

ExitCode run(const InfoArguments& arguments) {
  const Info info = examine(arguments.model);
  if (arguments.json) {
    write(to_line(as_json(info)));
  } else {
    write_lines(info);
  }
  return ExitCode::answered;
}

}  // namespace

Verb add_info(CLI::App& app) {
  const auto arguments = std::make_shared<InfoArguments>();
  CLI::App& command = *app.add_subcommand("info", "Counts of a mesh, and the size of its tree");
  command.add_option("M", arguments->model, model_argument_help)->type_name("MODEL")->required();
  add_json(command, arguments->json, "answer with one JSON object");
  command.footer(R"(
Counts are of the mesh as the engine sees it: faces split into triangles and, in files, vertices at equal positions
shared. Open edges belong to one triangle, non-manifold edges to more than two; a mesh with neither is closed.
Degenerate triangles have no area, decided exactly; duplicates have the corners of an earlier triangle in any order.
Parts are objects or groups of OBJ files, solids of STL texts and nodes of glTF scenes, each looked at by itself.
The extent is that of the triangles, in the mesh's length unit. Times are in microseconds.
)");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

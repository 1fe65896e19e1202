// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <iterator>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "answers/models.h"
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

/// An edge has two distinct ends. A triangle uses an edge once, even where two of its corners coincide.
struct EdgeCounts {
  std::size_t open = 0;          ///< used by one triangle
  std::size_t closed = 0;        ///< used by two
  std::size_t non_manifold = 0;  ///< used by more

  /// Whether every edge has two triangles, so that the mesh has an inside.
  bool are_closed() const { return closed > 0 && open == 0 && non_manifold == 0; }
};

EdgeCounts count_edges(MeshView mesh) {
  using Edge = std::pair<VertexId, VertexId>;
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (const Corners& c : mesh.triangles) {
    std::array<Edge, 3> own = {std::minmax(c[0], c[1]), std::minmax(c[1], c[2]), std::minmax(c[2], c[0])};
    std::sort(own.begin(), own.end());
    const auto end = std::unique(own.begin(), own.end());
    std::copy_if(own.begin(), end, std::back_inserter(edges), [](const Edge& e) { return e.first != e.second; });
  }
  std::sort(edges.begin(), edges.end());
  EdgeCounts counts;
  for (auto first = edges.begin(); first != edges.end();) {
    const auto last = std::find_if(first, edges.end(), [first](const Edge& e) { return e != *first; });
    ++(last - first == 1 ? counts.open : last - first == 2 ? counts.closed : counts.non_manifold);
    first = last;
  }
  return counts;
}

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

Json json_of(const Box& box) { return {{"low", to_json(box.low)}, {"high", to_json(box.high)}}; }

/// Each part of the file that has a triangle, by itself.
Json examined_parts(const MeshFile& file) {
  std::vector<std::vector<Corners>> triangles(file.parts.size());
  for (TriangleId t = 0; t < file.part_of_triangle.size(); ++t) {
    triangles[file.part_of_triangle[t]].push_back(file.mesh.triangles()[t]);
  }
  Json parts = Json::array();
  for (std::size_t p = 0; p < triangles.size(); ++p) {
    if (triangles[p].empty()) continue;  // faces of fewer than three corners may be all it has
    const MeshView part{file.mesh.positions(), triangles[p]};
    parts.push_back({{"name", file.parts[p]},
                     {"triangles", triangles[p].size()},
                     {"extent", json_of(box_of(part))},
                     {"closed", count_edges(part).are_closed()}});
  }
  return parts;
}

Json examined(const std::string& argument) {
  const Stopwatch loading;
  MeshFile file = load_mesh_argument(argument);
  const double load_us = loading.microseconds();
  const Mesh& mesh = file.mesh;
  const Box box = box_of(mesh);
  const EdgeCounts edges = count_edges(mesh);
  const std::size_t triangle_count = mesh.triangles().size();
  Json json = {{"query", "info"},
               {"vertices", mesh.positions().size()},
               {"triangles", triangle_count},
               {"faces", file.face_count},
               {"extent", json_of(box)},
               {"open_edges", edges.open},
               {"non_manifold_edges", edges.non_manifold},
               {"closed", edges.are_closed()},
               {"degenerate_triangles", count_degenerate(mesh)},
               {"duplicate_triangles", count_duplicates(mesh)},
               {"unreferenced_vertices", count_unreferenced(mesh)},
               {"parts", examined_parts(file)}};
  json["extent"]["diagonal"] = length(box.high - box.low);
  const Stopwatch building;
  const Model model(std::move(file.mesh));
  const double build_us = building.microseconds();
  const TreeStats tree = model.tree_stats();
  json["tree"] = {{"levels", tree.levels},
                  {"nodes", tree.nodes},
                  {"leaves", tree.leaves},
                  {"bytes", tree.bytes},
                  {"bytes_per_triangle", static_cast<double>(tree.bytes) / static_cast<double>(triangle_count)}};
  json["load_us"] = load_us;
  json["build_us"] = build_us;
  return json;
}

/// A value as text: yes or no, or numbers with a space between them.
std::string value_text(const Json& json) {
  if (json.is_boolean()) return json.get<bool>() ? "yes" : "no";
  if (json.is_number_float()) return to_text(json.get<double>());
  if (!json.is_array()) return json.dump();
  return to_text(Vec3{json[0], json[1], json[2]});
}

void write_lines(const Json& json) {
  const Json &extent = json["extent"], &tree = json["tree"], &parts = json["parts"];
  const auto line = [](const std::string& label, const Json& value) {
    write_line("{:<23}{}", label, value_text(value));
  };
  for (const char* const key : {"vertices", "triangles", "faces"}) line(key, json[key]);
  line("extent low", extent["low"]);
  line("extent high", extent["high"]);
  line("diagonal", extent["diagonal"]);
  line("open edges", json["open_edges"]);
  line("non-manifold edges", json["non_manifold_edges"]);
  line("closed", json["closed"]);
  line("degenerate triangles", json["degenerate_triangles"]);
  line("duplicate triangles", json["duplicate_triangles"]);
  line("unreferenced vertices", json["unreferenced_vertices"]);
  line("parts", parts.size());
  for (const Json& part : parts) {
    const auto name = part["name"].get<std::string>();
    if (parts.size() == 1 && name.empty()) break;
    write_line("  {}: {} triangles, {} to {}, {}", name.empty() ? "(no name)" : name, value_text(part["triangles"]),
               value_text(part["extent"]["low"]), value_text(part["extent"]["high"]),
               part["closed"] == true ? "closed" : "open");
  }
  line("tree levels", tree["levels"]);
  write_line("tree nodes             {}, {} of them leaves", value_text(tree["nodes"]), value_text(tree["leaves"]));
  write_line("tree size              {} bytes, {:.1f} per triangle", value_text(tree["bytes"]),
             tree["bytes_per_triangle"].get<double>());
  write_line("time                   load {} us, build {} us", value_text(json["load_us"]),
             value_text(json["build_us"]));
}

ExitCode run(const InfoArguments& arguments) {
  const Json json = examined(arguments.model);
  arguments.json ? write(to_line(json)) : write_lines(json);
  return ExitCode::answered;
}

}  // namespace

Verb add_info(CLI::App& app) {
  const auto arguments = std::make_shared<InfoArguments>();
  CLI::App& command = *app.add_subcommand("info", "Counts of a mesh, and the size of its tree");
  command.add_option("M", arguments->model, model_argument_help)->type_name("MODEL")->required();
  command.add_flag("--json", arguments->json, "answer with one JSON object");
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/vertex_distances.h"

#include <CLI/CLI.hpp>
#include <vector>

#include "command/text.h"
#include "limber/points.h"

namespace limber::program {
namespace {

constexpr const char *option_a = "--vertices-a", *option_b = "--vertices-b";

bool is_ply(const std::string& path) { return path.ends_with(".ply"); }

/// Opens the file that an option names, if it does.
void open_file(std::optional<OutputFile>& file, const char* option, const std::string& path) {
  if (path.empty()) return;
  if (!is_ply(path) && !path.ends_with(".csv")) {
    throw BadInput(fmt::format("{}: {} ends in neither .csv nor .ply", option, path));
  }
  file.emplace(option, path);
}

std::vector<Vec3> placed_vertices(const std::string& option, const PlacedModel& model) {
  std::vector<Vec3> points;
  points.reserve(model.model.mesh().positions().size());
  for (const Vec3& p : model.model.mesh().positions()) {
    points.push_back(model.pose(p));
    if (max_abs(points.back()) <= max_coordinate) continue;
    throw BadInput(option + ": a pose moves a vertex beyond the largest coordinate of points, 2^200");
  }
  return points;
}

std::string csv_text(const std::vector<Vec3>& points, const std::vector<PointResult>& found) {
  std::string text = "vertex,x,y,z,distance\n";
  for (std::size_t v = 0; v < points.size(); ++v) {
    text += fmt::format("{},{},{}\n", v, to_text(points[v], ","), to_text(found[v].closest->distance));
  }
  return text;
}

std::string ply_text(const Mesh& mesh, const std::vector<Vec3>& points, const std::vector<PointResult>& found) {
  std::string text = fmt::format(
      "ply\nformat ascii 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "property double distance\nelement face {}\nproperty list uchar uint vertex_indices\nend_header\n",
      points.size(), mesh.triangles().size());
  for (std::size_t v = 0; v < points.size(); ++v) {
    text += fmt::format("{} {}\n", to_text(points[v], " "), to_text(found[v].closest->distance));
  }
  for (const auto& [u, v, w] : mesh.triangles()) text += fmt::format("3 {} {} {}\n", u, v, w);
  return text;
}

}  // namespace

void add_vertex_files(CLI::App& command, VertexFiles& target) {
  command.add_option(option_a, target.a, "also write the distances of A's vertices from B, to a file .csv or .ply")
      ->type_name("FILE");
  command.add_option(option_b, target.b, "also write the distances of B's vertices from A")->type_name("FILE");
}

VertexDistances::VertexDistances(const VertexFiles& files) : files_(files) {
  open_file(a_, option_a, files.a);
  open_file(b_, option_b, files.b);
}

void VertexDistances::write(const PlacedModel& a, const PlacedModel& b) {
  const auto text = [](const char* option, const std::string& path, const PlacedModel& of, const PlacedModel& from) {
    const std::vector<Vec3> points = placed_vertices(option, of);
    std::vector<PointResult> found(points.size());
    closest_point_many({from.model.in_fast_engine(), from.pose}, points, found);
    return is_ply(path) ? ply_text(of.model.mesh(), points, found) : csv_text(points, found);
  };
  if (a_) a_->write(text(option_a, files_.a, a, b));
  if (b_) b_->write(text(option_b, files_.b, b, a));
}

}  // namespace limber::program

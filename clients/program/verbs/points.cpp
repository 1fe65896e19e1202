// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "answers/contact_answers.h"
#include "answers/models.h"
#include "command/output.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv.h"
#include "limber/points.h"

namespace limber::program {
namespace {

struct PointsArguments {
  std::string model, points, out = "-";
  Transform pose;
  PointOptions options;
  bool is_signed = false, json = false;
};

/// Errors   BadInput unless the model is closed.
ClosedSurface surface_of(const RigidModel& model, const std::string& name) {
  if (model.surface()) return *model.surface();
  throw BadInput(fmt::format("--signed: {}: {}", name, model.surface().error().text));
}

/// Asks about some points, on all threads. Without a surface no point is inside.
std::vector<SignedDistance> ask(const RigidModel& model, const std::optional<ClosedSurface>& surface,
                                const PointsArguments& arguments, std::span<const Vec3> points) {
  std::vector<SignedDistance> answers(points.size());
  if (surface) {
    surface->signed_distance_many(points, answers, arguments.pose, arguments.options);
    return answers;
  }
  std::vector<PointResult> results(points.size());
  closest_point_many({model.model(), arguments.pose}, points, results, arguments.options);
  for (std::size_t i = 0; i < points.size(); ++i) answers[i].closest = results[i].closest;
  return answers;
}

Json row_of(std::size_t number, const Vec3& point, const SignedDistance& answer, std::uint32_t face, bool is_signed) {
  Json json = {{"row", number}, {"point", to_json(point)}, {"distance", nullptr}, {"closest", nullptr}};
  if (const std::optional<SurfacePoint>& closest = answer.closest) {
    json["distance"] = answer.distance();
    json["closest"] = {{"position", to_json(closest->position)},
                       {"triangle", closest->triangle},
                       {"face", face},
                       {"feature", to_text(closest->feature)},
                       {"weights", to_json(closest->weights)}};
  }
  if (is_signed) json["is_inside"] = answer.is_inside;
  return json;
}

AnswerColumns columns_of(bool is_signed) {
  SignedDistance sample;
  sample.closest.emplace();
  return AnswerColumns(row_of(0, {}, sample, 0, is_signed));
}

ExitCode run(const PointsArguments& arguments) {
  const std::vector<Vec3> points = read_points(arguments.points);
  const RigidModel model(load_mesh_argument(arguments.model));
  std::optional<ClosedSurface> surface;
  if (arguments.is_signed) surface.emplace(surface_of(model, arguments.model));
  OutputFile out("--out", arguments.out);
  const AnswerColumns columns = columns_of(arguments.is_signed);
  if (!arguments.json) out.write(columns.header());
  constexpr std::size_t at_once = 4096;  // some 2 ms of work
  for (std::size_t begin = 0; begin < points.size(); begin += at_once) {
    const auto some = std::span(points).subspan(begin, std::min(at_once, points.size() - begin));
    const std::vector<SignedDistance> answers = ask(model, surface, arguments, some);
    std::string text;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const std::optional<SurfacePoint>& closest = answers[i].closest;
      const Json row =
          row_of(begin + i, some[i], answers[i], closest ? model.face_of(closest->triangle) : 0, arguments.is_signed);
      text += arguments.json ? to_line(row) : columns.line(row);
    }
    out.write_rows(text);
  }
  return ExitCode::answered;
}

constexpr const char* points_help = R"(
POINTS has one point in each row. A first row of names gives the columns x, y and z, in any order; others are ignored.
Without it a row has three numbers. Blank lines and those that start with # are skipped. Points are in the world, where
--pose has put the model, and in its length unit.

The answer has a row for each point, or with --json an object in a line. distance is 0 or more, or with --signed
negative inside. closest_x, closest_y and closest_z are the closest point of the model. triangle counts from 0 in the
file's order, after larger faces have been split into fans; face is the file's own, counted from 0. feature is the part
of the triangle that the closest point lies on: "vertex 0" to "vertex 2"; "edge 0" to "edge 2", where edge 0 goes from
vertex 0 to vertex 1; or "face". weight_0 to weight_2 are what the corners of the triangle add to the closest point.
Where nothing is as close as --max-distance, these cells are empty, and distance and closest null in JSON. row counts
from 0.

--signed needs a closed model: every edge belongs to two triangles that run through it in opposite directions. is_inside
is decided exactly. generalized_winding_number() in C++ and Python tells about any other model.

Example:

  limber points bunny.obj points.csv --max-distance 0.1 --out answers.csv

Columns of the answer:

)";

}  // namespace

Verb add_points(CLI::App& app) {
  const auto arguments = std::make_shared<PointsArguments>();
  CLI::App& command = *app.add_subcommand("points", "Closest points of a model to many points, and which are inside");
  command.add_option("M", arguments->model, model_argument_help)->type_name("MODEL")->required();
  add_file(command, "POINTS", arguments->points, "CSV", "CSV file with a point in each row")->required();
  add_pose(command, "--pose", arguments->pose, "the model");
  command.add_flag("--signed", arguments->is_signed, "also whether points are inside; then their distance is negative");
  add_number(command, "--max-distance", arguments->options.max_distance, not_negative_or_infinite,
             "closest points farther away are not told, which is faster");
  add_out(command, arguments->out);
  command.add_flag("--json", arguments->json, "answer with a JSON object for each point instead of CSV");
  command.footer(points_help + columns_of(true).help() + ", the last one with --signed.");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

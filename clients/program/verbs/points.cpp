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
#include "command/options.h"
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
  bool is_signed = false, has_winding_number = false, json = false;
};

/// What is found for one point.
struct PointAnswer {
  PointResult result;
  std::optional<bool> is_inside;
  std::optional<double> winding_number;

  /// Negative inside. Pre: result.closest.
  double distance() const { return SignedDistance{is_inside.value_or(false), result.closest, result.stats}.distance(); }
};

/// Asks about some points at a time, on all threads.
class PointAsker {
 public:
  PointAsker(const RigidModel& model, const PointsArguments& arguments) : model_(model), arguments_(arguments) {
    if (!arguments.is_signed) return;
    Result<ClosedSurface> surface = ClosedSurface::create(model.model());
    if (!surface) {
      throw BadInput(fmt::format("--signed: {}: {}; --generalized-winding-number tells about any surface",
                                 arguments.model, surface.error().text));
    }
    surface_.emplace(*surface);
  }

  std::vector<PointAnswer> ask(std::span<const Vec3> points) const {
    std::vector<PointAnswer> answers(points.size());
    const Placed placed{model_.model(), arguments_.pose};
    if (surface_) {
      std::vector<SignedDistance> distances(points.size());
      surface_->signed_distance_many(points, distances, arguments_.pose, arguments_.options);
      for (std::size_t i = 0; i < points.size(); ++i) {
        answers[i] = {{distances[i].closest, distances[i].stats}, distances[i].is_inside, std::nullopt};
      }
    } else {
      std::vector<PointResult> results(points.size());
      closest_point_many(placed, points, results, arguments_.options);
      for (std::size_t i = 0; i < points.size(); ++i) answers[i].result = results[i];
    }
    for (std::size_t i = 0; arguments_.has_winding_number && i < points.size(); ++i) {
      answers[i].winding_number = generalized_winding_number(placed, points[i]);
    }
    return answers;
  }

 private:
  const RigidModel& model_;
  const PointsArguments& arguments_;
  std::optional<ClosedSurface> surface_;
};

Json row_of(std::size_t number, const Vec3& point, const PointAnswer& answer, std::uint32_t face) {
  Json json = {{"row", number}, {"point", to_json(point)}, {"distance", nullptr}, {"closest", nullptr}};
  if (const std::optional<SurfacePoint>& closest = answer.result.closest) {
    json["distance"] = answer.distance();
    json["closest"] = {{"position", to_json(closest->position)},
                       {"triangle", closest->triangle},
                       {"face", face},
                       {"feature", to_text(closest->feature)},
                       {"weights", to_json(closest->weights)}};
  }
  if (answer.is_inside) json["is_inside"] = *answer.is_inside;
  if (answer.winding_number) json["generalized_winding_number"] = *answer.winding_number;
  return json;
}

AnswerColumns columns_of(bool is_signed, bool has_winding_number) {
  PointAnswer sample;
  sample.result.closest.emplace();
  if (is_signed) sample.is_inside = false;
  if (has_winding_number) sample.winding_number = 0;
  return AnswerColumns(row_of(0, {}, sample, 0));
}

ExitCode run(const PointsArguments& arguments) {
  const std::vector<Vec3> points = read_points(arguments.points);
  const RigidModel model(load_mesh_argument(arguments.model));
  const PointAsker asker(model, arguments);
  OutputFile out("--out", arguments.out);
  const AnswerColumns columns = columns_of(arguments.is_signed, arguments.has_winding_number);
  if (!arguments.json) out.write(columns.header());
  const std::size_t at_once = arguments.has_winding_number ? 64 : 4096;  // some 0.1 s of work, or 2 ms
  for (std::size_t begin = 0; begin < points.size(); begin += at_once) {
    const auto some = std::span(points).subspan(begin, std::min(at_once, points.size() - begin));
    const std::vector<PointAnswer> answers = asker.ask(some);
    std::string text;
    for (std::size_t i = 0; i < some.size(); ++i) {
      const std::optional<SurfacePoint>& closest = answers[i].result.closest;
      const Json row = row_of(begin + i, some[i], answers[i], closest ? model.face_of(closest->triangle) : 0);
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
is decided exactly. --generalized-winding-number tells about any other model: the part of the point's surroundings that
it covers, about 1 inside and 0 outside where normals point outward, so 0.5 parts them. It looks at every triangle for
every point.

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
  command.add_flag("--generalized-winding-number", arguments->has_winding_number,
                   "also how often the surface winds around each point, open or not; slow");
  add_number(command, "--max-distance", arguments->options.max_distance, not_negative_or_infinite,
             "closest points farther away are not told, which is faster")
      ->type_name("LENGTH");
  add_out(command, arguments->out);
  command.add_flag("--json", arguments->json, "answer with a JSON object for each point instead of CSV");
  command.footer(points_help + columns_of(true, true).help() + ", the last two where they are asked for.");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

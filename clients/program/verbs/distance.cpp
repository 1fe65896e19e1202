// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "answers/answers.h"
#include "command/options.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/path.h"
#include "limber/points.h"
#include "reports/distance_report.h"
#include "verbs/distance_many.h"

namespace limber::program {
namespace {

/// `--vertices-a` and `--vertices-b`; empty where no file is asked for.
struct VertexFiles {
  std::string a, b;
};

/// The help about these files.
constexpr const char* vertex_files_help = R"(
--vertices-a writes how far each vertex of A is from the surface of B, and --vertices-b the same the other way round.
A file .csv has the columns vertex, x, y, z and distance; vertices count from 0 in the mesh's order, at their places in
the world. A file .ply is the placed mesh, with a property distance of each vertex.
)";

/// Opens both files, and writes them when it is told to.
class VertexDistances {
 public:
  /// Errors   BadInput as OutputFile, and where a name ends in neither .csv nor .ply.
  explicit VertexDistances(const VertexFiles& files);

  /// Errors   OutputFailed; BadInput where a vertex as placed is above `max_coordinate`.
  void write(const PlacedModel& a, const PlacedModel& b);

 private:
  VertexFiles files_;
  std::optional<OutputFile> a_, b_;
};

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

void add_vertex_files(CLI::App& command, VertexFiles& target) {
  add_file(command, option_a, target.a, "FILE",
           "also write the distances of A's vertices from B, to a file .csv or .ply");
  add_file(command, option_b, target.b, "FILE", "also write the distances of B's vertices from A");
}

VertexDistances::VertexDistances(const VertexFiles& files) : files_(files) {
  open_file(a_, option_a, files.a);
  open_file(b_, option_b, files.b);
}

void VertexDistances::write(const PlacedModel& a, const PlacedModel& b) {
  const auto text = [](const char* option, const std::string& path, const PlacedModel& of, const PlacedModel& from) {
    const std::vector<Vec3> points = placed_vertices(option, of);
    std::vector<PointResult> found(points.size());
    closest_point_many({from.model.model(), from.pose}, points, found);
    return is_ply(path) ? ply_text(of.model.mesh(), points, found) : csv_text(points, found);
  };
  if (a_) a_->write(text(option_a, files_.a, a, b));
  if (b_) b_->write(text(option_b, files_.b, b, a));
}

struct DistanceArguments {
  PairArguments pair;
  std::string pairs, parts, accept, out = "-";
  DistanceOptions options;
  std::optional<double> distance_error, min_clearance;
  Tolerances tolerances;
  ReportArguments report;
  VertexFiles vertices;
};

DistanceQuestion question_of(const DistanceArguments& arguments) {
  return {arguments.options, arguments.min_clearance, arguments.tolerances,
          arguments.pair.exit_code || arguments.min_clearance};
}

/// The least distance on a path.
DistanceAnswer answer_on_path(const Path& path, const Pair& pair, std::optional<double> distance_error) {
  const Stopwatch asking;
  const PathDistance found = path.min_distance(pair.a().model.model(), pair.b().model.model(), distance_error);
  DistanceAnswer answer;
  answer.elapsed_us = asking.microseconds();
  answer.path_time = found.time;
  answer.witness = with_faces(found.witness, pair.a().model, pair.b().model);
  const DistanceStatus status = found.upper == 0             ? DistanceStatus::collision
                                : found.lower == found.upper ? DistanceStatus::exact
                                                             : DistanceStatus::within_error;
  answer.result = {found.lower, found.upper, status, found.witness, found.stopped_by, found.stats};
  if (status != DistanceStatus::collision) answer.relation.nesting = nesting_of(pair.a(), pair.b());
  return answer;
}

ExitCode answer_pair(const DistanceArguments& arguments) {
  const Pair pair(arguments.pair);
  VertexDistances vertices(arguments.vertices);
  std::optional<ReportFile> report;
  if (!arguments.report.path.empty()) report.emplace(arguments.report);
  const DistanceQuestion question = question_of(arguments);
  const DistanceAnswer answer = pair.path() ? answer_on_path(*pair.path(), pair, arguments.distance_error)
                                            : answer_to(question, pair.a(), pair.b());
  if (report) report->write(distance_report(arguments.pair, pair, question, answer));
  vertices.write(pair.a(), pair.b());
  if (arguments.pair.json) {
    Json json = {{"query", "distance"}};
    append_answer(json, answer);
    if (answer.path_time) json["path_time"] = *answer.path_time;
    append_work(json, answer.result.stats, pair.build_us(), answer.elapsed_us);
    write(to_line(json));
  } else {
    write_distance_lines(answer.result, answer.witness);
    if (answer.path_time) write_line("path time {}", to_text(*answer.path_time));
    if (answer.clash) write_line("clash     {}", clash_line(*answer.clash, answer.relation));
    if (answer.depth) write_line("depth     at least {}", to_text(*answer.depth));
    if (answer.too_close) {
      write_line("clearance {} {}", *answer.too_close ? "below" : "at least", to_text(*arguments.min_clearance));
    }
    write_work_lines(answer.result.stats, pair.build_us(), answer.elapsed_us);
  }
  warn_about(answer.relation.nesting, "distance");
  return exit_code_of(question, answer);
}

ExitCode run(const DistanceArguments& arguments) {
  if (arguments.pairs.empty() && arguments.parts.empty()) return answer_pair(arguments);
  return answer_pairs(
      {arguments.pairs, arguments.parts, arguments.accept, arguments.out, arguments.pair.json, arguments.report},
      question_of(arguments));
}

constexpr const char* help_text = R"(
lower <= true distance <= upper, up to rounding. status is exact (lower = upper), within_error, collision (both 0) or
beyond_limit (farther apart than --max-distance: no upper, no witness). Lengths are in the meshes' unit, points in the
world frame, times in microseconds. Triangles count from 0 in the file's order, after larger faces have been split
into fans; faces are the file's own, counted from 0. Where a file has several parts, the answer to one pair names those
of the triangles, in JSON as part_a and part_b.

--min-clearance is decided as for an exact distance, whatever the errors asked for.

Distances are of surfaces: a model wholly inside the other is as far from it as their surfaces are apart. Where a closed
model has the other inside, a warning says so, and inside in JSON and CSV is a_inside_b or b_inside_a.
)";

constexpr const char* path_answer_help = R"(
With --path-a or --path-b the answer is the least distance on the whole path, and path_time when the models are so near.
lower and upper are at most --distance-error apart; without it 2^-10 of the sum of the radii of both models, or of the
distance if that is larger; with 0 they are as close as it gets, which may take long. There is no clash then.
)";

constexpr const char* pairs_help = R"(
The first row of a file of pairs names its columns, in any order: model_a and model_b, and where you want them
pose_a_tx, pose_a_ty, pose_a_tz, pose_a_qw, pose_a_qx, pose_a_qy, pose_a_qz, and the same for b. A translation that is
left out is 0; a quaternion is given whole, or not at all. Other columns are ignored, unless they look like one of these
misspelt. Blank lines and those that start with # are skipped. Paths are relative to the working directory. Each file is
loaded once.

A file of parts has the column model, and where you want them name and pose_tx to pose_qz. The answer has a row for each
pair of parts, the first with all others first; with --max-distance only for those that are not farther apart, and no
others are looked at. part_a and part_b count parts from 0, name_a and name_b are their names, or their models without
folders. Parts of one mesh file stand as the file places them; triangles are counted in each part, faces in the file.

--report writes one HTML file that needs no network: both meshes in 3D with the closest points, a section through
them, the distance of each surface from the other in colours, or the triangles that intersect, and the answer as a
table. Of a file of pairs or parts it says first whether the clearance is kept, and lists all pairs, the worst first;
each is shown in 3D. Pages name date, version, and the SHA-256 of files that were read.

Example, pairs.csv:

  model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz
  gear.obj,housing.stl,0,0,12.5
  gear.obj,scene:ball,3,0,0

  limber distance --pairs pairs.csv --min-clearance 0.5 --out answers.csv
  limber distance --pairs pairs.csv --min-clearance 0.5 --report study.html
  limber distance --parts parts.csv --report assembly.html --unit mm
  limber distance --parts house.glb --max-distance 0.05 --tolerance 0.001

Cells are empty, and null in JSON: too_close without --min-clearance and where meshes cannot tell, inside where neither
model is inside the other without touching it, solids where a model is not closed, depth there and where volumes do not
overlap, accepted where no line of --accept does, upper and the witness where status is beyond_limit. JSON
has the names of the columns, and an object witness or null: point_a and point_b, arrays of three numbers, triangle_a,
triangle_b, face_a, face_b. For one pair build_us is the time for both trees.
Columns of the answer, where row counts from 0; with --parts part_a, part_b, name_a and name_b are in place of the
models:

)";

/// What the options say about each other.
void check_options(const CLI::App& command, const DistanceArguments& arguments) {
  const auto is_given = [&](const char* name) { return command.get_option(name)->count() > 0; };
  const char* const file = is_given("--pairs") ? "--pairs" : is_given("--parts") ? "--parts" : nullptr;
  for (const char* const name : {"A", "B"}) {
    if (file == nullptr && !is_given(name)) throw CLI::RequiredError(name);
  }
  for (const char* const name :
       {"A", "B", "--pose-a", "--pose-b", "--path-a", "--path-b", "--vertices-a", "--vertices-b"}) {
    if (file != nullptr && is_given(name)) throw CLI::ValidationError(file, std::string("leaves no room for ") + name);
  }
  if (is_given("--pairs") && is_given("--parts")) throw CLI::ValidationError("--pairs", "leaves no room for --parts");
  for (const char* const path : {"--path-a", "--path-b"}) {
    for (const char* const name : {"--relative-error", "--absolute-error", "--max-distance", "--min-clearance",
                                   "--tolerance", "--mesh-error", "--report", "--vertices-a", "--vertices-b"}) {
      if (is_given(path) && is_given(name)) throw CLI::ValidationError(path, std::string("leaves no room for ") + name);
    }
  }
  if (is_given("--distance-error") && !is_given("--path-a") && !is_given("--path-b")) {
    throw CLI::ValidationError("--distance-error", "belongs to --path-a and --path-b");
  }
  for (const char* const name : {"--out", "--accept"}) {
    if (file == nullptr && is_given(name)) throw CLI::ValidationError(name, "belongs to --pairs and --parts");
  }
  if (arguments.min_clearance > arguments.options.max_distance) {
    throw CLI::ValidationError("--max-distance", "must be at least --min-clearance");
  }
  if (is_given("--exit-code") && !is_given("--max-distance") && !is_given("--min-clearance")) {
    throw CLI::ValidationError("--exit-code", "needs --max-distance or --min-clearance");
  }
}

}  // namespace

Verb add_distance(CLI::App& app, const std::string& command_line) {
  const auto arguments = std::make_shared<DistanceArguments>();
  arguments->report.command_line = command_line;
  CLI::App& command = *app.add_subcommand("distance", "Shortest distance of two models and the points that attain it");
  add_pair_arguments(
      command, arguments->pair,
      "a pair is at most --max-distance apart, or a hard clash; where --min-clearance is given, that decides");
  for (const char* const name : {"A", "B"}) command.get_option(name)->required(false);
  add_distance_options(command, arguments->options);
  add_number(command, "--distance-error", arguments->distance_error, not_negative,
             "with --path-a and --path-b: how far apart lower and upper are at most; 0 is as exact as it gets")
      ->type_name("LENGTH");
  add_min_clearance(
      command, arguments->min_clearance,
      "exit with 3 instead of 0 when a pair is closer than this length, or a hard clash; at most --max-distance");
  add_number(command, "--tolerance", arguments->tolerances.overlap, not_negative,
             "closed models that are proven to be no deeper in each other than this length only touch")
      ->type_name("LENGTH");
  add_number(command, "--mesh-error", arguments->tolerances.mesh_error, not_negative,
             "how far each mesh is from the part that it stands for at most; a pair is off by twice that")
      ->type_name("LENGTH");
  add_file(command, "--pairs", arguments->pairs, "CSV",
           "instead of A and B: a CSV file with a pair of models in each row; the answer is CSV too, or with --json an "
           "object for each row");
  add_file(command, "--parts", arguments->parts, "FILE",
           "instead of A and B: a CSV file with a part of an assembly in each row, or one mesh file whose nodes, "
           "objects, groups or solids are the parts; the answer is that of all pairs of parts");
  add_file(command, "--accept", arguments->accept, "CSV",
           "with --pairs and --parts: a CSV file of pairs that may touch, or overlap");
  add_out(command, arguments->out, "with --pairs and --parts: ");
  add_report(command, arguments->report,
             "also write a page that shows the answer: both meshes, a section, their distance in colours; or all "
             "pairs, the worst first");
  add_vertex_files(command, arguments->vertices);
  command.parse_complete_callback([&command, arguments] { check_options(command, *arguments); });
  command.footer(std::string(help_text) + clash_help + tolerances_help + vertex_files_help + path_answer_help +
                 path_help + accept_help + pairs_help + pairs_answer_columns());
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <system_error>
#include <vector>

#include "command/options.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv_inputs.h"
#include "limber/distance.h"
#include "reports/distance_report.h"
#include "verbs/answers.h"
#include "verbs/models.h"

namespace limber::program {
namespace {

struct DistanceArguments {
  PairArguments pair;
  std::string pairs, out = "-";
  DistanceOptions options;
  std::optional<double> min_clearance;
  ReportArguments report;
};

DistanceQuestion question_of(const DistanceArguments& arguments) {
  return {arguments.options, arguments.min_clearance, arguments.pair.exit_code || arguments.min_clearance};
}

/// The least distance on a path, which is certified within the absolute error.
DistanceAnswer answer_on_path(const Path& path, const Pair& pair, double absolute_error) {
  const Stopwatch asking;
  const PathDistance found = path.least_distance(pair.a().model.fast(), pair.b().model.fast(), absolute_error);
  DistanceAnswer answer;
  answer.elapsed_us = asking.microseconds();
  answer.path_time = found.time;
  answer.witness = with_faces(found.witness, pair.a().model, pair.b().model);
  const Status status = found.upper == 0             ? Status::collision
                        : found.lower == found.upper ? Status::exact
                                                     : Status::within_error;
  answer.result = {found.lower, found.upper, status, found.witness, found.stopped_by, found.stats};
  if (status != Status::collision) answer.relation.nesting = nesting_of(pair.a(), pair.b());
  return answer;
}

ExitCode answer_pair(const DistanceArguments& arguments) {
  const Pair pair(arguments.pair);
  std::optional<ReportFile> report;
  if (!arguments.report.path.empty()) report.emplace(arguments.report, Names{arguments.pair.a, arguments.pair.b});
  const DistanceQuestion question = question_of(arguments);
  const DistanceAnswer answer = pair.path() ? answer_on_path(*pair.path(), pair, arguments.options.absolute_error)
                                            : answer_to(question, pair.a(), pair.b());
  if (report) report->write(distance_report(arguments.pair, pair, question, answer));
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
    if (answer.too_close) {
      write_line("clearance {} {}", *answer.too_close ? "below" : "at least", to_text(*arguments.min_clearance));
    }
    write_work_lines(answer.result.stats, pair.build_us(), answer.elapsed_us);
  }
  warn_about(answer.relation.nesting, "distance");
  return exit_code_of(question, answer);
}

/// Models by their names. A file that is named in several ways is still one model.
class Models {
 public:
  explicit Models(Engine engine) : engine_(engine) {}

  const RigidModel* load(const std::string& name) {
    std::unique_ptr<RigidModel>& model = models_[key_of(name)];
    if (!model) model = std::make_unique<RigidModel>(load_mesh_argument(name), engine_);
    return model.get();
  }

  /// The files that have been loaded.
  Names files() const {
    Names files;
    for (const auto& [name, model] : models_) files.push_back(name);
    return files;
  }

 private:
  static std::string key_of(const std::string& name) {
    if (is_scene(name)) return name;
    std::error_code failed;
    const std::filesystem::path path = std::filesystem::weakly_canonical(name, failed);
    return failed ? name : path.string();
  }

  Engine engine_;
  std::map<std::string, std::unique_ptr<RigidModel>> models_;
};

/// The models of one row.
struct LoadedPair {
  const RigidModel *a = nullptr, *b = nullptr;
};

std::vector<LoadedPair> load_all(const std::vector<PairRow>& rows, const std::string& path, Models& models) {
  std::vector<LoadedPair> pairs;
  pairs.reserve(rows.size());
  const auto load = [&](const PairRow& row, const char* column, const std::string& name) {
    try {
      return models.load(name);
    } catch (const BadInput& error) {
      throw BadInput(fmt::format("{}: line {}: column {}: {}", path, row.line, column, error.what()));
    }
  };
  for (const PairRow& row : rows) {
    pairs.push_back({load(row, "model_a", row.model_a), load(row, "model_b", row.model_b)});
  }
  return pairs;
}

Json answer_in_row(std::size_t number, const PairRow& row, const DistanceAnswer& answer) {
  Json json = {{"row", number}, {"model_a", row.model_a}, {"model_b", row.model_b}};
  append_answer(json, answer);
  append_work(json, answer.result.stats, answer.elapsed_us);
  return json;
}

void warn_about(std::size_t nested_count) {
  if (nested_count == 0) return;
  const std::string where =
      nested_count == 1 ? "in 1 row a model lies" : fmt::format("in {} rows a model lies", nested_count);
  warn("distance", where + " inside the other without touching it; models are surfaces, not solids (column inside)");
}

/// The columns of the answer to a file of pairs, as csv_line() makes them from answer_in_row().
std::string pairs_answer_columns() {
  return fmt::format("row,model_a,model_b,{},{},too_close,inside,clash,solids,query_us,node_tests,triangle_tests",
                     distance_columns, witness_columns);
}

/// Answers the same question for every pair of a file, and writes a row for each. All rows are read, and each model is
/// loaded once, before anything is written.
ExitCode answer_pairs(const DistanceArguments& arguments) {
  const DistanceQuestion question = question_of(arguments);
  const std::vector<PairRow> rows = read_pairs(arguments.pairs);
  Models models(arguments.pair.engine);
  const std::vector<LoadedPair> pairs = load_all(rows, arguments.pairs, models);
  Names inputs = models.files();
  inputs.push_back(arguments.pairs);
  OutputFile out("--out", arguments.out, inputs, {});
  ProgressBar bar(rows.size(), "pairs");
  ExitCode exit_code = ExitCode::answered;
  std::size_t nested_count = 0;
  if (!arguments.pair.json) out.write(pairs_answer_columns() + '\n');
  for (std::size_t i = 0; i < rows.size(); ++i) {
    bar.draw(i);
    const DistanceAnswer answer = answer_to(question, {*pairs[i].a, rows[i].pose_a}, {*pairs[i].b, rows[i].pose_b});
    if (answer.relation.nesting != Nesting::none) ++nested_count;
    if (exit_code_of(question, answer) == ExitCode::found) exit_code = ExitCode::found;
    if (out.is_terminal()) bar.clear();
    const Json row = answer_in_row(i, rows[i], answer);
    out.write(arguments.pair.json ? to_line(row) : csv_line(row));
  }
  bar.clear();
  warn_about(nested_count);
  return exit_code;
}

ExitCode run(const DistanceArguments& arguments) {
  return arguments.pairs.empty() ? answer_pair(arguments) : answer_pairs(arguments);
}

constexpr const char* help_text = R"(
lower <= true distance <= upper, up to rounding. status is exact (lower = upper), within_error, collision (both 0) or
beyond_limit (farther apart than --max-distance: no upper, no witness). Lengths are in the meshes' unit, points in the
world frame, times in microseconds. Triangles count from 0 in the file's order, after larger faces have been split
into fans; faces are the file's own, counted from 0.

--min-clearance is decided as for an exact distance, whatever the errors asked for.

Distances are of surfaces: a model wholly inside the other is as far from it as their surfaces are apart. Where a closed
model has the other inside, a warning says so, and inside in JSON and CSV is a_in_b or b_in_a.
)";

constexpr const char* path_answer_help = R"(
With --path-a or --path-b the answer is the least distance on the whole path, and path_time when the models are so near.
lower and upper are at most --absolute-error apart; without it 2^-10 of the sum of the radii of both models, or of the
distance if that is larger. There is no clash then.
)";

constexpr const char* pairs_help = R"(
The first row of a file of pairs names its columns, in any order: model_a and model_b, and where you want them
pose_a_tx, pose_a_ty, pose_a_tz, pose_a_qw, pose_a_qx, pose_a_qy, pose_a_qz, and the same for b. A translation that is
left out is 0; a quaternion is given whole, or not at all. Other columns are ignored, unless they look like one of these
misspelt. Blank lines and those that start with # are skipped. Paths are relative to the working directory. Each file is
loaded once.

--report writes one HTML file that needs no network: both meshes in 3D with the closest points, a section through
them, the distance of each surface from the other in colours, or the triangles that intersect, and the answer as a
table.

Example, pairs.csv:

  model_a,model_b,pose_b_tx,pose_b_ty,pose_b_tz
  gear.obj,housing.stl,0,0,12.5
  gear.obj,scene:ball,3,0,0

  limber distance --pairs pairs.csv --min-clearance 0.5 --out answers.csv

Cells are empty, and null in JSON: too_close without --min-clearance, inside where neither model is inside the other
without touching it, solids where a model is not closed, upper and the witness where status is beyond_limit. JSON has
the names of the columns, and an object witness or null: point_a and point_b, arrays of three numbers, triangle_a,
triangle_b, face_a, face_b. For one pair build_us is the time for both trees. Columns of the answer, where row counts
from 0:

)";

/// What the options say about each other.
void check_options(const CLI::App& command, const DistanceArguments& arguments) {
  const auto is_given = [&](const char* name) { return command.get_option(name)->count() > 0; };
  const bool has_pairs = is_given("--pairs");
  for (const char* const name : {"A", "B"}) {
    if (!has_pairs && !is_given(name)) throw CLI::RequiredError(name);
  }
  for (const char* const name : {"A", "B", "--pose-a", "--pose-b", "--path-a", "--path-b", "--report"}) {
    if (has_pairs && is_given(name)) throw CLI::ValidationError("--pairs", std::string("leaves no room for ") + name);
  }
  for (const char* const path : {"--path-a", "--path-b"}) {
    for (const char* const name : {"--relative-error", "--max-distance", "--min-clearance", "--report"}) {
      if (is_given(path) && is_given(name)) throw CLI::ValidationError(path, std::string("leaves no room for ") + name);
    }
  }
  if (!has_pairs && is_given("--out")) throw CLI::ValidationError("--out", "belongs to --pairs");
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
  add_number(command, "--min-clearance", arguments->min_clearance,
             {std::numeric_limits<double>::denorm_min(), std::numeric_limits<double>::max(), "a finite number > 0"},
             "exit with 3 instead of 0 when a pair is closer than this length, or a hard clash; at most --max-distance")
      ->type_name("LENGTH");
  command
      .add_option("--pairs", arguments->pairs,
                  "instead of A and B: a CSV file with a pair of models in each row; the answer is CSV too, or with "
                  "--json an object for each row")
      ->type_name("CSV");
  command.add_option("--out", arguments->out, "with --pairs: where the answer is written, - for standard output")
      ->type_name("FILE")
      ->capture_default_str();
  add_report(command, arguments->report,
             "also write a page that shows the answer: both meshes, a section, their distance in colours");
  command.parse_complete_callback([&command, arguments] { check_options(command, *arguments); });
  command.footer(std::string(help_text) + clash_help + path_answer_help + path_help + pairs_help +
                 spaced(pairs_answer_columns()));
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "answers/answers.h"
#include "answers/parts.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/csv.h"
#include "limber/path.h"
#include "reports/page_template.h"
#include "reports/study.h"

namespace limber::program {
namespace {

struct DistanceArguments {
  PairArguments pair;
  std::string pairs, parts, accept, out = "-";
  DistanceOptions options;
  std::optional<double> distance_error, min_clearance;
  Tolerances tolerances;
  ReportArguments report;
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
  std::optional<ReportFile> report;
  if (!arguments.report.path.empty()) report.emplace(arguments.report);
  const DistanceQuestion question = question_of(arguments);
  const DistanceAnswer answer = pair.path() ? answer_on_path(*pair.path(), pair, arguments.distance_error)
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
    if (answer.depth) write_line("depth     at least {}", to_text(*answer.depth));
    if (answer.too_close) {
      write_line("clearance {} {}", *answer.too_close ? "below" : "at least", to_text(*arguments.min_clearance));
    }
    write_work_lines(answer.result.stats, pair.build_us(), answer.elapsed_us);
  }
  warn_about(answer.relation.nesting, "distance");
  return exit_code_of(question, answer);
}

/// Whether a pattern with * and ? is that of a name. Each * takes as little as will do; none has to take more.
bool matches(std::string_view pattern, std::string_view name) {
  std::size_t p = 0, n = 0, after_star = std::string_view::npos, resumed = 0;
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      after_star = ++p, resumed = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (after_star != std::string_view::npos) {
      p = after_star, n = ++resumed;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string_view::npos;
}

/// Whether the parts touch or may touch, and nothing worse is possible.
bool is_touching(const DistanceAnswer& answer) {
  const bool may_touch = answer.clash == Clash::cannot_tell && !answer.may_clash && answer.result.lower == 0;
  return answer.clash == Clash::touching || may_touch;
}

/// `--accept`: pairs of parts that may touch, or even overlap.
class AcceptedPairs {
 public:
  /// Accepts nothing if the path is empty. Errors: BadInput of read_csv(), and where a word is neither.
  explicit AcceptedPairs(const std::string& path) : path_(path) {
    if (path.empty()) return;
    const std::string hint = "; the first row names the columns: name_a,name_b,allowed";
    read_csv(path, {"pair", {"name_a", "name_b", "allowed"}, 2, true, hint, true},
             [&](const std::vector<std::string>& fields, std::size_t line) {
               const std::string& allowed = fields[2];
               if (allowed != "all" && allowed != "touching" && !allowed.empty()) {
                 throw BadInput(fmt::format("column allowed: must be touching or all, not '{}'", shown(allowed)));
               }
               rules_.push_back({fields[0], fields[1], allowed == "all", false, line});
             });
  }

  /// The first line that accepts the answer to a pair of names, counted from 1.
  std::optional<std::size_t> accept(const std::string& name_a, const std::string& name_b,
                                    const DistanceAnswer& answer) {
    if (answer.clash == Clash::clear || answer.clash == Clash::surfaces_apart) return std::nullopt;
    std::optional<std::size_t> first;
    for (Rule& rule : rules_) {
      if (!rule.allows_all && !is_touching(answer)) continue;
      const bool is_meant =
          (matches(rule.a, name_a) && matches(rule.b, name_b)) || (matches(rule.a, name_b) && matches(rule.b, name_a));
      if (!is_meant) continue;
      rule.is_used = true;
      if (!first) first = rule.line;
    }
    return first;
  }

  /// Warns of each line that has accepted nothing.
  void warn_about_unused() const {
    for (const Rule& rule : rules_) {
      if (!rule.is_used) warn("distance", fmt::format("{}: line {}: accepts no pair", path_, rule.line));
    }
  }

 private:
  struct Rule {
    std::string a, b;  ///< patterns
    bool allows_all = false, is_used = false;
    std::size_t line = 0;
  };

  std::string path_;
  std::vector<Rule> rules_;
};

Json answer_in_row(std::size_t number, const AskedPairs& asked, const PartPair& pair, const DistanceAnswer& answer,
                   const std::optional<std::size_t>& accepted) {
  const auto& [a, b] = pair;
  const StudyPart &part_a = asked.parts[a], &part_b = asked.parts[b];
  Json json = {{"row", number}};
  if (asked.kind == StudyKind::pairs) {
    json["model_a"] = part_a.file;
    json["model_b"] = part_b.file;
  } else {
    json["part_a"] = a;
    json["part_b"] = b;
    json["name_a"] = part_a.name;
    json["name_b"] = part_b.name;
  }
  append_answer(json, answer);
  json["accepted"] = to_json(accepted);
  append_work(json, answer.result.stats, answer.elapsed_us);
  return json;
}

/// Answers the pairs from `first` on, as many as `answers` has room for, on all threads.
void answer_next(const DistanceQuestion& question, const AskedPairs& asked, std::size_t first,
                 std::vector<DistanceAnswer>& answers) {
  const std::size_t count = std::min(answers.size(), asked.pairs.size() - first);
  oneapi::tbb::parallel_for(std::size_t{0}, count, [&](std::size_t i) {
    const auto& [a, b] = asked.pairs[first + i];
    answers[i] = answer_to(question, asked.parts[a].placed(), asked.parts[b].placed());
  });
}

AnswerColumns columns_of(StudyKind kind) {
  const AskedPairs sample{kind, std::vector<StudyPart>(2), {}, {}};
  DistanceAnswer answer;
  answer.witness.emplace();
  return AnswerColumns(answer_in_row(0, sample, {0, 1}, answer, {}));
}

ExitCode answer_pairs(const DistanceArguments& arguments) {
  const DistanceQuestion question = question_of(arguments);
  const double max_distance = question.options.max_distance + question.tolerances.of_pair();
  const AskedPairs asked =
      arguments.parts.empty() ? pairs_of_file(arguments.pairs) : pairs_of_parts(arguments.parts, max_distance);
  AcceptedPairs accepted_pairs(arguments.accept);
  Study study(asked.kind, question, asked.parts);
  OutputFile out("--out", arguments.out);
  std::optional<ReportFile> report;
  if (!arguments.report.path.empty()) report.emplace(arguments.report);
  ExitCode exit_code = ExitCode::answered;
  std::size_t nested_count = 0, row = 0;
  const AnswerColumns columns = columns_of(asked.kind);
  if (!arguments.pair.json) out.write(columns.header());
  // What models make when they are first asked for it, so that threads may ask them.
  for (const StudyPart& part : asked.parts) static_cast<void>(part.model->surface());
  std::vector<DistanceAnswer> answers(32 * static_cast<std::size_t>(oneapi::tbb::this_task_arena::max_concurrency()));
  for (std::size_t i = 0; i < asked.pairs.size(); ++i) {
    const auto& [a, b] = asked.pairs[i];
    if (i % answers.size() == 0) answer_next(question, asked, i, answers);
    const DistanceAnswer& answer = answers[i % answers.size()];
    const bool is_far = answer.result.status == DistanceStatus::beyond_limit && !answer.may_clash;
    if (is_far && asked.kind == StudyKind::parts) continue;
    const auto accepted = accepted_pairs.accept(asked.parts[a].name, asked.parts[b].name, answer);
    if (answer.relation.nesting != Nesting::none) ++nested_count;
    if (!accepted) exit_code = worse_of(exit_code, exit_code_of(question, answer));
    if (report) study.add(row, asked.pairs[i], answer, accepted);
    const Json json = answer_in_row(row++, asked, asked.pairs[i], answer, accepted);
    out.write_rows(arguments.pair.json ? to_line(json) : columns.line(json));
  }
  if (nested_count > 0) {
    warn("distance", fmt::format("in {} a model lies inside the other without touching it; models are surfaces, not "
                                 "solids (column inside)",
                                 nested_count == 1 ? "1 row" : fmt::format("{} rows", nested_count)));
  }
  accepted_pairs.warn_about_unused();
  if (report) report->write(study.to_json());
  return exit_code;
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
each is shown in 3D. Pages name date, version and command line.

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

constexpr const char* accept_help = R"(
A file for --accept has the columns name_a and name_b, where you want it allowed, and no others. Names are patterns of
the names in the answer, in either order: * stands for any characters, ? for one. What is allowed is touching, which is
meant where nothing is said, or all: hard clashes too. The column accepted of the answer tells the first line that
accepts a pair, which otherwise would be touching or worse. Accepted pairs keep their clash, but do not change the exit
code. Lines that accept nothing are warned of.

  name_a,name_b,allowed
  bolt_*,plate_*,touching
  bolt_*,nut_*,all
)";

/// What the options say about each other.
void check_options(const CLI::App& command, const DistanceArguments& arguments) {
  const auto is_given = [&](const char* name) { return command.get_option(name)->count() > 0; };
  const char* const file = is_given("--pairs") ? "--pairs" : is_given("--parts") ? "--parts" : nullptr;
  for (const char* const name : {"A", "B"}) {
    if (file == nullptr && !is_given(name)) throw CLI::RequiredError(name);
  }
  for (const char* const name : {"A", "B", "--pose-a", "--pose-b", "--path-a", "--path-b"}) {
    if (file != nullptr && is_given(name)) throw CLI::ValidationError(file, std::string("leaves no room for ") + name);
  }
  if (is_given("--pairs") && is_given("--parts")) throw CLI::ValidationError("--pairs", "leaves no room for --parts");
  for (const char* const path : {"--path-a", "--path-b"}) {
    for (const char* const name : {"--relative-error", "--absolute-error", "--max-distance", "--min-clearance",
                                   "--tolerance", "--mesh-error", "--report"}) {
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
             "with --path-a and --path-b: how far apart lower and upper are at most; 0 is as exact as it gets");
  add_min_clearance(
      command, arguments->min_clearance,
      "exit with 3 instead of 0 when a pair is closer than this length, or a hard clash; at most --max-distance");
  add_number(command, "--tolerance", arguments->tolerances.overlap, not_negative,
             "closed models that are proven to be no deeper in each other than this length only touch");
  add_number(command, "--mesh-error", arguments->tolerances.mesh_error, not_negative,
             "how far each mesh is from the part that it stands for at most; a pair is off by twice that");
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
  command.parse_complete_callback([&command, arguments] { check_options(command, *arguments); });
  command.footer(std::string(help_text) + clash_help + tolerances_help + path_answer_help + path_help + accept_help +
                 pairs_help + columns_of(StudyKind::pairs).help());
  return {&command, [arguments] {
            const bool has_file = !arguments->pairs.empty() || !arguments->parts.empty();
            return has_file ? answer_pairs(*arguments) : answer_pair(*arguments);
          }};
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>
#include <optional>

#include "answers/answers.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"

/// The verbs collide and within: yes or no, and where.
namespace limber::program {
namespace {

struct CollideArguments {
  PairArguments pair;
  std::optional<double> max_distance;  // empty: the models have to meet
};

/// The answer. On a path it is yes at `path_time` first.
struct CollideAnswer {
  CollideResult result;
  double elapsed_us = 0;
  std::optional<double> path_time = {};
};

CollideAnswer answer_to(const CollideArguments& arguments, const Pair& pair) {
  const std::optional<double>& limit = arguments.max_distance;
  const Stopwatch asking;
  if (!pair.path()) {
    const CollideResult result = limit ? within(pair.a(), pair.b(), *limit) : collide(pair.a(), pair.b());
    return {result, asking.microseconds()};
  }
  const PathImpact found = pair.path()->first_impact(pair.a().model.model(), pair.b().model.model(), limit.value_or(0));
  const bool is_clear = found.status == ImpactStatus::clear;
  CollideAnswer answer{{is_clear ? Answer::no : Answer::yes, found.witness, found.stopped_by, found.stats},
                       asking.microseconds()};
  if (!is_clear) answer.path_time = found.time;
  return answer;
}

/// Models that are close enough may meet, and then none is inside the other.
Nesting nesting_unless_they_meet(const CollideArguments& arguments, const CollideResult& result, const Pair& pair) {
  if (result.is_yes() && !arguments.max_distance) return Nesting::none;
  const Nesting nesting = nesting_of(pair.a(), pair.b());
  const bool may_meet = result.is_yes() && nesting != Nesting::none;
  return may_meet && collide(pair.a(), pair.b()).is_yes() ? Nesting::none : nesting;
}

ExitCode run(const CollideArguments& arguments) {
  const Pair pair(arguments.pair);
  const auto [result, elapsed_us, path_time] = answer_to(arguments, pair);
  const auto witness = with_faces(result.witness, pair.a().model, pair.b().model);
  const Nesting nesting = nesting_unless_they_meet(arguments, result, pair);
  const std::string verb = arguments.max_distance ? "within" : "collide";
  const std::string fact = arguments.max_distance ? "within" : "collision";
  if (arguments.pair.json) {
    Json json = {{"query", verb}, {"is_yes", result.is_yes()}};
    if (arguments.max_distance) json["max_distance"] = *arguments.max_distance;
    json["witness"] = to_json(witness);
    json["inside"] = to_json(nesting);
    if (pair.path()) json["path_time"] = to_json(path_time);
    append_work(json, result.stats, pair.build_us(), elapsed_us);
    write(to_line(json));
  } else {
    write_line("{:<10}{}", fact, result.is_yes() ? "yes" : "no");
    if (arguments.max_distance) write_line("max distance {}", to_text(*arguments.max_distance));
    write_lines(witness);
    if (path_time) write_line("path time {}", to_text(*path_time));
    write_work_lines(result.stats, pair.build_us(), elapsed_us);
  }
  warn_about(nesting, verb);
  return arguments.pair.exit_code && result.is_yes() ? ExitCode::found : ExitCode::answered;
}

}  // namespace

Verb add_collide(CLI::App& app) {
  const auto arguments = std::make_shared<CollideArguments>();
  CLI::App& command = *app.add_subcommand("collide", "Whether two models meet, and where");
  add_pair_arguments(command, arguments->pair, "the models collide");
  command.footer(std::string(R"(
Touching is meeting. Models are surfaces, not solids: one wholly inside the other does not meet it. Where a closed
model has the other inside, a warning says so, and the field inside in JSON; limber distance tells how volumes lie.

The witness is a point in the world frame, in the meshes' length unit, once as a point of A and once as a point of B.
The triangles and the faces of the files that it lies on are counted from 0; the parts of a file that has several are
named. Times are in microseconds.

With --path-a or --path-b the question is whether the models meet on the path, and path_time is when they first do:
before, they are apart. Then they are closer than 2^-20 of the sum of their radii, so a path that passes as closely may
count as one on which they meet. inside is about the start.
)") + path_help);
  return {&command, [arguments] { return run(*arguments); }};
}

Verb add_within(CLI::App& app) {
  const auto arguments = std::make_shared<CollideArguments>();
  CLI::App& command = *app.add_subcommand("within", "Whether two models are at most a given distance apart");
  add_pair_arguments(command, arguments->pair, "the models are within the distance");
  add_number(command, "--max-distance", arguments->max_distance, not_negative,
             "the distance, in the meshes' length unit")
      ->required();
  command.footer(std::string(R"(
Stops at the first pair of points at most --max-distance apart, so it is faster than the distance itself. The witness
is that pair, not the closest one; else it is as limber collide tells it, and so is what lies inside.

With --path-a or --path-b path_time is when the models first are within the distance: before, they are farther apart.
Then they may be farther apart by up to 2^-20 of the sum of their radii. inside is about the start of the path.
)") + path_help);
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

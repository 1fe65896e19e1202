// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <limits>
#include <memory>

#include "command/options.h"
#include "command/pair_arguments.h"
#include "command/text.h"
#include "command/verb.h"
#include "limber/distance.h"
#include "verbs/answers.h"

namespace limber::program {
namespace {

struct WithinArguments {
  PairArguments pair;
  double max_distance = 0;
};

/// Models that are close enough may meet, and then none is inside the other.
Nesting nesting_unless_they_meet(const CollideResult& result, const Pair& pair) {
  const auto meet = [](const auto& a, const auto& b) { return collide(a, b).is_yes(); };
  const Nesting nesting = nesting_of(pair.a(), pair.b());
  const bool may_meet = result.is_yes() && nesting != Nesting::none;
  return may_meet && ask(pair.a(), pair.b(), meet).answer ? Nesting::none : nesting;
}

ExitCode run(const WithinArguments& arguments) {
  const Pair pair(arguments.pair);
  const auto [result, elapsed_us] =
      ask(pair.a(), pair.b(), [&](const auto& a, const auto& b) { return within(a, b, arguments.max_distance); });
  const auto witness = with_faces(result.witness, pair.a().model, pair.b().model);
  const Nesting nesting = nesting_unless_they_meet(result, pair);
  if (arguments.pair.json) {
    Json json = {{"query", "within"}, {"within", result.is_yes()}, {"max_distance", arguments.max_distance}};
    json["witness"] = to_json(witness);
    json["inside"] = to_json(nesting);
    append_work(json, result.stats, pair.build_us(), elapsed_us);
    write(to_line(json));
  } else {
    write_line("within    {}", result.is_yes() ? "yes" : "no");
    write_line("limit     {}", to_text(arguments.max_distance));
    write_lines(witness);
    write_work_lines(result.stats, pair.build_us(), elapsed_us);
  }
  warn_about(nesting, "within");
  return arguments.pair.exit_code && result.is_yes() ? ExitCode::found : ExitCode::answered;
}

}  // namespace

Verb add_within(CLI::App& app) {
  const auto arguments = std::make_shared<WithinArguments>();
  CLI::App& command = *app.add_subcommand("within", "Whether two models are at most a given distance apart");
  add_pair_arguments(command, arguments->pair, "the models are within the distance");
  add_number(command, "--max-distance", arguments->max_distance,
             {0, std::numeric_limits<double>::max(), "a finite number >= 0"},
             "the distance, in the meshes' length unit")
      ->type_name("LENGTH")
      ->default_str("")
      ->required();
  command.footer(R"(
Stops at the first pair of points at most --max-distance apart, so it is faster than the distance itself. The witness
is that pair, not the closest one: points in the world frame, in the meshes' length unit, with the triangles and the
faces of the files that they lie on, all counted from 0. Times are in microseconds.

Models are surfaces, not solids. Where a closed model has the other inside without touching it, a warning says so, and
the field inside in JSON.
)");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

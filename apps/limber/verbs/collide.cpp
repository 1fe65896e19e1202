// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <CLI/CLI.hpp>
#include <memory>

#include "command/pair_arguments.h"
#include "command/verb.h"
#include "verbs/answers.h"

namespace limber::program {
namespace {

ExitCode run(const PairArguments& arguments) {
  const Pair pair(arguments);
  const auto [result, elapsed_us] = ask(pair.a(), pair.b(), [](const auto& a, const auto& b) { return collide(a, b); });
  const auto witness = with_faces(result.witness, pair.a().model, pair.b().model);
  const Nesting nesting = result.is_yes() ? Nesting::none : nesting_of(pair.a(), pair.b());
  if (arguments.json) {
    Json json = {{"query", "collide"}, {"collision", result.is_yes()}};
    json["witness"] = to_json(witness);
    json["inside"] = to_json(nesting);
    append_work(json, result.stats, pair.build_us(), elapsed_us);
    write(to_line(json));
  } else {
    write_line("collision {}", result.is_yes() ? "yes" : "no");
    write_lines(witness);
    write_work_lines(result.stats, pair.build_us(), elapsed_us);
  }
  warn_about(nesting, "collide");
  return arguments.exit_code && result.is_yes() ? ExitCode::found : ExitCode::answered;
}

}  // namespace

Verb add_collide(CLI::App& app) {
  const auto arguments = std::make_shared<PairArguments>();
  CLI::App& command = *app.add_subcommand("collide", "Whether two models meet, and where");
  add_pair_arguments(command, *arguments, "the models collide");
  command.footer(R"(
Touching is meeting. Models are surfaces, not solids: one wholly inside the other does not meet it. Where a closed
model has the other inside, a warning says so, and the field inside in JSON.

The witness is a point in the world frame, in the meshes' length unit, once as a point of A and once as a point of B.
The triangles and the faces of the files that it lies on are counted from 0. Times are in microseconds.
)");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

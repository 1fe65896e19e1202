// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>

#include "command/options.h"
#include "command/output.h"
#include "command/terminal.h"
#include "command/text.h"
#include "command/verb.h"
#include "haptics/haptic_report.h"
#include "haptics/haptic_run.h"

namespace limber::program {
namespace {

constexpr std::size_t most_ticks = 5'000'000;  // which take 250 MB
constexpr CountRange triangle_range{1000, 4'000'000};

// What a tick's work may take if the user does not say: a part of the period, so that a late start does not miss it,
// and at most what ticks in contact seldom need. docs/guide/haptics.md has the measurements.
constexpr double budget_part_of_period = 0.45, most_automatic_us = 130;

struct Arguments {
  LoopOptions loop;
  std::optional<double> tick_budget_us;
  std::optional<std::uint64_t> core, max_missed;
  std::string out, report, command_line;
  bool is_quiet = false;
  bool json = false;
};

int chosen_core(const Arguments& arguments) {
  const std::vector<int> cores = allowed_cores();
  const int core = arguments.core ? static_cast<int>(*arguments.core) : cores.empty() ? 0 : cores.back();
  if (may_run_on(core)) return core;
  throw BadInput(fmt::format("--core: {} is no core that may be used; there are {}", core, fmt::join(cores, ", ")));
}

std::chrono::nanoseconds tick_budget(const Arguments& arguments) {
  const double automatic_us = std::min(budget_part_of_period * 1e6 / arguments.loop.scene.rate_hz, most_automatic_us);
  return std::chrono::nanoseconds(std::llround(1e3 * arguments.tick_budget_us.value_or(automatic_us)));
}

void check(const Arguments& arguments) {
  const LoopOptions& loop = arguments.loop;
  const double longest = std::max(loop.seconds, loop.jitter_seconds);
  if (longest * loop.scene.rate_hz > static_cast<double>(most_ticks)) {
    throw BadInput(fmt::format("{}: {:g} seconds at {:g} Hz are more than {} ticks",
                               loop.seconds == longest ? "--seconds" : "--jitter-seconds", longest, loop.scene.rate_hz,
                               most_ticks));
  }
  if (loop.spin_us * loop.scene.rate_hz >= 1e6) {
    throw BadInput(fmt::format("--spin-us: must be less than the period of {:g} us", 1e6 / loop.scene.rate_hz));
  }
  for (const auto& [option, path] : {std::pair("--out", arguments.out), std::pair("--report", arguments.report)}) {
    if (loop.is_empty && !path.empty()) throw BadInput(fmt::format("{}: has nothing to tell of --empty", option));
  }
  if (arguments.report == "-") throw BadInput("--report: must name a file");
}

/// Opened before the loop, so that a path that cannot be written is told at once.
std::unique_ptr<OutputFile> opened(const std::string& option, const std::string& path) {
  return path.empty() ? nullptr : std::make_unique<OutputFile>(option, path);
}

ExitCode run(const Arguments& arguments) {
  check(arguments);
  LoopOptions options = arguments.loop;
  options.core = chosen_core(arguments);
  options.scene.tick_budget = tick_budget(arguments);
  options.shows_progress = !arguments.is_quiet && is_terminal(stderr);
  const std::unique_ptr<OutputFile> out = opened("--out", arguments.out), report = opened("--report", arguments.report);
  const HapticRun run = run_haptics(options);
  const HapticSummary summary = summary_of(run);
  if (out) out->write(ticks_csv(run));
  if (report) report->write(haptic_page(run, summary, arguments.command_line));
  if (arguments.out != "-") write(arguments.json ? to_line(to_json(run, summary)) : summary_text(run, summary));
  const bool misses_too_many = arguments.max_missed && summary.missed > *arguments.max_missed;
  return misses_too_many ? ExitCode::found : ExitCode::answered;
}

void add_loop_options(CLI::App& command, Arguments& arguments) {
  LoopOptions& loop = arguments.loop;
  add_number(command, "--rate", loop.scene.rate_hz, {1, 100'000, "a number from 1 to 100000"}, "ticks in a second")
      ->type_name("HZ");
  add_number(command, "--seconds", loop.seconds, {0, 86'400, "a number from 0 to 86400"}, "how long the loop runs")
      ->type_name("NUMBER");
  add_number(command, "--jitter-seconds", loop.jitter_seconds, {0, 86'400, "a number from 0 to 86400"},
             "how long a loop that only waits runs before it, to show what the machine is like; 0 for none");
  command.add_flag("--empty", loop.is_empty, "run the loop that only waits, and nothing else");
  add_number(command, "--spin-us", loop.spin_us, {0, 1e6, "a number from 0 to 1e6"},
             "how long before each tick the loop stops sleeping and looks at the clock instead")
      ->type_name("US");
}

void add_scene_options(CLI::App& command, Arguments& arguments) {
  HapticOptions& scene = arguments.loop.scene;
  add_count(command, "--tissue", scene.tissue_triangles, triangle_range, "how many triangles the tissue has, at most");
  add_count(command, "--tool", scene.tool_triangles, triangle_range, "how many triangles the tool has, at most");
  add_relative_error(command, scene.relative_error);
  add_number(command, "--tick-budget-us", arguments.tick_budget_us,
             {std::numeric_limits<double>::denorm_min(), 1e6, "a number > 0, at most 1e6"},
             "how long the work of a tick may take: the query has what moves and commit leave; without it 45 % of the "
             "period, at most 130")
      ->type_name("US");
}

}  // namespace

Verb add_haptics(CLI::App& app, const std::string& command_line) {
  const auto arguments = std::make_shared<Arguments>();
  arguments->command_line = command_line;
  CLI::App& command = *app.add_subcommand("haptics", "A force loop at a fixed rate: a tool presses deforming tissue");
  add_loop_options(command, *arguments);
  add_scene_options(command, *arguments);
  add_count(command, "--core", arguments->core, {0, 1023}, "the core that the loop runs on; without it the last");
  add_count(command, "--max-missed", arguments->max_missed, {0, most_ticks},
            "exit with 3 instead of 0 when more ticks than that have missed their period");
  add_table(command, arguments->out, "where a row for each tick is written");
  command.add_option("--report", arguments->report, "also write a page with charts")->type_name("FILE");
  command.add_flag("--quiet", arguments->is_quiet, "show no progress");
  add_json(command, arguments->json, "answer with one JSON object instead of a table");
  command.parse_complete_callback([&command] { check_table(command); });
  command.footer(R"(
Each tick moves the tool along a path that depends on the tick's number alone, dents the tissue below it and lets
earlier dents come back, commits, asks for the distance in what is left of the tick's budget, and answers with the
force of a spring between the tool and its place in front of the tissue. Lengths are in mm, times in microseconds.

The loop runs in a thread of its own, on one core, with real-time priority and locked memory where the system grants
them; the answer says which it got. A tick whose work ends after its period is missed; none is left out.
docs/guide/haptics.md tells how to prepare a machine and how to read the answer.
)");
  return {&command, [arguments] { return run(*arguments); }};
}

}  // namespace limber::program

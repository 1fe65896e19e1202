// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "command/options.h"
#include "command/output.h"
#include "command/run_files.h"
#include "command/text.h"
#include "command/verb.h"
#include "demo/demo_run.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

struct DemoArguments {
  DemoOptions demo;
  std::string report = "limber-demo.html";
  std::string command_line;
  bool is_unchecked = false;
  bool json = false;
};

/// So that the page is found wherever the reader of the answer is.
std::string absolute_path(const std::string& path) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::absolute(path, failure);
  return failure ? path : absolute.string();
}

Json json_of(const Spread& spread) {
  Json json = {{"median", spread.median}, {"max", spread.max}};
  if (spread.p99) json["p99"] = *spread.p99;
  return json;
}

const char* check_word(const DemoRun& run) {
  if (!run.is_right) return "skipped";
  if (!*run.is_right) return "different";
  return run.options.query.relative_error == 0 ? "equal" : "within_error";
}

Json as_json(const DemoRun& run, const std::string& page) {
  const DemoSummary summary = summary_of(run.frames);
  return {
      {"query", "demo"},
      {"frames", run.frames.size()},
      {"dents_per_frame", run.options.dents_per_frame},
      {"seed", run.options.seed},
      {"relative_error", run.options.query.relative_error},
      {"motion_margin", run.options.model.motion_margin},
      {"moved_vertices", summary.updates.moved_vertices},
      {"refits", summary.updates.refits},
      {"absorbed", summary.updates.absorbed},
      {"update_us", json_of(summary.update_us)},
      {"query_us", json_of(summary.answer_us)},
      {"rough_query_us", json_of(summary.rough_us)},
      {"min_distance", summary.min_distance},
      {"contact_frames", summary.contact_frames},
      {"wall_s", run.wall_s},
      {"brute_force", check_word(run)},
      {"page", page},
  };
}

void check(DemoRun& run, bool is_silent) {
  if (!is_silent) {
    write_line("checking the last frame against brute force ...");
    flush();
  }
  run.is_right = is_confirmed_by_brute_force(run);
}

void run(const DemoArguments& arguments) {
  if (arguments.report == "-") throw BadInput("--report: must name a file");
  const std::string page = absolute_path(arguments.report);
  OutputFile file("--report", page);
  ProgressBar bar(arguments.demo.frames, "frames");
  DemoRun run = run_demo(arguments.demo, [&bar](std::size_t done) { bar.draw(done); });
  bar.clear();
  if (!arguments.is_unchecked) check(run, arguments.json);
  file.write(demo_page(run, arguments.command_line));
  if (arguments.json) {
    write(to_line(as_json(run, page)));
  } else {
    for (const auto& [name, text] : summary_rows(run)) write_line("{:<22}{}", name, text);
    write_line("{:<22}{}", "page", page);
  }
  if (run.is_right == false) throw std::logic_error("brute force gives another distance for the last frame");
}

}  // namespace

Verb add_demo(CLI::App& app, const std::string& command_line) {
  const auto arguments = std::make_shared<DemoArguments>();
  arguments->command_line = command_line;
  CLI::App& command = *app.add_subcommand("demo", "A ball flies over a deforming sheet; writes a page about it");
  DemoOptions& demo = arguments->demo;
  add_count(command, "--frames", demo.frames, {1, Replay::most_rows}, "how many frames are played");
  add_count(command, "--dents-per-frame", demo.dents_per_frame, {0, 1'000},
            "dents in each frame; one moves about 116 of the 10 201 vertices");
  add_count(command, "--seed", demo.seed, {}, "seed of the random dents");
  add_relative_error(command, demo.query.relative_error);
  add_motion_margin(command, demo.model);
  command.add_option("--report", arguments->report, "where the page is written")
      ->type_name("FILE")
      ->capture_default_str()
      ->take_last();
  command.add_flag("--no-check", arguments->is_unchecked, "do not compare the last frame with brute force");
  add_json(command, arguments->json, "answer with one JSON object instead of a table");
  command.footer(
      "The sheet has 20 000 triangles and 100 units a side, the ball 1024 triangles and a diameter of 2 units. Every\n"
      "frame dents the sheet, refits its tree, and asks for the distance: at --relative-error and, to compare,\n"
      "at 0.1. Times are per frame, in microseconds; percentiles are given from 100 frames on.");
  return {&command, [arguments] { return run(*arguments), ExitCode::answered; }};
}

}  // namespace limber::program

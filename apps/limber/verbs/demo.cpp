// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <system_error>

#include "command/options.h"
#include "command/output.h"
#include "command/text.h"
#include "command/verb.h"
#include "demo/demo_run.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

struct DemoArguments {
  DemoOptions demo;
  std::string page = "limber-demo.html";
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

std::string distance_text(const DistanceResult& answer) {
  if (answer.status == Status::collision) return "in contact";
  if (answer.status == Status::exact) return fmt::format("{:.4f}", answer.upper);
  return fmt::format("{:.4f} to {:.4f}", answer.lower, answer.upper);
}

/// Shows a running demonstration on standard output: on a terminal a table redrawn in place, otherwise a line now and
/// then.
class DemoTable {
 public:
  explicit DemoTable(std::size_t frame_count) : frame_count_(frame_count), on_terminal_(isatty(STDOUT_FILENO) != 0) {}

  void show(const std::vector<DemoFrame>& frames) {
    constexpr double redraw_s = 0.25;
    constexpr std::size_t lines_in_a_pipe = 10;
    const std::size_t done = frames.size();
    const std::size_t step = on_terminal_ ? 1 : std::max<std::size_t>(1, frame_count_ / lines_in_a_pipe);
    const bool is_due = !on_terminal_ || !stands_ || since_drawn_.seconds() > redraw_s;
    if (done != frame_count_ && (!is_due || done % step != 0)) return;
    if (on_terminal_) {
      redraw(frames);
    } else {
      const DemoFrame& now = frames.back();
      write_line("frame {:>5}/{}  update {:>9}  query {:>9}  distance {}", done, frame_count_,
                 duration_text(now.update_us), duration_text(now.answer_us), distance_text(now.answer));
    }
    flush();
  }

 private:
  void redraw(const std::vector<DemoFrame>& frames) {
    const DemoFrame& now = frames.back();
    const DemoSummary so_far = summary_of(frames);
    if (stands_) write("\033[8A");  // up by as many lines as follow
    write_line("\033[K\033[1mlimber demo\033[0m   frame {} of {}, {} %", frames.size(), frame_count_,
               100 * frames.size() / frame_count_);
    write_line("\033[K  {:<22}{:>11}{:>11}{:>11}{:>11}", "time per frame", "now", "median", "p99", "max");
    const auto write_times = [](const std::string& name, double now_us, const Spread& spread) {
      write_line("\033[K  {:<22}{:>11}{:>11}{:>11}{:>11}", name, duration_text(now_us), duration_text(spread.median),
                 spread.p99 ? duration_text(*spread.p99) : "-", duration_text(spread.max));
    };
    write_times("update", now.update_us, so_far.update_us);
    write_times("distance", now.answer_us, so_far.answer_us);
    write_times(fmt::format("distance within {:g} %", 100 * rough_error), now.rough_us, so_far.rough_us);
    write_line("\033[K  {:<22}{:>11}", "distance, units", distance_text(now.answer));
    write_line("\033[K  {:<22}{:>11}", "frames in contact", so_far.contact_frames);
    write_line("\033[K  {:<22}{:>11}", "vertices moved", grouped(so_far.updates.moved_vertices));
    stands_ = true;
    since_drawn_ = Stopwatch();
  }

  std::size_t frame_count_;
  bool on_terminal_;
  bool stands_ = false;
  Stopwatch since_drawn_;
};

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
      {"engine", to_text(run.options.model.engine)},
      {"upkeep", words_of(run.options.model)},
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
  const std::string page = absolute_path(arguments.page);
  OutputFile file("--out", page, {}, {standard_output});
  DemoTable table(arguments.demo.frames);
  DemoRun run = run_demo(arguments.demo, [&](const std::vector<DemoFrame>& frames) {
    if (!arguments.json) table.show(frames);
  });
  if (!arguments.is_unchecked) check(run, arguments.json);
  file.write(demo_page(run, arguments.command_line));
  if (arguments.json) {
    write(to_line(as_json(run, page)));
  } else {
    write("\n");
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
  add_deforming(command, demo.model);
  command.add_option("--out", arguments->page, "where the page is written")
      ->type_name("FILE")
      ->capture_default_str()
      ->take_last();
  command.add_flag("--no-check", arguments->is_unchecked, "do not compare the last frame with brute force");
  add_json(command, arguments->json, "answer with one JSON object instead of tables");
  command.footer(
      "The sheet has 20 000 triangles and 100 units a side, the ball 1024 triangles and a diameter of 2 units. Every\n"
      "frame dents the sheet, refits its tree, and asks for the distance: at --relative-error and, to compare,\n"
      "at 0.1. Times are per frame, in microseconds; percentiles are given from 100 frames on.");
  return {&command, [arguments] { return run(*arguments), ExitCode::answered; }};
}

}  // namespace limber::program

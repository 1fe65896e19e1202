// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo/demo_table.h"
#include "limber/distance.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>

#include "command/options.h"
#include "command/output.h"
#include "command/text.h"

namespace limber::program {
namespace {

constexpr double redraw_s = 0.25;
constexpr std::size_t lines_in_a_pipe = 10;

std::string check_text(const DemoRun& run) {
  if (!run.is_right) return "not checked against brute force";
  if (!*run.is_right) return "checked against brute force: DIFFERENT";
  return run.options.query.relative_error == 0 ? "checked against brute force: equal"
                                               : "checked against brute force: within the asked error";
}

std::string distance_text(const DistanceResult& answer) {
  if (answer.status == Status::collision) return "in contact";
  if (answer.status == Status::exact) return fmt::format("{:.4f}", answer.upper);
  return fmt::format("{:.4f} to {:.4f}", answer.lower, answer.upper);
}

std::string table_row(const char* name, double now, const Spread& spread) {
  return fmt::format("\033[K  {:<22}{:>11}{:>11}{:>11}{:>11}\n", name, duration_text(now), duration_text(spread.median),
                     spread.p99 ? duration_text(*spread.p99) : "-", duration_text(spread.max));
}

/// "median 20 us, p99 85 us, max 212 us", without a percentile where there are too few frames for one.
std::string spread_text(const Spread& spread) {
  const std::string p99 = spread.p99 ? fmt::format("p99 {}, ", duration_text(*spread.p99)) : std::string();
  return fmt::format("median {}, {}max {}", duration_text(spread.median), p99, duration_text(spread.max));
}

}  // namespace

DemoTable::DemoTable(std::size_t frame_count) : frame_count_(frame_count), on_terminal_(isatty(STDOUT_FILENO) != 0) {}

void DemoTable::show(const std::vector<DemoFrame>& frames) {
  const std::size_t done = frames.size();
  if (on_terminal_) {
    if (done == frame_count_ || !stands_ || since_drawn_.seconds() > redraw_s) redraw(frames);
    return;
  }
  const std::size_t step = std::max<std::size_t>(1, frame_count_ / lines_in_a_pipe);
  if (done % step != 0 && done != frame_count_) return;
  const DemoFrame& now = frames.back();
  write_line("frame {:>5}/{}  update {:>9}  query {:>9}  distance {}", done, frame_count_, duration_text(now.update_us),
             duration_text(now.answer_us), distance_text(now.answer));
  flush();
}

void DemoTable::redraw(const std::vector<DemoFrame>& frames) {
  const DemoFrame& now = frames.back();
  const DemoSummary so_far = summary_of(frames);
  constexpr int lines = 8;
  std::string text = stands_ ? fmt::format("\033[{}A", lines) : std::string();
  text += fmt::format("\033[K\033[1mlimber demo\033[0m   frame {} of {}, {} %\n", frames.size(), frame_count_,
                      100 * frames.size() / frame_count_);
  text += fmt::format("\033[K  {:<22}{:>11}{:>11}{:>11}{:>11}\n", "time per frame", "now", "median", "p99", "max");
  text += table_row("update", now.update_us, so_far.update_us);
  text += table_row("distance", now.answer_us, so_far.answer_us);
  text += table_row(fmt::format("distance within {:g} %", 100 * rough_error).c_str(), now.rough_us, so_far.rough_us);
  text += fmt::format("\033[K  {:<22}{:>11}\n", "distance, units", distance_text(now.answer));
  text += fmt::format("\033[K  {:<22}{:>11}\n", "frames in contact", so_far.contact_frames);
  text += fmt::format("\033[K  {:<22}{:>11}\n", "vertices moved", grouped(so_far.updates.moved_vertices));
  write(text);
  flush();
  stands_ = true;
  since_drawn_ = Stopwatch();
}

std::vector<std::pair<std::string, std::string>> summary_rows(const DemoRun& run) {
  const DemoSummary summary = summary_of(run.frames);
  const DemoOptions& options = run.options;
  const bool is_fast = options.model.engine == DeformingEngine::fast;
  std::vector<std::pair<std::string, std::string>> rows = {
      {"frames",
       fmt::format("{} in {:.2f} s, {} of them in contact", run.frames.size(), run.wall_s, summary.contact_frames)},
      {"dents", fmt::format("{} a frame, seed {}", options.dents_per_frame, options.seed)},
      {"vertices moved", fmt::format("{}, {} each on average", grouped(summary.updates.moved_vertices),
                                     duration_text(summary.update_us_per_vertex))},
      {"tree", fmt::format("{} refits of {}, {} {} absorbed ({})", grouped(summary.updates.refits),
                           is_fast ? "nodes" : "spheres", grouped(summary.updates.absorbed),
                           is_fast ? "moves" : "spheres", words_of(options.model))},
      {"update", spread_text(summary.update_us)},
      {options.query.relative_error == 0 ? std::string("exact distance")
                                         : fmt::format("distance within {:g} %", 100 * options.query.relative_error),
       spread_text(summary.answer_us)},
      {fmt::format("distance within {:g} %", 100 * rough_error), spread_text(summary.rough_us)},
      {"smallest distance", fmt::format("{:.6g} units", summary.min_distance)},
      {"last frame", check_text(run)},
  };
#ifdef LIMBER_CHECKS
  rows.emplace_back("build", "with checks on, so times are much longer than in a release build");
#endif
  return rows;
}

}  // namespace limber::program

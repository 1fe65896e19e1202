// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo/demo_run.h"

#include <fmt/format.h>

#include <utility>
#include <vector>

#include "command/text.h"
#include "formats/scenes.h"
#include "reports/page_template.h"
#include "verbs/replay.h"

namespace limber::program {
namespace {

/// More frames than fit are thinned out.
constexpr std::uint64_t max_megabytes = 8;

TrackRow row_of(std::size_t number, const DemoFrame& frame) {
  TrackRow row;
  row.frame = number;
  row.update = frame.update;
  row.query_us = frame.answer_us;
  row.result = frame.answer;
  if (const auto& found = frame.answer.witness) {
    row.witness = FoundWitness{*found, found->triangle_a, found->triangle_b};  // each is a face of its own
  }
  return row;
}

std::string introduction(const DemoRun& run) {
  return fmt::format(
      "A sheet of {} triangles, 100 units a side, is dented {} in each of {} frames, while a ball of {} triangles and "
      "a diameter of 2 units flies over it on a closed curve. In every frame the tree of the sheet is refitted where "
      "the sheet has changed and nowhere else. Then a query asks for the shortest distance between the two surfaces, "
      "with the pair of points that attains it; it starts without a cache. A second one allows an error of {:g} %.",
      grouped(run.sheet.triangles().size()),
      run.options.dents_per_frame == 1 ? "once" : fmt::format("{} times", run.options.dents_per_frame),
      grouped(run.frames.size()), grouped(run.ball.triangles().size()), 100 * rough_error);
}

/// What only the page of the demonstration has: texts, and the second query of each frame.
Json demo_json(const DemoRun& run) {
  Json rough = {
      {"relative_error", rough_error}, {"lower", Json::array()}, {"upper", Json::array()}, {"query_us", Json::array()}};
  for (const DemoFrame& frame : run.frames) {
    rough["lower"].push_back(frame.rough.lower);
    rough["upper"].push_back(frame.rough.upper);
    rough["query_us"].push_back(frame.rough_us);
  }
  return {{"introduction", introduction(run)}, {"summary", summary_rows(run)}, {"rough", std::move(rough)}};
}

std::string check_text(const DemoRun& run) {
  if (!run.is_right) return "not checked against brute force";
  if (!*run.is_right) return "checked against brute force: DIFFERENT";
  return run.options.query.relative_error == 0 ? "checked against brute force: equal"
                                               : "checked against brute force: within the asked error";
}

/// "median 20 us, p99 85 us, max 212 us", without a percentile where there are too few frames for one.
std::string spread_text(const Spread& spread) {
  const std::string p99 = spread.p99 ? fmt::format("p99 {}, ", duration_text(*spread.p99)) : std::string();
  return fmt::format("median {}, {}max {}", duration_text(spread.median), p99, duration_text(spread.max));
}

}  // namespace

std::vector<std::pair<std::string, std::string>> summary_rows(const DemoRun& run) {
  const DemoSummary summary = summary_of(run.frames);
  const DemoOptions& options = run.options;
  std::vector<std::pair<std::string, std::string>> rows = {
      {"frames",
       fmt::format("{} in {:.2f} s, {} of them in contact", run.frames.size(), run.wall_s, summary.contact_frames)},
      {"dents", fmt::format("{} a frame, seed {}", options.dents_per_frame, options.seed)},
      {"vertices moved", fmt::format("{}, {} each on average", grouped(summary.updates.moved_vertices),
                                     duration_text(summary.update_us_per_vertex))},
      {"tree", fmt::format("{} refits of nodes, {} moves absorbed ({})", grouped(summary.updates.refits),
                           grouped(summary.updates.absorbed), words_of(options.model))},
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

std::string demo_page(const DemoRun& run, const std::string& command_line) {
  const Mesh first_sheet = scenes::thesis_sheet();
  Replay replay(
      {run.frames.size(), run.frames.size(), {}, {}, words_of(run.options.model), run.options.query, {}, max_megabytes},
      {ReplayedModel{"sheet", first_sheet, true, false}, ReplayedModel{"ball", run.ball, false, true}});
  replay_sheet(run.options, [&](std::size_t f, std::span<const Vec3> positions) {
    const DemoFrame& frame = run.frames[f];
    replay.add(row_of(f, frame), {ReplayedState{positions, {}}, ReplayedState{run.ball.positions(), frame.ball_pose}});
  });
  Json data = replay.to_json();
  data["demo"] = demo_json(run);
  return filled_page(std::move(data), command_line);
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_reduce.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "command/output.h"
#include "command/text.h"
#include "command/verb.h"
#include "formats/scenes.h"
#include "limber/geometry.h"
#include "reports/page_template.h"
#include "verbs/replay.h"

/// The demonstration: a sheet is dented again and again while a ball flies over it.
namespace limber::program {
namespace {

struct DemoArguments {
  std::uint64_t frames = 600;
  std::uint64_t dents_per_frame = 2;
  std::uint64_t seed = 1;
  DistanceOptions query;
  ModelOptions model;
  ReportArguments report;
  bool is_unchecked = false;
};

/// A second query in each frame is asked at this error, to show what an approximate answer costs and gives.
constexpr double rough_error = 0.1;
/// The largest size of the page. If all frames take more, the page leaves some out.
constexpr std::uint64_t most_megabytes = 8;

struct DemoFrame {
  Transform ball_pose;
  TreeUpdate update;      ///< of this frame alone
  DistanceResult answer;  ///< at the error asked for
  double answer_us = 0;
  DistanceResult rough;  ///< at `rough_error`
  double rough_us = 0;
};

struct DemoRun {
  const DemoArguments& arguments;
  std::vector<DemoFrame> frames;
  Mesh sheet;  ///< as it is in the last frame
  Mesh ball;
  double wall_s = 0;             ///< of all frames
  std::optional<bool> is_right;  ///< whether brute force confirms the last frame; empty when not checked
};

Mesh first_sheet() { return scenes::grid(100, 100, 0, 0, 1, 1); }

constexpr double turn = 2 * std::numbers::pi;

/// The typical height of a sheet after so many dents: each covers a hundredth of it and moves a vertex by half a unit,
/// up or down at random.
double roughness(std::uint64_t dents) { return 0.06 * std::sqrt(static_cast<double>(dents)); }

/// Where the ball is at `time` in [0, 1]: on a closed Lissajous curve over the sheet, turning, in waves as high as the
/// sheet is rough, so that it mostly stays close and sometimes touches.
Transform ball_pose_at(double time, double rough) {
  const Vec3 center{50 + 38 * scenes::sine(turn * 3 * time + 0.5), 50 + 38 * scenes::sine(turn * 2 * time),
                    1.6 + 1.8 * rough + (0.5 + 0.9 * rough) * scenes::sine(turn * 5 * time - 1.2)};
  const double half_angle = turn * 4 * time;
  const double s = scenes::sine(half_angle);
  return transform_from_quaternion(center, scenes::cosine(half_angle), 0.6 * s, 0.8 * s, 0).value();
}

struct VertexMoves {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
};

/// A random dent of the sheet: all vertices within a radius of a vertical line move along z in proportion to their
/// distance from it.
VertexMoves next_moves(scenes::Rng& rng, std::span<const Vec3> positions) {
  const double x = 100 * rng.uniform(), y = 100 * rng.uniform(), radius = 1 + 9 * rng.uniform();
  const double slope = (rng.next() & 1) != 0 ? 0.1 : -0.1;  // displacement per unit of distance
  VertexMoves moves;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = positions[i];
    const double dx = p.x - x, dy = p.y - y, distance = std::sqrt(dx * dx + dy * dy);
    if (distance > radius) continue;
    moves.ids.push_back(static_cast<VertexId>(i));
    moves.positions.push_back({p.x, p.y, p.z + slope * distance});
  }
  return moves;
}

/// Dents the sheet, timing only what the model does.
TreeUpdate dent(Model& sheet, scenes::Rng& rng, std::uint64_t dents) {
  const MaintenanceStats before = sheet.maintenance_stats();
  double elapsed_us = 0;
  for (std::uint64_t d = 0; d < dents; ++d) {
    const VertexMoves moves = next_moves(rng, sheet.mesh().positions());
    const Stopwatch moving;
    value_or_bad_input(sheet.move_vertices(moves.ids, moves.positions));
    elapsed_us += moving.microseconds();
  }
  const Stopwatch committing;
  sheet.commit();
  return work_since(before, sheet, elapsed_us + committing.microseconds());
}

/// Plays all frames and checks nothing.
DemoRun played(const DemoArguments& arguments) {
  Model sheet(first_sheet(), arguments.model);
  const Model ball(scenes::ball(32, 17), arguments.model);
  scenes::Rng rng(arguments.seed);
  std::vector<DemoFrame> frames(arguments.frames);
  const Stopwatch playing;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    DemoFrame& frame = frames[f];
    const double time = static_cast<double>(f) / static_cast<double>(frames.size());
    frame.ball_pose = ball_pose_at(time, roughness(f * arguments.dents_per_frame));
    frame.update = dent(sheet, rng, arguments.dents_per_frame);
    const Stopwatch asking;
    frame.answer = distance({sheet}, {ball, frame.ball_pose}, arguments.query);
    frame.answer_us = asking.microseconds();
    const Stopwatch asking_roughly;
    frame.rough = distance({sheet}, {ball, frame.ball_pose}, {.relative_error = rough_error});
    frame.rough_us = asking_roughly.microseconds();
  }
  const double wall_s = playing.seconds();
  return {arguments, std::move(frames), sheet.mesh(), ball.mesh(), wall_s, std::nullopt};
}

/// The distance of two meshes, each triangle of one against each of the other: no tree and no tricks.
double brute_force_distance(MeshView a, MeshView b, const Transform& a_from_b) {
  std::vector<Vec3> positions(b.positions.size());
  std::transform(b.positions.begin(), b.positions.end(), positions.begin(), a_from_b);
  const MeshView placed{positions, b.triangles};
  using Range = oneapi::tbb::blocked_range<TriangleId>;
  const auto least_of = [&](const Range& range, double least) {
    for (TriangleId i = range.begin(); i < range.end(); ++i) {
      for (TriangleId j = 0; j < placed.triangles.size(); ++j) {
        least = std::min(least, closest_points(a.triangle(i), placed.triangle(j)).distance);
      }
    }
    return least;
  };
  return oneapi::tbb::parallel_reduce(Range(0, static_cast<TriangleId>(a.triangles.size())),
                                      std::numeric_limits<double>::infinity(), least_of,
                                      [](double x, double y) { return std::min(x, y); });
}

/// Whether an answer is right about the exact distance, up to the rounding of both.
bool is_confirmed(const DistanceResult& answer, double relative_error, double exact) {
  const double tolerance = 1e-12 * (1 + exact);
  return answer.lower <= exact + tolerance && exact <= answer.upper + tolerance &&
         answer.upper <= (1 + relative_error) * exact + tolerance;
}

/// Whether brute force gives the distance of the last frame, up to rounding. Takes a while.
bool is_confirmed_by_brute_force(const DemoRun& run) {
  const DemoFrame& last = run.frames.back();
  const double exact = brute_force_distance(run.sheet, run.ball, last.ball_pose);
  return is_confirmed(last.answer, run.arguments.query.relative_error, exact) &&
         is_confirmed(last.rough, rough_error, exact);
}

/// "median 20 us, p99 85 us, max 212 us", without a percentile where there are too few frames for one.
std::string spread_text(const std::vector<DemoFrame>& frames, auto value_of) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const DemoFrame& frame : frames) values.push_back(std::invoke(value_of, frame));
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size(), rank = (99 * count + 99) / 100;  // of the 99th percentile, from 1
  const std::string p99 = rank < count ? fmt::format("p99 {}, ", duration_text(values[rank - 1])) : std::string();
  return fmt::format("median {}, {}max {}", duration_text(values[(count - 1) / 2]), p99, duration_text(values.back()));
}

std::string check_text(const DemoRun& run) {
  if (!run.is_right) return "not checked against brute force";
  if (!*run.is_right) return "checked against brute force: DIFFERENT";
  return run.arguments.query.relative_error == 0 ? "checked against brute force: equal"
                                                 : "checked against brute force: within the asked error";
}

/// The summary of a run, as pairs of a name and a text with units.
std::vector<std::pair<std::string, std::string>> summary_rows(const DemoRun& run) {
  const DemoArguments& arguments = run.arguments;
  TreeUpdate updates;
  double min_distance = std::numeric_limits<double>::infinity();
  for (const DemoFrame& frame : run.frames) {
    updates += frame.update;
    min_distance = std::min(min_distance, frame.answer.upper);
  }
  const auto in_contact = std::count_if(run.frames.begin(), run.frames.end(), [](const DemoFrame& frame) {
    return frame.answer.status == DistanceStatus::collision;
  });
  const auto moved = std::max<std::uint64_t>(updates.moved_vertices, 1);
  std::vector<std::pair<std::string, std::string>> rows = {
      {"frames", fmt::format("{} in {:.2f} s, {} of them in contact", run.frames.size(), run.wall_s, in_contact)},
      {"dents", fmt::format("{} a frame, seed {}", arguments.dents_per_frame, arguments.seed)},
      {"vertices moved", fmt::format("{}, {} each on average", grouped(updates.moved_vertices),
                                     duration_text(updates.elapsed_us / static_cast<double>(moved)))},
      {"tree", fmt::format("{} refits of nodes, {} moves absorbed ({})", grouped(updates.refits),
                           grouped(updates.absorbed), words_of(arguments.model))},
      {"update", spread_text(run.frames, [](const DemoFrame& frame) { return frame.update.elapsed_us; })},
      {arguments.query.relative_error == 0
           ? std::string("exact distance")
           : fmt::format("distance within {:g} %", 100 * arguments.query.relative_error),
       spread_text(run.frames, &DemoFrame::answer_us)},
      {fmt::format("distance within {:g} %", 100 * rough_error), spread_text(run.frames, &DemoFrame::rough_us)},
      {"smallest distance", fmt::format("{:.6g} units", min_distance)},
      {"last frame", check_text(run)},
  };
#ifdef LIMBER_CHECKS
  rows.emplace_back("build", "with checks on, so times are much longer than in a release build");
#endif
  return rows;
}

std::string introduction(const DemoRun& run) {
  return fmt::format(
      "A sheet of {} triangles, 100 units a side, is dented {} in each of {} frames, while a ball of {} triangles and "
      "a diameter of 2 units flies over it on a closed curve. In every frame the tree of the sheet is refitted where "
      "the sheet has changed and nowhere else. Then a query asks for the shortest distance between the two surfaces, "
      "with the pair of points that attains it; it starts without a cache. A second one allows an error of {:g} %.",
      grouped(run.sheet.triangles().size()),
      run.arguments.dents_per_frame == 1 ? "once" : fmt::format("{} times", run.arguments.dents_per_frame),
      grouped(run.frames.size()), grouped(run.ball.triangles().size()), 100 * rough_error);
}

/// The data that only the page of the demonstration has: its texts, and the second query of each frame.
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

/// The data of a page that plays the run, with charts and its summary. The dents are played once more, on the vertices
/// alone, so that no time of the run has a recording in it, and no cache is full of one.
Json page_of(const DemoRun& run) {
  const DemoArguments& arguments = run.arguments;
  const Mesh sheet = first_sheet();
  Replay replay({run.frames.size(), {}, words_of(arguments.model), arguments.query, {}, most_megabytes},
                {ReplayedModel{"sheet", sheet, true, false}, ReplayedModel{"ball", run.ball, false, true}});
  std::vector<Vec3> positions = sheet.positions();
  scenes::Rng rng(arguments.seed);
  for (std::size_t f = 0; f < run.frames.size(); ++f) {
    for (std::uint64_t d = 0; d < arguments.dents_per_frame; ++d) {
      const VertexMoves moves = next_moves(rng, positions);
      for (std::size_t i = 0; i < moves.ids.size(); ++i) positions[moves.ids[i]] = moves.positions[i];
    }
    const DemoFrame& frame = run.frames[f];
    replay.add(row_of(f, frame), {ReplayedState{positions, {}}, ReplayedState{run.ball.positions(), frame.ball_pose}});
  }
  Json data = replay.to_json();
  data["demo"] = demo_json(run);
  return data;
}

/// So that the page is found wherever the reader of the answer is.
std::string absolute_path(const std::string& path) {
  std::error_code failure;
  const std::filesystem::path absolute = std::filesystem::absolute(path, failure);
  return failure ? path : absolute.string();
}

void run(const DemoArguments& arguments) {
  ReportFile file(arguments.report);
  const std::string page = absolute_path(arguments.report.path);
  DemoRun run = played(arguments);
  if (!arguments.is_unchecked) {
    write_line("checking the last frame against brute force ...");
    flush();
    run.is_right = is_confirmed_by_brute_force(run);
  }
  file.write(page_of(run));
  for (const auto& [name, text] : summary_rows(run)) write_line("{:<22}{}", name, text);
  write_line("{:<22}{}", "page", page);
  if (run.is_right == false) throw std::logic_error("brute force gives another distance for the last frame");
}

}  // namespace

Verb add_demo(CLI::App& app, const std::string& command_line) {
  const auto arguments = std::make_shared<DemoArguments>();
  arguments->report.path = "limber-demo.html";
  arguments->report.command_line = command_line;
  CLI::App& command = *app.add_subcommand("demo", "A ball flies over a deforming sheet; writes a page about it");
  add_count(command, "--frames", arguments->frames, {1, Replay::most_rows}, "how many frames are played");
  add_count(command, "--dents-per-frame", arguments->dents_per_frame, {0, 1'000},
            "dents in each frame; one moves about 116 of the 10 201 vertices");
  add_count(command, "--seed", arguments->seed, {}, "seed of the random dents");
  add_relative_error(command, arguments->query.relative_error);
  add_motion_margin(command, arguments->model);
  command.add_option("--report", arguments->report.path, "where the page is written")
      ->type_name("FILE")
      ->capture_default_str()
      ->take_last();
  command.add_flag("--no-check", arguments->is_unchecked, "do not compare the last frame with brute force");
  command.footer(
      "The sheet has 20 000 triangles and 100 units a side, the ball 1024 triangles and a diameter of 2 units. Every\n"
      "frame dents the sheet, refits its tree, and asks for the distance: at --relative-error and, to compare,\n"
      "at 0.1. Times are per frame, in microseconds; percentiles are given from 100 frames on.");
  return {&command, [arguments] { return run(*arguments), ExitCode::answered; }};
}

}  // namespace limber::program

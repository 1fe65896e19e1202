// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "demo/demo_run.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "command/output.h"
#include "command/text.h"
#include "demo/brute_force.h"
#include "formats/scenes.h"

namespace limber::program {
namespace {

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

scenes::VertexMoves next_moves(scenes::Rng& rng, std::span<const Vec3> positions) {
  return scenes::dent_moves(scenes::random_dent(rng), positions);
}

/// Dents the sheet, timing only what the model does.
TreeUpdate dent(Model& sheet, scenes::Rng& rng, std::uint64_t dents) {
  const MaintenanceStats before = sheet.maintenance_stats();
  double elapsed_us = 0;
  for (std::uint64_t d = 0; d < dents; ++d) {
    const scenes::VertexMoves moves = next_moves(rng, sheet.mesh().positions());
    const Stopwatch moving;
    value_or_bad_input(sheet.move_vertices(moves.ids, moves.positions));
    elapsed_us += moving.microseconds();
  }
  const Stopwatch committing;
  sheet.commit();
  return work_since(before, sheet, elapsed_us + committing.microseconds());
}

/// Whether an answer is right about the exact distance, up to the rounding of both.
bool is_confirmed(const DistanceResult& answer, double relative_error, double exact) {
  const double tolerance = 1e-12 * (1 + exact);
  return answer.lower <= exact + tolerance && exact <= answer.upper + tolerance &&
         answer.upper <= (1 + relative_error) * exact + tolerance;
}

Spread spread_over(const std::vector<DemoFrame>& frames, auto value_of) {
  std::vector<double> values;
  values.reserve(frames.size());
  for (const DemoFrame& frame : frames) values.push_back(std::invoke(value_of, frame));
  std::sort(values.begin(), values.end());
  const std::size_t count = values.size(), rank = (99 * count + 99) / 100;  // of the 99th percentile, from 1
  const auto p99 = rank < count ? std::optional(values[rank - 1]) : std::nullopt;
  return {values[(count - 1) / 2], p99, values.back()};
}

}  // namespace

DemoRun run_demo(const DemoOptions& options, const FrameWatcher& watcher) {
  Model sheet(scenes::thesis_sheet(), options.model);
  const Model ball(scenes::thesis_ball(), options.model);
  scenes::Rng rng(options.seed);
  std::vector<DemoFrame> frames;
  frames.reserve(options.frames);
  const Stopwatch playing;
  while (frames.size() < options.frames) {
    const auto done = static_cast<double>(frames.size());
    const Transform pose =
        ball_pose_at(done / static_cast<double>(options.frames), roughness(frames.size() * options.dents_per_frame));
    DemoFrame frame;
    frame.ball_pose = pose;
    frame.update = dent(sheet, rng, options.dents_per_frame);
    const Stopwatch asking;
    frame.answer = distance({sheet}, {ball, pose}, options.query);
    frame.answer_us = asking.microseconds();
    const Stopwatch asking_roughly;
    frame.rough = distance({sheet}, {ball, pose}, {.relative_error = rough_error});
    frame.rough_us = asking_roughly.microseconds();
    frames.push_back(frame);
    watcher(frames.size());
  }
  const double wall_s = playing.seconds();
  return {options, std::move(frames), sheet.mesh(), ball.mesh(), wall_s, std::nullopt};
}

void replay_sheet(const DemoOptions& options, const SheetWatcher& watcher) {
  std::vector<Vec3> positions = scenes::thesis_sheet().positions();
  scenes::Rng rng(options.seed);
  for (std::size_t f = 0; f < options.frames; ++f) {
    for (std::uint64_t d = 0; d < options.dents_per_frame; ++d) {
      const scenes::VertexMoves moves = next_moves(rng, positions);
      for (std::size_t i = 0; i < moves.ids.size(); ++i) positions[moves.ids[i]] = moves.positions[i];
    }
    watcher(f, positions);
  }
}

bool is_confirmed_by_brute_force(const DemoRun& run) {
  const DemoFrame& last = run.frames.back();
  const double exact = brute_force_distance(run.sheet, run.ball, last.ball_pose);
  return is_confirmed(last.answer, run.options.query.relative_error, exact) &&
         is_confirmed(last.rough, rough_error, exact);
}

DemoSummary summary_of(const std::vector<DemoFrame>& frames) {
  DemoSummary summary;
  summary.min_distance = frames.front().answer.upper;
  for (const DemoFrame& frame : frames) {
    summary.updates += frame.update;
    summary.min_distance = std::min(summary.min_distance, frame.answer.upper);
    if (frame.answer.status == DistanceStatus::collision) ++summary.contact_frames;
  }
  summary.update_us = spread_over(frames, [](const DemoFrame& frame) { return frame.update.elapsed_us; });
  summary.answer_us = spread_over(frames, &DemoFrame::answer_us);
  summary.rough_us = spread_over(frames, &DemoFrame::rough_us);
  if (summary.updates.moved_vertices > 0) {
    summary.update_us_per_vertex = summary.updates.elapsed_us / static_cast<double>(summary.updates.moved_vertices);
  }
  return summary;
}

}  // namespace limber::program

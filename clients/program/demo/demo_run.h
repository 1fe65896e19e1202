// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "verbs/replay.h"

/// The demonstration: a sheet is dented again and again while a ball flies over it.
namespace limber::program {

struct DemoOptions {
  std::uint64_t frames = 600;
  std::uint64_t dents_per_frame = 2;
  std::uint64_t seed = 1;
  DistanceOptions query;
  ModelOptions model;
};

/// A second query in each frame is asked at this error, to show what an approximate answer costs and gives.
inline constexpr double rough_error = 0.1;

struct DemoFrame {
  Transform ball_pose;
  TreeUpdate update;      ///< of this frame alone
  DistanceResult answer;  ///< at the error asked for
  double answer_us = 0;
  DistanceResult rough;  ///< at `rough_error`
  double rough_us = 0;
};

struct DemoRun {
  DemoOptions options;
  std::vector<DemoFrame> frames;
  Mesh sheet;  ///< as it is in the last frame
  Mesh ball;
  double wall_s = 0;             ///< of all frames
  std::optional<bool> is_right;  ///< whether brute force confirms the last frame; empty when not checked
};

/// Called after each frame with the number of frames so far.
using FrameWatcher = std::function<void(std::size_t)>;

/// Plays all frames and checks nothing. Pre: at least one frame.
DemoRun run_demo(const DemoOptions& options, const FrameWatcher& watcher);

/// Called with the frame's number and the positions of the sheet in it.
using SheetWatcher = std::function<void(std::size_t, std::span<const Vec3>)>;

/// Plays the dents once more on the vertices alone: the same positions to the bit. Frames are recorded by this and not
/// in run_demo(), so that no time has a recording in it, and no cache is full of one.
void replay_sheet(const DemoOptions& options, const SheetWatcher& watcher);

/// Whether brute force gives the distance of the last frame, up to rounding. Takes a while.
bool is_confirmed_by_brute_force(const DemoRun& run);

/// Median and maximum of a list of numbers, and the 99th percentile of a list that is long enough to have one.
struct Spread {
  double median = 0;
  std::optional<double> p99;
  double max = 0;
};

/// The summary of a run.
struct DemoSummary {
  TreeUpdate updates;
  Spread update_us, answer_us, rough_us;
  double min_distance = 0;  ///< the smallest upper bound
  std::uint64_t contact_frames = 0;

  double update_us_per_vertex = 0;  ///< all updates by all moved vertices
};
DemoSummary summary_of(const std::vector<DemoFrame>& frames);

/// The summary of a run, as pairs of a name and a text with units.
std::vector<std::pair<std::string, std::string>> summary_rows(const DemoRun& run);

/// A page that plays the run, with charts and its summary. The command line is what the page says about its making.
std::string demo_page(const DemoRun& run, const std::string& command_line);

}  // namespace limber::program

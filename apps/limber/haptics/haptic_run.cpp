// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_run.h"

#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <optional>
#include <stdexcept>
#include <vector>

#include "command/live_line.h"

namespace limber::program {
namespace {

std::chrono::nanoseconds ns(double count) { return std::chrono::nanoseconds(std::llround(count)); }

struct Progress {
  TickProgress empty_loop, loop;
};

/// Of the empty loop, which may be left out.
std::size_t empty_tick_count(const LoopOptions& options) {
  const double seconds = options.is_empty ? options.seconds : options.jitter_seconds;
  return seconds > 0 ? tick_count(options.scene.rate_hz, seconds) : 0;
}

/// Plays both loops with what the operating system grants. The scene, if there is one, has been warmed up to `first`.
void play(HapticRun& run, HapticScene* scene, std::uint64_t first, Progress& progress) {
  const TickSchedule schedule{ns(1e9 / run.options.scene.rate_hz), ns(1e3 * run.options.spin_us)};
  const TickWork nothing = [](std::uint64_t, TickSample&) {};
  const TickWork tick = [scene](std::uint64_t number, TickSample& sample) { scene->tick(number, sample); };
  const MemoryLock lock;
  const RealTimePriority priority;
  run.locked_memory = lock.granted();
  run.priority = priority.granted();
  run_ticks(schedule, 0, nothing, run.empty_ticks, progress.empty_loop);
  if (scene != nullptr) run_ticks(schedule, first, tick, run.ticks, progress.loop);
}

void play_scene(HapticRun& run, Progress& progress) {
  HapticScene scene(run.options.scene);
  const std::uint64_t first = scene.warm_up();
  run.ticks.resize(tick_count(run.options.scene.rate_hz, run.options.seconds));
  const std::uint64_t rebuilt_before = scene.tissue().maintenance_stats().rebuilt_triangles;
  play(run, &scene, first, progress);
  run.rebuilt_triangles = scene.tissue().maintenance_stats().rebuilt_triangles - rebuilt_before;
  run.tissue_triangles = scene.tissue().mesh().triangles().size();
  run.tool_triangles = scene.tool().mesh().triangles().size();
  run.node_tests_over_new_tree = node_tests_over_new_tree(scene);
}

}  // namespace

std::size_t tick_count(double rate_hz, double seconds) {
  return static_cast<std::size_t>(std::max(1LL, std::llround(rate_hz * seconds)));
}

HapticRun run_haptics(const LoopOptions& options) {
  // A commit in a loop does not wait for other threads.
  using oneapi::tbb::global_control;
  const global_control one_thread(global_control::max_allowed_parallelism, 1);
  HapticRun run;
  run.options = options;
  run.empty_ticks.resize(empty_tick_count(options));
  Progress progress;
  std::optional<LiveLine> line;
  if (options.shows_progress) {
    line.emplace(
        std::vector<LiveLine::Loop>{
            {"empty loop", run.empty_ticks.size(), &progress.empty_loop},
            {"loop", options.is_empty ? 0 : tick_count(options.scene.rate_hz, options.seconds), &progress.loop}},
        options.core);
  }
  std::async(std::launch::async, [&] {
    if (!run_on({options.core})) throw std::runtime_error("the core of the loop has been taken away");
    options.is_empty ? play(run, nullptr, 0, progress) : play_scene(run, progress);
  }).get();
  return run;
}

}  // namespace limber::program

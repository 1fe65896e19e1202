// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/haptic_run.h"

#include <fmt/format.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <stdexcept>
#include <vector>

#include "command/output.h"
#include "command/text.h"

namespace limber::program {
namespace {

std::chrono::nanoseconds ns(double count) { return std::chrono::nanoseconds(std::llround(count)); }

struct Progress {
  TickProgress empty_loop, loop;
};

/// At least 1.
std::size_t tick_count(double rate_hz, double seconds) {
  return static_cast<std::size_t>(std::max(1LL, std::llround(rate_hz * seconds)));
}

/// How many ticks the empty loop makes; 0 if it is left out.
std::size_t empty_tick_count(const LoopOptions& options) {
  const double seconds = options.is_empty ? options.seconds : options.jitter_seconds;
  return seconds > 0 ? tick_count(options.scene.rate_hz, seconds) : 0;
}

/// Plays both loops with what the operating system grants. The scene, if there is one, has been warmed up to `first`.
void play(HapticRun& run, HapticScene* scene, std::uint64_t first, Progress& progress) {
  const TickSchedule schedule{ns(1e9 / run.options.scene.rate_hz), ns(1e3 * run.options.spin_us)};
  const TickWork nothing = [](std::uint64_t, TickSample&) {};
  const TickWork tick = [scene](std::uint64_t number, TickSample& sample) { scene->tick(number, sample); };
  const RealTime real_time;
  run.locked_memory = real_time.locked_memory;
  run.priority = real_time.priority;
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

/// A line on standard error, redrawn twice a second until the loops have ended; then it is gone.
void show_until_done(const std::future<void>& playing, const LoopOptions& options, Progress& progress) {
  constexpr std::chrono::milliseconds redraw{500};
  std::vector<int> others = allowed_cores();
  std::erase(others, options.core);
  if (!others.empty()) run_on(others);
  const std::size_t empty_count = empty_tick_count(options);
  const std::size_t count = options.is_empty ? 0 : tick_count(options.scene.rate_hz, options.seconds);
  do {
    const bool is_empty_loop = count == 0 || (empty_count > 0 && progress.loop.done == 0);
    TickProgress& now = is_empty_loop ? progress.empty_loop : progress.loop;
    const double longest_us = 1e-3 * now.longest_work.exchange(0, std::memory_order_relaxed);
    show(fmt::format("\r\033[K{}: tick {} of {}, {} missed, longest work of late {}",
                     is_empty_loop ? "empty loop" : "loop", grouped(now.done),
                     grouped(is_empty_loop ? empty_count : count), grouped(now.missed), duration_text(longest_us)));
  } while (playing.wait_for(redraw) != std::future_status::ready);
  show("\r\033[K");
}

}  // namespace

HapticRun run_haptics(const LoopOptions& options) {
  // A commit in a loop does not wait for other threads.
  using oneapi::tbb::global_control;
  const global_control one_thread(global_control::max_allowed_parallelism, 1);
  HapticRun run;
  run.options = options;
  run.empty_ticks.resize(empty_tick_count(options));
  Progress progress;
  std::future<void> playing = std::async(std::launch::async, [&] {
    if (!run_on({options.core})) throw std::runtime_error("the core of the loop has been taken away");
    options.is_empty ? play(run, nullptr, 0, progress) : play_scene(run, progress);
  });
  if (options.shows_progress) show_until_done(playing, options, progress);
  playing.get();
  return run;
}

}  // namespace limber::program

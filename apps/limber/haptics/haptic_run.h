// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "haptics/haptic_scene.h"
#include "haptics/real_time.h"
#include "haptics/tick_loop.h"

/// The haptic loop without its output, and what it asks of the operating system.
namespace limber::program {

struct LoopOptions {
  HapticOptions scene;
  double seconds = 10;
  double jitter_seconds = 2;  ///< of the empty loop before it; 0 for none
  double spin_us = 30;        ///< what a sleep overruns by is below that most of the time, also on virtual machines
  int core = 0;
  bool is_empty = false;  ///< whether there is only an empty loop, of `seconds`
  bool shows_progress = false;
};

struct HapticRun {
  LoopOptions options;
  Granted priority, locked_memory;
  std::vector<TickSample> empty_ticks;  ///< of the loop that only waits
  std::vector<TickSample> ticks;        ///< of the loop with all its work; empty for an empty run
  std::size_t tissue_triangles = 0, tool_triangles = 0;
  std::uint64_t rebuilt_triangles = 0;  ///< while the ticks ran
  double node_tests_over_new_tree = 0;  ///< at the end
};

/// Runs both loops in a thread of their own, on one core, with what the operating system grants. Everything is
/// allocated and written to before the first tick; the results are looked at after the last. The calling thread shows
/// progress meanwhile, on other cores where there are any: it only looks at counters, so a slow terminal delays no
/// tick.
///
/// Pre      may_run_on(core).
HapticRun run_haptics(const LoopOptions& options);

}  // namespace limber::program

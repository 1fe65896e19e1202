// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <span>

#include "limber/distance.h"

/// A loop at a fixed rate, and what it notes about each of its ticks.
namespace limber::program {

using TickClock = std::chrono::steady_clock;

/// What is noted about one tick. Times are in ns, and end at 4.29 s.
struct TickSample {
  std::uint32_t late = 0;  ///< how long after its time the tick has started
  std::uint32_t move = 0, commit = 0, query = 0, force = 0;
  std::uint32_t work = 0;  ///< from the start of the tick to its end
  std::uint32_t moved_vertices = 0;
  float lower = 0, upper = 0;  ///< of the distance, in mm
  float force_n = 0;
  DistanceStatus status = DistanceStatus::exact;
  bool has_waited = false;  ///< whether the tick before had ended when this one's time came
  bool is_missed = false;   ///< whether the work ended after the tick's period
};

/// The time from `from` to `to` as a TickSample has it.
std::uint32_t ns_between(TickClock::time_point from, TickClock::time_point to);

/// What other threads may see of a running loop. It has a cache line of its own: the loop writes to it with three
/// relaxed stores a tick, and never waits for a reader.
struct alignas(64) TickProgress {
  std::atomic<std::uint64_t> done{0}, missed{0};
  std::atomic<std::uint32_t> longest_work{0};  ///< in ns, since a reader has last set it to 0
};

struct TickSchedule {
  std::chrono::nanoseconds period{1'000'000};
  /// How long before a tick the loop stops sleeping, and looks at the clock until the time has come.
  std::chrono::nanoseconds spin{0};
};

/// The work of one tick.
using TickWork = std::function<void(std::uint64_t tick, TickSample& sample)>;

/// Runs one tick for each sample, the first of them numbered `first`. Tick i of them starts i periods after the first.
/// A tick that comes too late is not left out: it starts at once.
///
/// Real time  Makes no other system calls than clock_nanosleep and, where the kernel does not let it read the clock
///            itself, clock_gettime. Allocates nothing and takes no lock; the same is asked of `work`.
/// Pre        The memory of `samples` has been written to.
void run_ticks(const TickSchedule& schedule, std::uint64_t first, const TickWork& work, std::span<TickSample> samples,
               TickProgress& progress);

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/tick_loop.h"

#include <algorithm>
#include <cerrno>
#include <ctime>
#include <limits>
#include <thread>

namespace limber::program {
namespace {

constexpr std::chrono::milliseconds lead{1};  // before the first tick

#if defined(__APPLE__)  // which has no clock_nanosleep()
void sleep_until(TickClock::time_point time) { std::this_thread::sleep_until(time); }
#else
/// The standard libraries' steady clock is CLOCK_MONOTONIC; both count from the same origin.
void sleep_until(TickClock::time_point time) {
  const auto since_origin = time.time_since_epoch();
  const auto whole = std::chrono::duration_cast<std::chrono::seconds>(since_origin);
  const timespec target{static_cast<std::time_t>(whole.count()),
                        static_cast<long>(std::chrono::nanoseconds(since_origin - whole).count())};
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &target, nullptr) == EINTR) {
  }
}
#endif

/// Returns the first time seen that is not before `time`.
TickClock::time_point wait_until(TickClock::time_point time, std::chrono::nanoseconds spin) {
  TickClock::time_point now = TickClock::now();
  if (now < time - spin) sleep_until(time - spin);
  while ((now = TickClock::now()) < time) {
  }
  return now;
}

void publish(const TickSample& sample, TickProgress& progress, std::uint64_t& missed) {
  // This thread alone adds to the counts, so they need no atomic additions.
  if (sample.is_missed) progress.missed.store(++missed, std::memory_order_relaxed);
  if (sample.work > progress.longest_work.load(std::memory_order_relaxed)) {
    progress.longest_work.store(sample.work, std::memory_order_relaxed);
  }
}

}  // namespace

std::uint32_t ns_between(TickClock::time_point from, TickClock::time_point to) {
  const auto ns = std::chrono::nanoseconds(to - from).count();
  return static_cast<std::uint32_t>(std::clamp<std::int64_t>(ns, 0, std::numeric_limits<std::uint32_t>::max()));
}

void run_ticks(const TickSchedule& schedule, std::uint64_t first, const TickWork& work, std::span<TickSample> samples,
               TickProgress& progress) {
  TickClock::time_point time = TickClock::now() + lead;
  std::uint64_t missed = 0;
  for (std::size_t i = 0; i < samples.size(); ++i, time += schedule.period) {
    TickSample& sample = samples[i];
    sample.has_waited = TickClock::now() < time;
    const TickClock::time_point start = wait_until(time, schedule.spin);
    work(first + i, sample);
    const TickClock::time_point done = TickClock::now();
    sample.late = ns_between(time, start);
    sample.work = ns_between(start, done);
    sample.is_missed = done > time + schedule.period;
    publish(sample, progress, missed);
    progress.done.store(i + 1, std::memory_order_relaxed);
  }
}

}  // namespace limber::program

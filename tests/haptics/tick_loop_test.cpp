// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/tick_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace limber::program {
namespace {

using std::chrono::milliseconds;

void stay_busy(milliseconds time) {
  const auto end = TickClock::now() + time;
  while (TickClock::now() < end) {
  }
}

TEST(TickLoop, RunsEveryTickInItsPeriod) {
  for (const std::chrono::microseconds spin : {std::chrono::microseconds(0), std::chrono::microseconds(1500)}) {
    const TickSchedule schedule{milliseconds(4), spin};
    std::vector<TickSample> samples(20);
    std::vector<std::uint64_t> numbers;
    std::vector<TickClock::time_point> starts;
    TickProgress progress;
    const auto work = [&](std::uint64_t tick, TickSample&) {
      numbers.push_back(tick);
      starts.push_back(TickClock::now());
    };
    const TickClock::time_point before = TickClock::now();
    run_ticks(schedule, 100, work, samples, progress);
    ASSERT_EQ(numbers.size(), 20U);
    for (std::size_t i = 0; i < 20; ++i) {
      EXPECT_EQ(numbers[i], 100 + i);
      EXPECT_GE(starts[i], before + i * schedule.period);  // never early, whatever the machine does
      EXPECT_GE(starts[i] - before, i * schedule.period + std::chrono::nanoseconds(samples[i].late));
      if (samples[i].late > 4'000'000) {
        EXPECT_TRUE(samples[i].is_missed);
      }
    }
    EXPECT_EQ(progress.done, 20U);
    // Sleeps end before the time. A busy machine delays some ticks all the same.
    const auto is_punctual = [](const TickSample& sample) { return sample.late < 1'000'000; };
    EXPECT_GE(std::count_if(samples.begin(), samples.end(), is_punctual), 1);
  }
}

TEST(TickLoop, CatchesUpAfterATickThatTookTooLong) {
  std::vector<TickSample> samples(10);
  TickProgress progress;
  const auto work = [](std::uint64_t tick, TickSample&) {
    if (tick == 3) stay_busy(milliseconds(25));
  };
  run_ticks({milliseconds(10), milliseconds(0)}, 0, work, samples, progress);
  EXPECT_GE(samples[3].work, 25'000'000U);
  EXPECT_TRUE(samples[3].is_missed);
  for (const std::size_t i : {4U, 5U}) {  // they had to start at 10 and 20 ms, and start at 25 ms
    EXPECT_FALSE(samples[i].has_waited);
    EXPECT_GE(samples[i].late, i == 4 ? 15'000'000U : 5'000'000U);
  }
  EXPECT_TRUE(samples[4].is_missed);
  std::uint64_t missed = 0;
  for (const TickSample& sample : samples) missed += sample.is_missed ? 1 : 0;
  EXPECT_EQ(progress.missed, missed);
  EXPECT_EQ(progress.longest_work, samples[3].work);
}

TEST(TickLoop, KnowsTimesUpToFourSeconds) {
  const TickClock::time_point now = TickClock::now();
  EXPECT_EQ(ns_between(now, now + std::chrono::nanoseconds(17)), 17U);
  EXPECT_EQ(ns_between(now, now + std::chrono::seconds(10)), 0xffff'ffffU);
  EXPECT_EQ(ns_between(now, now - std::chrono::nanoseconds(17)), 0U);
}

}  // namespace
}  // namespace limber::program

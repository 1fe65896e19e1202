// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/tick_loop.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "haptics/percentiles.h"
#include "scenes/scenes.h"

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

/// count, ..., 2, 1.
std::vector<double> counted_down(std::size_t count) {
  std::vector<double> values(count);
  std::iota(values.rbegin(), values.rend(), 1);
  return values;
}

TEST(Percentiles, AreValuesByTheNearestRank) {
  const Percentiles all = percentiles_of(counted_down(10'000)).value();
  EXPECT_EQ(all.at[0], 5000);
  EXPECT_EQ(all.at[1], 9000);
  EXPECT_EQ(all.at[2], 9900);
  EXPECT_EQ(all.at[3], 9990);
  EXPECT_EQ(all.at[4], 9999);
  EXPECT_EQ(all.max, 10'000);
  EXPECT_EQ(percentiles_of(counted_down(7)).value().at[0], 4);  // of 3.5 values, rounded up
}

TEST(Percentiles, AreLeftOutWhereNoValueIsAbove) {
  EXPECT_FALSE(percentiles_of({}));
  EXPECT_FALSE(percentiles_of({5}).value().at[0]);
  EXPECT_EQ(percentiles_of({5}).value().max, 5);
  EXPECT_EQ(percentiles_of({5}).value().median(), 5);
  EXPECT_EQ(percentiles_of({7, 5, 9, 1}).value().median(), 5);
  EXPECT_EQ(percentiles_of({5, 4}).value().at[0], 4);
  for (std::size_t i = 1; i < percentile_levels.size(); ++i) {
    const std::size_t enough = 10'000 / (10'000 - percentile_levels[i].part);
    EXPECT_FALSE(percentiles_of(counted_down(enough - 1)).value().at[i]) << percentile_levels[i].name;
    EXPECT_EQ(percentiles_of(counted_down(enough)).value().at[i], static_cast<double>(enough) - 1);
  }
}

TEST(LogHistogram, CountsEveryValueBetweenItsEdges) {
  scenes::Rng rng(3);
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(std::pow(10, rng.uniform(-1.9, 5)));
  values.insert(values.end(), {0, 1e-9});                                            // count as the smallest
  for (int bin = -15; bin <= 50; ++bin) values.push_back(std::pow(10, bin / 10.0));  // edges, and just below them
  for (int bin = -15; bin <= 50; ++bin) values.push_back(std::nextafter(std::pow(10, bin / 10.0), 0));
  const LogHistogram histogram(values);
  std::size_t counted = 0;
  for (std::size_t i = 0; i < histogram.counts().size(); ++i) {
    const auto is_between = [&](double value) {
      return (i == 0 || value >= histogram.edge(i)) && value < histogram.edge(i + 1);
    };
    EXPECT_EQ(histogram.counts()[i], std::count_if(values.begin(), values.end(), is_between)) << i;
    counted += histogram.counts()[i];
  }
  EXPECT_EQ(counted, values.size());
  EXPECT_GT(histogram.counts().front(), 0U);
  EXPECT_GT(histogram.counts().back(), 0U);
  EXPECT_NEAR(histogram.edge(0), 0.01, 1e-15);
  EXPECT_NEAR(histogram.edge(10) / histogram.edge(0), 10, 1e-12);
  EXPECT_TRUE(LogHistogram({}).counts().empty());
}

}  // namespace
}  // namespace limber::program

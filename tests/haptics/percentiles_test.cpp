// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/percentiles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "scenes/scenes.h"

namespace limber::program {
namespace {

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
  EXPECT_EQ(percentiles_of({5, 4}).value().at[0], 4);
  for (std::size_t i = 1; i < percentile_levels.size(); ++i) {
    const std::size_t enough = 10'000 / (10'000 - percentile_levels[i].part);
    EXPECT_FALSE(percentiles_of(counted_down(enough - 1)).value().at[i]) << percentile_levels[i].name;
    EXPECT_EQ(percentiles_of(counted_down(enough)).value().at[i], static_cast<double>(enough) - 1);
  }
}

std::vector<std::uint64_t> counted_by_edges(const LogHistogram& histogram, const std::vector<double>& values) {
  std::vector<std::uint64_t> counts(histogram.counts().size());
  for (const double value : values) {
    for (std::size_t i = 0; i < counts.size(); ++i) {
      if (value >= histogram.edge(i) && value < histogram.edge(i + 1)) ++counts[i];
    }
  }
  return counts;
}

TEST(LogHistogram, CountsEveryValueBetweenItsEdges) {
  scenes::Rng rng(3);
  std::vector<double> values;
  for (int i = 0; i < 1000; ++i) values.push_back(std::pow(10, rng.uniform(-1.9, 5)));
  for (int bin = -15; bin <= 50; ++bin) values.push_back(std::pow(10, bin / 10.0));  // edges, and just below them
  for (int bin = -15; bin <= 50; ++bin) values.push_back(std::nextafter(std::pow(10, bin / 10.0), 0));
  const LogHistogram histogram(values);
  EXPECT_EQ(histogram.counts(), counted_by_edges(histogram, values));
  EXPECT_EQ(std::accumulate(histogram.counts().begin(), histogram.counts().end(), std::uint64_t{0}), values.size());
  EXPECT_GT(histogram.counts().front(), 0U);
  EXPECT_GT(histogram.counts().back(), 0U);
  EXPECT_NEAR(histogram.edge(10) / histogram.edge(0), 10, 1e-12);
}

TEST(LogHistogram, TakesSmallValuesForTheSmallest) {
  const LogHistogram histogram({0, 1e-9, 0.01, 0.02});
  EXPECT_EQ(histogram.counts().front(), 3U);
  EXPECT_NEAR(histogram.edge(0), 0.01, 1e-15);
  EXPECT_EQ(LogHistogram({}).counts().size(), 0U);
}

}  // namespace
}  // namespace limber::program

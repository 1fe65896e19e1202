// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <functional>
#include <string>
#include <vector>

/// Times and their statistics.
namespace limber::bench {

using Clock = std::chrono::steady_clock;

inline double us_since(Clock::time_point start) {
  return std::chrono::duration<double, std::micro>(Clock::now() - start).count();
}

class Stopwatch {
 public:
  double us() const { return us_since(start_); }

 private:
  Clock::time_point start_ = Clock::now();
};

/// Mean time of one call over `repetitions` calls in a row.
template <typename Call>
double mean_us(std::size_t repetitions, Call call) {
  const Stopwatch watch;
  for (std::size_t i = 0; i < repetitions; ++i) static_cast<void>(call());
  return watch.us() / static_cast<double>(repetitions);
}

/// How many calls in a row take long enough to be measured.
inline std::size_t repetitions_for(double one_call_us) {
  constexpr double shortest_sample_us = 30;  // a thousand times the cost of reading the clock
  if (one_call_us >= shortest_sample_us) return 1;
  return static_cast<std::size_t>(std::ceil(shortest_sample_us / std::max(one_call_us, 0.01)));
}

struct Summary {
  double min = 0, median = 0, p99 = 0, p999 = 0, p9999 = 0, max = 0;

  /// The tail of a distribution, as cells of a table.
  std::string tail() const {
    return fmt::format("{:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f}", median, p99, p999, p9999, max);
  }
};

/// Nearest-rank quantiles; with fewer than 100 samples the 99th percentile is the maximum.
inline Summary summarize(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto rank = [&](double quantile) {
    const double position = std::ceil(quantile * static_cast<double>(samples.size())) - 1;
    return samples[static_cast<std::size_t>(std::max(0.0, position))];
  };
  return {samples.front(), rank(0.5), rank(0.99), rank(0.999), rank(0.9999), samples.back()};
}

inline double median(std::vector<double> samples) { return summarize(std::move(samples)).median; }

/// A call, and how often in a row it is made for one sample.
struct Turn {
  std::function<void()> call;
  std::size_t repetitions = 1;
};

/// The median time of each call over rounds in all of which each has its turn, so that a disturbance affects all alike.
inline std::vector<double> medians_in_turn(const std::vector<Turn>& turns, int rounds) {
  std::vector<std::vector<double>> samples(turns.size());
  for (int round = 0; round < rounds; ++round) {
    for (std::size_t i = 0; i < turns.size(); ++i) samples[i].push_back(mean_us(turns[i].repetitions, turns[i].call));
  }
  std::vector<double> medians;
  for (const std::vector<double>& of_call : samples) medians.push_back(median(of_call));
  return medians;
}

}  // namespace limber::bench

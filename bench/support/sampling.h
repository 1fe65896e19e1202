// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <vector>

/// Times and their statistics.
namespace limber::bench {

class Stopwatch {
 public:
  double us() const { return std::chrono::duration<double, std::micro>(Clock::now() - start_).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

/// Mean time of one call over `repetitions` calls in a row.
template <typename Call>
double mean_us(std::size_t repetitions, Call call) {
  const Stopwatch watch;
  for (std::size_t i = 0; i < repetitions; ++i) call();
  return watch.us() / static_cast<double>(repetitions);
}

/// How many calls in a row take long enough to be measured.
inline std::size_t repetitions_for(double one_call_us) {
  constexpr double shortest_sample_us = 30;  // a thousand times the cost of reading the clock
  if (one_call_us >= shortest_sample_us) return 1;
  return static_cast<std::size_t>(std::ceil(shortest_sample_us / std::max(one_call_us, 0.01)));
}

struct Summary {
  double min = 0, median = 0, p99 = 0, max = 0;
};

/// Nearest-rank quantiles; with fewer than 100 samples the 99th percentile is the maximum.
inline Summary summarize(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::sort(samples.begin(), samples.end());
  const auto rank = [&](double quantile) {
    const double position = std::ceil(quantile * static_cast<double>(samples.size())) - 1;
    return samples[static_cast<std::size_t>(std::max(0.0, position))];
  };
  return {samples.front(), rank(0.5), rank(0.99), samples.back()};
}

inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return values.empty() ? 0 : sum / static_cast<double>(values.size());
}

}  // namespace limber::bench

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

namespace limber::bench {

inline double us_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count();
}

/// The tail of a distribution: what all but one in a hundred, a thousand, ten thousand samples stay below.
struct Percentiles {
  double p50, p99, p999, p9999, max;

  /// Pre: there are samples.
  explicit Percentiles(std::vector<double> samples) {
    std::sort(samples.begin(), samples.end());
    const auto at = [&](double part) {
      return samples[std::min(samples.size() - 1,
                              static_cast<std::size_t>(part * static_cast<double>(samples.size())))];
    };
    p50 = at(0.5), p99 = at(0.99), p999 = at(0.999), p9999 = at(0.9999), max = samples.back();
  }
  /// Cells of a table.
  std::string text() const {
    return fmt::format("{:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.2f}", p50, p99, p999, p9999, max);
  }
};

}  // namespace limber::bench

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "haptics/percentiles.h"

#include <algorithm>
#include <cmath>

namespace limber::program {
namespace {

constexpr double smallest = 0.01;

double edge_of(int bin) { return std::pow(10, static_cast<double>(bin) / LogHistogram::per_decade); }

/// The bin of a value by the edges as edge() computes them, whatever the rounding of the logarithm.
int bin_of(double value) {
  value = std::max(value, smallest);
  const int bin = static_cast<int>(std::floor(LogHistogram::per_decade * std::log10(value)));
  return value < edge_of(bin) ? bin - 1 : value >= edge_of(bin + 1) ? bin + 1 : bin;
}

}  // namespace

std::optional<Percentiles> percentiles_of(std::vector<double> values) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  Percentiles found;
  found.max = values.back();
  for (std::size_t i = 0; i < percentile_levels.size(); ++i) {
    const std::size_t rank = (percentile_levels[i].part * values.size() + 9999) / 10'000;
    if (rank < values.size()) found.at[i] = values[rank - 1];
  }
  return found;
}

LogHistogram::LogHistogram(const std::vector<double>& values) {
  if (values.empty()) return;
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  first_ = bin_of(*low);
  counts_.resize(static_cast<std::size_t>(bin_of(*high) - first_) + 1);
  for (const double value : values) ++counts_[static_cast<std::size_t>(bin_of(value) - first_)];
}

double LogHistogram::edge(std::size_t i) const { return edge_of(first_ + static_cast<int>(i)); }

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

/// Many times in few numbers.
namespace limber::program {

struct PercentileLevel {
  const char* name;
  std::uint64_t part;  ///< that many of 10 000 values are not above the percentile
};
inline constexpr std::array<PercentileLevel, 5> percentile_levels = {
    {{"median", 5000}, {"p90", 9000}, {"p99", 9900}, {"p99.9", 9990}, {"p99.99", 9999}}};

/// Percentiles by the nearest rank, so each of them is one of the values. Those above which there would be no value are
/// left out, as they would only be the largest.
struct Percentiles {
  std::array<std::optional<double>, percentile_levels.size()> at;  ///< as percentile_levels
  double max = 0;

  double median() const { return at[0].value_or(max); }
};

/// Empty without values.
std::optional<Percentiles> percentiles_of(std::vector<double> values);

/// How many values lie in each of a row of bins, `per_decade` of which multiply by 10: bin i holds what is at least
/// edge(i) and less than edge(i + 1).
class LogHistogram {
 public:
  static constexpr int per_decade = 10;

  /// Values below 0.01 count as that.
  explicit LogHistogram(const std::vector<double>& values);

  /// From the first bin that holds a value to the last; empty without values.
  const std::vector<std::uint64_t>& counts() const { return counts_; }
  double edge(std::size_t i) const;

 private:
  int first_ = 0;  // edge(0) is 10^(first_ / per_decade)
  std::vector<std::uint64_t> counts_;
};

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>

/// Doubles without error: sums and products of two as two, [Shewchuk1997], [Dekker1971], and their parts.
namespace limber::base {

/// A number as a sum of two doubles: `high` is the sum, rounded.
struct DoublePair {
  double high, low;
};

/// x + y, exact.
inline DoublePair two_sum(double x, double y) {
  const double sum = x + y;
  const double y_virtual = sum - x;
  const double x_virtual = sum - y_virtual;
  return {sum, (x - x_virtual) + (y - y_virtual)};
}

/// A number as a sum of two of 26 bits. Pre: |x| < 2^996.
inline DoublePair split(double x) {
  const double c = 0x1.0000002p27 * x;  // 2^27 + 1
  const double high = c - (c - x);
  return {high, x - high};
}

/// x y, exact where nothing overflows or underflows.
inline DoublePair two_product(double x, double y) {
  const double product = x * y;
  const DoublePair a = split(x), b = split(y);
  const double error = ((a.high * b.high - product) + a.high * b.low + a.low * b.high) + a.low * b.low;
  return {product, error};
}

/// A finite double as m 2^exponent, exact: m is odd, or 0.
struct Decoded {
  std::int64_t m;
  int exponent;  ///< for 0 the largest int, so that minima ignore it

  explicit Decoded(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const auto biased = static_cast<int>(bits >> 52 & 0x7ff);
    std::uint64_t size = bits & (~std::uint64_t{0} >> 12);
    if (biased != 0) size |= std::uint64_t{1} << 52;
    const int zeros = std::countr_zero(size);
    m = size == 0 ? 0 : static_cast<std::int64_t>(size >> zeros);
    if (bits >> 63 != 0) m = -m;
    exponent = m == 0 ? std::numeric_limits<int>::max() : std::max(biased, 1) - 1075 + zeros;
  }

  /// The number divided by 2^unit. Pre: it is a multiple of that.
  template <typename Integer>
  Integer in(int unit) const {
    return m == 0 ? Integer(0) : Integer(Integer(m) << static_cast<unsigned>(exponent - unit));
  }
};

}  // namespace limber::base

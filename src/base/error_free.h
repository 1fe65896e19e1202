// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// Sums and products of two doubles without error, as two doubles. [Shewchuk1997], [Dekker1971]
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

}  // namespace limber::base

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <limits>

#include "base/error_bounds.h"
#include "limber/math.h"

/// Float64 arithmetic that errs on a chosen side, without touching the rounding mode.
///
/// With u = 2^-53: a difference of stored coordinates carries a relative error of u, a squared length of three of them
/// at most 5 u, its root 3.5 u. The factors below cover that with room to spare; squares below 2^-900 are treated
/// apart, because there underflow would spoil relative errors.
namespace limber::base {

inline constexpr double tiny_square = 0x1p-900;

/// Distances of segments whose sizes are between these need no other unit: fourth powers neither overflow nor lose
/// digits that matter. A size is a sum of coordinates relative to a corner, 1 to 9 times the largest.
inline constexpr double smallest_unscaled_size = 0x1p-96, largest_unscaled_size = 0x1p100;

/// At least the distance of the stored points, and 0 when they are equal.
inline double distance_up(const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double d_sq = length_sq(d);
  if (d_sq < tiny_square) return 2 * max_abs(d);  // sqrt(3) < 2
  return std::sqrt(d_sq) * (1 + 0x1p-50);
}

/// At most the distance of the stored points.
inline double distance_down(const Vec3& a, const Vec3& b) {
  const double d_sq = length_sq(b - a);
  return d_sq < tiny_square ? 0 : std::sqrt(d_sq) * (1 - 0x1p-50);
}

/// A float32 at least x and at most a few units in the last place above it; 0 for 0, infinity above them all.
///
/// Not by comparing x with its nearest float32: GCC 12 vectorises conversions to float32 and back as if they rounded
/// nothing. The same goes for to_24_bits().
inline float float_up(double x) { return x == 0 ? 0.0F : static_cast<float>(x + std::abs(x) * 0x1p-23 + 0x1p-126); }

/// A float32 at most x, as float_up().
inline float float_down(double x) { return -float_up(-x); }

/// Infinity above what the kernels can square: they treat such a node as if it were everywhere. A finite number in its
/// place would make the node smaller than it is.
inline double or_infinite(double units) { return units < max_units ? units : std::numeric_limits<double>::infinity(); }

/// A float32 number near x, as float64: within 2^-24 of its size, or within 2^-100. Pre: |x| < 2^90.
inline double to_24_bits(double x) {
  const double high = x * (0x1p29 + 1);  // Veltkamp's splitting
  return std::abs(x) < 0x1p-100 ? 0 : high - (high - x);
}

}  // namespace limber::base

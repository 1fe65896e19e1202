// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "fuzz/byte_reader.h"
#include "limber/geometry.h"

/// Coordinates of the kinds that break geometry code, a byte or two each; rarely any float64 number.
namespace limber::fuzz {

/// Numbers at which float64 and float32 arithmetic change their behaviour, and some plain ones.
inline constexpr std::array<double, 32> notable_numbers{
    0.0,       -0.0,    0.1,     1.0 / 3,  0.5,      0.75,     10,       1e6,      1e-9,     1e12,     0x1p-23,
    0x1p-24,   0x1p-52, 0x1p-53, 0x1p-100, 0x1p-126, 0x1p-149, 0x1p-280, 0x1p-400, 0x1p-500, 0x1p-537, 0x1p-1022,
    0x1p-1074, 0x1p24,  0x1p53,  0x1p60,   0x1p100,  0x1p127,  0x1p128,  0x1p150,  0x1p199,  0x1p200,
};

/// `x` moved by `steps` units in the last place.
inline double nudged(double x, int steps) {
  for (int i = 0; i < std::abs(steps); ++i) x = std::nextafter(x, steps > 0 ? HUGE_VAL : -HUGE_VAL);
  return x;
}

/// `x` where it is a valid coordinate, else the nearest one, and 0 for NaN.
inline double made_valid(double x) { return std::isnan(x) ? 0 : std::clamp(x, -max_coordinate, max_coordinate); }

/// A valid coordinate. Half of all first bytes give small integers, so that every degeneracy is frequent.
inline double coordinate(ByteReader& bytes) {
  const std::uint8_t kind = bytes.byte();
  if (kind < 128) return static_cast<double>(kind % 8) - 3;
  if (kind < 192) return notable_numbers[kind % 32] * (kind < 160 ? 1 : -1);
  if (kind < 224) return made_valid(nudged(static_cast<double>(kind % 8) - 3, static_cast<int>(bytes.below(9)) - 4));
  if (kind < 240) return static_cast<double>(static_cast<int>(bytes.byte()) - 128) / 16;
  return made_valid(bytes.any_double());
}

inline Vec3 point(ByteReader& bytes) {
  const double x = coordinate(bytes), y = coordinate(bytes), z = coordinate(bytes);
  return {x, y, z};
}

/// A power of two by which all coordinates of a scene are multiplied; mostly 1.
inline double scale(ByteReader& bytes) {
  constexpr std::array<int, 16> exponents{0, 0, 0, 0, 0, 0, 0, -10, 20, -60, 100, -149, -280, 190, -400, -500};
  return std::ldexp(1.0, exponents[bytes.below(16)]);
}

inline Vec3 scaled(const Vec3& p, double factor) {
  return {made_valid(p.x * factor), made_valid(p.y * factor), made_valid(p.z * factor)};
}

}  // namespace limber::fuzz

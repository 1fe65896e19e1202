// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cfenv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "limber/mesh.h"

/// What the bytes of an input stand for: choices, coordinates of the kinds that break geometry code, meshes, poses and
/// floating-point environments.
namespace limber::fuzz {

/// The caller's floating-point environment, for as long as the object lives: a rounding mode, and whether subnormal
/// numbers are flushed to zero. The default is the one of every process; oracles run there.
class Environment {
 public:
  explicit Environment(std::uint8_t choice) : saved_(_mm_getcsr()) {
    constexpr std::array<int, 4> modes{FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
    std::fesetround(modes[choice % 4]);
    if ((choice & 4U) != 0) _mm_setcsr(_mm_getcsr() | flush_to_zero);
    if ((choice & 8U) != 0) _mm_setcsr(_mm_getcsr() | denormals_are_zero);
  }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;
  ~Environment() {
    std::fesetround(FE_TONEAREST);
    _mm_setcsr(saved_);
  }

 private:
  unsigned saved_;
};

/// Calls `function` in the environment that `choice` selects. Returning its result must need no arithmetic.
template <typename Function>
auto in_environment(std::uint8_t choice, const Function& function) {
  const Environment environment(choice);
  return function();
}

/// Turns an input into choices and numbers, front to back. Reads zeros once the input is used up, so that every input
/// is a complete scene and cutting an input short keeps the meaning of its first part.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  bool is_empty() const { return bytes_.empty(); }

  std::uint8_t byte() {
    if (bytes_.empty()) return 0;
    const std::uint8_t first = bytes_.front();
    bytes_ = bytes_.subspan(1);
    return first;
  }

  /// A number below `count`, from one byte. Pre: 1 <= count <= 256.
  std::uint32_t below(std::uint32_t count) { return byte() % count; }

  bool flag() { return below(2) == 1; }

  /// Any float64 pattern, from eight bytes.
  double any_double() {
    std::uint64_t bits = 0;
    for (int i = 0; i < 8; ++i) bits = bits << 8U | byte();
    return std::bit_cast<double>(bits);
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

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
inline Vec3 made_valid(const Vec3& p) { return {made_valid(p.x), made_valid(p.y), made_valid(p.z)}; }

inline Vec3 scaled(const Vec3& p, double factor) { return made_valid(p * factor); }

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

/// Up to 12 vertices and 40 triangles between any of them, degenerate and repeated ones included.
inline Mesh soup(ByteReader& bytes, double factor) {
  std::vector<Vec3> positions;
  for (std::uint32_t v = 0, count = 1 + bytes.below(12); v < count; ++v)
    positions.push_back(scaled(point(bytes), factor));
  std::vector<Corners> triangles;
  const auto vertex_count = static_cast<std::uint32_t>(positions.size());
  const std::uint32_t most = bytes.below(8) == 7 ? 40 : 12;
  for (std::uint32_t t = 0, count = 1 + bytes.below(most); t < count; ++t) {
    const VertexId v0 = bytes.below(vertex_count), v1 = bytes.below(vertex_count), v2 = bytes.below(vertex_count);
    triangles.push_back({v0, v1, v2});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A rectangular grid of up to 128 triangles, so that the tree has inner nodes; heights repeat after a few vertices.
inline Mesh sheet(ByteReader& bytes, double factor) {
  const std::uint32_t columns = 1 + bytes.below(8), rows = 1 + bytes.below(8);
  const Vec3 origin = point(bytes);
  std::vector<double> heights;
  for (std::uint32_t i = 0, count = 1 + bytes.below(6); i < count; ++i) heights.push_back(coordinate(bytes));
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t y = 0; y <= rows; ++y) {
    for (std::uint32_t x = 0; x <= columns; ++x) {
      const Vec3 offset{0.5 * x, 0.5 * y, heights[positions.size() % heights.size()]};
      positions.push_back(scaled(origin + offset, factor));
      if (x == columns || y == rows) continue;
      const VertexId v = y * (columns + 1) + x, above = v + columns + 1;
      triangles.push_back({v, v + 1, above});
      triangles.push_back({v + 1, above + 1, above});
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

inline Mesh small_mesh(ByteReader& bytes, double factor) {
  return bytes.below(5) == 4 ? sheet(bytes, factor) : soup(bytes, factor);
}

/// A rotation: none, by right angles, or by any angle.
inline Mat3 rotation(ByteReader& bytes) {
  const std::uint32_t kind = bytes.below(4);
  if (kind < 2) return {};
  if (kind == 2) {
    constexpr std::array<Mat3, 4> turns{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                         {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                         {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}};
    return turns[bytes.below(4)];
  }
  const auto part = [&] { return static_cast<double>(bytes.byte()) - 128; };
  const double qw = part() + 0.5, qx = part(), qy = part(), qz = part();
  return transform_from_quaternion({}, qw, qx, qy, qz).value().rotation;
}

inline Transform pose(ByteReader& bytes, double factor) {
  const Mat3 turn = rotation(bytes);
  if (bytes.flag()) return {turn, {}};
  return {turn, scaled(point(bytes), factor)};
}

}  // namespace limber::fuzz

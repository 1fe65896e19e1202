// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmmintrin.h>

#include <algorithm>
#include <array>
#include <cfenv>
#include <cstdint>

#include "fuzz/inputs.h"
#include "limber/geometry.h"

/// The callers' floating-point environments, and what rounding may do to contacts.
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

/// The smallest height of a triangle as a part of `size`. Edges are divided first, so no product vanishes or overflows.
inline double relative_height(const Triangle& t, double size) {
  const Vec3 p = scaled(t.v1 - t.v0, 1 / size), q = scaled(t.v2 - t.v0, 1 / size);
  const double longest = std::max({length(p), length(q), length(q - p)});
  return longest == 0 ? 0 : length(cross(p, q)) / longest;
}

/// How far off the shared point of triangles that meet may be if one is a sliver (docs/algorithms/numerics.md). `size`
/// is at least their largest coordinate.
inline double sliver_tolerance(const Triangle& a, const Triangle& b, double size) {
  if (!(size > 0x1p-1000)) return 0;
  const double height = std::min(relative_height(a, size), relative_height(b, size));
  return size * std::min(0x1p-50 / std::max(height, 0x1p-100), 0x1p-26);
}

}  // namespace limber::fuzz

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <xmmintrin.h>

#include <array>
#include <cfenv>
#include <cstdint>

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

}  // namespace limber::fuzz

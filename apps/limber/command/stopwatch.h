// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cmath>

namespace limber::program {

/// Wall time since it was made.
class Stopwatch {
 public:
  double seconds() const { return std::chrono::duration<double>(elapsed()).count(); }
  double microseconds() const { return std::chrono::duration<double, std::micro>(elapsed()).count(); }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::duration elapsed() const { return Clock::now() - start_; }

  Clock::time_point start_ = Clock::now();
};

/// A sum of times without the digits that adding them up has left behind the nanoseconds.
inline double rounded_us(double microseconds) { return std::round(microseconds * 1e3) / 1e3; }

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The clock behind std::chrono, in place of the C library's: one call of JavaScript that gives a double.
#include <time.h>

#include <cmath>

extern "C" {

/// performance.now().
__attribute__((import_module("limber"), import_name("now"))) double limber_now_ms();

int clock_gettime(clockid_t, timespec* time) {
  const double ms = limber_now_ms(), s = std::floor(ms / 1000);
  time->tv_sec = static_cast<time_t>(s);
  time->tv_nsec = static_cast<long>((ms - s * 1000) * 1e6);
  return 0;
}
}

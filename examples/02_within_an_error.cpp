// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Answers of limited accuracy: errors, limits, and what the interval means.
#include <cmath>
#include <cstdio>

#include "limber/limber.h"
#include "shapes.h"

int main() {
  const limber::Model square(shapes::sheet(64, 8)), ball(shapes::ball(32));
  const limber::Placed a{square}, b{ball, {{}, {0, 0, 1.25}}};  // 0.25 apart

  const limber::DistanceResult exact = limber::distance(a, b);
  // Stops as soon as the answer is at most a tenth too large, or at most 0.01, whichever comes first.
  const limber::DistanceResult rough = limber::distance(a, b, {.relative_error = 0.1, .absolute_error = 0.01});
  std::printf("exactly %g; roughly, between %g and %g\n", exact.upper, rough.lower, rough.upper);
  std::printf("nodes compared: %llu and %llu\n", static_cast<unsigned long long>(exact.stats.node_tests),
              static_cast<unsigned long long>(rough.stats.node_tests));

  // "Is anything closer than ...?" is cheaper than the distance: it ends at the first such pair.
  const bool within_a_half = limber::within(a, b, 0.5).is_yes(), within_a_fifth = limber::within(a, b, 0.2).is_yes();

  // The distance, if it is at most 0.2; otherwise only `beyond_limit`.
  const limber::DistanceResult limited = limber::distance(a, b, {.max_distance = 0.2});
  std::printf("within 0.5: %s, within 0.2: %s, so at least %g\n", within_a_half ? "yes" : "no",
              within_a_fifth ? "yes" : "no", limited.lower);

  const bool promises_hold = exact.lower == exact.upper && std::abs(exact.upper - 0.25) < 1e-12 &&
                             rough.lower <= exact.upper && exact.upper <= rough.upper &&
                             rough.upper <= 1.1 * exact.upper &&
                             limited.status == limber::DistanceStatus::beyond_limit && limited.lower <= exact.upper;
  return promises_hold && within_a_half && !within_a_fifth ? 0 : 1;
}

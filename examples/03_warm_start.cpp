// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A body in motion: each query starts from the result of the last one.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "limber/limber.h"
#include "shapes.h"

int main() {
  const limber::Model sheet(shapes::sheet(100, 8)), ball(shapes::ball(32));
  limber::QueryCache cache;  // belongs to these two models; one thread at a time
  double nearest = 1e9, largest_difference = 0;
  unsigned long long cold_tests = 0, warm_tests = 0;  // of nodes
  for (int frame = 0; frame < 1000; ++frame) {
    const double t = 0.002 * frame;
    const limber::Transform pose =
        limber::transform_from_quaternion({std::cos(3 * t), std::sin(3 * t), 2 - 0.4 * t}, 1, t, 0, t).value();
    const limber::DistanceResult warm = limber::distance({sheet}, {ball, pose}, {.cache = &cache});
    const limber::DistanceResult cold = limber::distance({sheet}, {ball, pose});
    nearest = std::min(nearest, warm.upper);
    largest_difference = std::max(largest_difference, std::abs(warm.upper - cold.upper));
    warm_tests += warm.stats.node_tests;
    cold_tests += cold.stats.node_tests;
  }
  std::printf("nearest %g; tests of nodes: %llu warm, %llu cold\n", nearest, warm_tests, cold_tests);
  return largest_difference < 1e-13 && warm_tests < cold_tests ? 0 : 1;
}

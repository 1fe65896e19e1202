// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries do not touch the heap.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>

#include "heap.h"
#include "limber/model.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

/// One of each query at every separation, near, touching and overlapping included.
void ask_everything(const Model& square, const Model& ball, QueryCache& cache) {
  for (const double separation : {8.0, 1.0, 0.01, 0.0, -0.5}) {
    const Placed a{square}, b{ball, scenes::ball_over_square(ball.mesh(), separation, 0)};
    distance(a, b);
    distance(a, b, {.relative_error = 0.1, .absolute_error = 0.01});
    distance(a, b, {.max_distance = 0.5});
    distance(a, b, {}, cache);
    collide(a, b);
    collide(a, b, cache);
    within(a, b, 0.5);
    within(a, b, 0.5, cache);
  }
}

TEST(Allocation, IsSeenByThisTest) {
  const std::uint64_t before = allocation_count();
  const Model model(scenes::thesis_ball());
  EXPECT_GT(allocation_count(), before);
}

TEST(Allocation, DoesNotHappenInQueriesWithABudget) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  QueryCache cache;
  distance({square}, {ball}, {}, {.max_steps = 1}, cache);
  const std::uint64_t before = allocation_count();
  for (int i = 0; i < 20; ++i) {
    const Placed a{square}, b{ball, {{}, {0.01 * i, 0, 3}}};
    const QueryBudget steps{.max_steps = 10};
    const QueryBudget time{.deadline = std::chrono::steady_clock::now() + std::chrono::microseconds(5)};
    for (const QueryBudget& budget : {steps, time}) {
      distance(a, b, {}, budget, cache);
      distance(a, b, {}, budget);
      collide(a, b, budget, cache);
      within(a, b, 1, budget, cache);
    }
  }
  EXPECT_EQ(allocation_count(), before);
}

TEST(Allocation, DoesNotHappenInAWarmQuery) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  QueryCache cache;
  ask_everything(square, ball, cache);
  const std::uint64_t before = allocation_count();
  ask_everything(square, ball, cache);
  EXPECT_EQ(allocation_count(), before);
}

}  // namespace
}  // namespace limber::testing

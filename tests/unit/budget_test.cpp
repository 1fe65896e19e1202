// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries that end early: what their budget says, and what they say then.
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "support/options.h"

namespace limber::testing {
namespace {

using Clock = std::chrono::steady_clock;

struct SheetAndBall {
  Model sheet{scenes::wave_sheet(60, 60, 0)}, ball{scenes::ball(40, 21)};
  Placed a{sheet}, b{ball, {{}, {2, 2, 1.5}}};
  double truth = distance(a, b).upper;
};

TEST(Budget, WithoutLimitsChangesNothing) {
  const SheetAndBall s;
  const DistanceResult plain = distance(s.a, s.b), budgeted = distance(s.a, s.b, {.budget = {}});
  EXPECT_EQ(budgeted.upper, plain.upper);
  EXPECT_EQ(budgeted.lower, plain.lower);
  EXPECT_EQ(budgeted.status, Status::exact);
  EXPECT_EQ(budgeted.stopped_by, StoppedBy::nothing);
  EXPECT_EQ(budgeted.stats.node_tests, plain.stats.node_tests);
}

TEST(Budget, OfStepsGivesIntervalsThatHoldTheDistance) {
  const SheetAndBall s;
  int interrupted = 0;
  for (std::uint64_t steps = 0; steps < 2000; steps = steps * 5 / 4 + 1) {
    const DistanceResult found = distance(s.a, s.b, {.budget = {.max_steps = steps}});
    ASSERT_TRUE(found.witness);
    EXPECT_NEAR(found.upper, length(found.witness->point_b - found.witness->point_a), 1e-15);
    EXPECT_LE(found.lower, s.truth) << steps;
    EXPECT_GE(found.upper, s.truth) << steps;
    if (found.status == Status::interrupted) {
      ++interrupted;
      EXPECT_LT(found.lower, found.upper) << steps;
      EXPECT_EQ(found.stopped_by, StoppedBy::max_steps);
    } else {
      EXPECT_EQ(found.status, Status::exact) << steps;
      EXPECT_EQ(found.upper, s.truth) << steps;
      EXPECT_EQ(found.stopped_by, StoppedBy::nothing);
    }
  }
  EXPECT_GT(interrupted, 10);
  EXPECT_LT(interrupted, 35);
}

TEST(Budget, OfOneStepAtATimeEndsWithTheAnswerAndNeverLosesGround) {
  const SheetAndBall s;
  QueryCache cache;
  double lower = 0, upper = std::numeric_limits<double>::infinity();
  int calls = 0;
  DistanceResult found;
  for (found.status = Status::interrupted; found.status == Status::interrupted; ++calls) {
    ASSERT_LT(calls, 5000);
    found = distance(s.a, s.b, {.cache = &cache, .budget = {.max_steps = 1}});
    ASSERT_GE(found.lower, lower) << calls;
    ASSERT_LE(found.upper, upper) << calls;
    ASSERT_LE(found.lower, s.truth) << calls;
    ASSERT_GE(found.upper, s.truth) << calls;
    lower = found.lower, upper = found.upper;
  }
  EXPECT_EQ(upper, s.truth);
  EXPECT_GT(calls, 20);
  const std::uint64_t before = distance(s.a, s.b, {.cache = &cache, .budget = {.max_steps = 1}}).stats.node_tests;
  EXPECT_LT(before, 10U);  // nothing is left to be done
}

TEST(Budget, IsWorthAsMuchInPartsAsInOnePiece) {
  const SheetAndBall s;
  const std::uint64_t at_once = distance(s.a, s.b).stats.node_tests;
  QueryCache cache;
  std::uint64_t in_parts = 0;
  DistanceResult found;
  do {
    found = distance(s.a, s.b, {.cache = &cache, .budget = {.max_steps = 20}});
    in_parts += found.stats.node_tests;
  } while (found.status == Status::interrupted);
  EXPECT_LT(in_parts, 2 * at_once);
}

TEST(Budget, OfNoStepsStillGivesAnInterval) {
  const SheetAndBall s;
  const DistanceResult found = distance(s.a, s.b, {.budget = {.max_steps = 0}});
  EXPECT_EQ(found.status, Status::interrupted);
  EXPECT_LE(found.lower, s.truth);
  EXPECT_GE(found.upper, s.truth);
  EXPECT_TRUE(found.witness);
}

TEST(Budget, EndsWithCancellation) {
  const SheetAndBall s;
  std::atomic<bool> cancel{true};
  const QueryBudget budget{.cancel = &cancel};
  const DistanceResult found = distance(s.a, s.b, {.budget = budget});
  EXPECT_EQ(found.status, Status::interrupted);
  EXPECT_EQ(found.stopped_by, StoppedBy::cancel);
  EXPECT_LE(found.stats.node_tests, 1U);
  EXPECT_EQ(collide(s.a, {s.ball, {{}, {2, 2, 0}}}, {.budget = budget}).answer, Answer::unknown);
  cancel = false;
  EXPECT_EQ(distance(s.a, s.b, {.budget = budget}).status, Status::exact);
}

TEST(Budget, WhoseDeadlineHasPassedStillMakesAStep) {
  const SheetAndBall s;
  QueryCache cache;
  const QueryBudget budget{.deadline = Clock::now() - std::chrono::seconds(1)};
  DistanceResult found = distance(s.a, s.b, {.cache = &cache, .budget = budget});
  EXPECT_EQ(found.status, Status::interrupted);
  EXPECT_EQ(found.stopped_by, StoppedBy::deadline);
  for (int calls = 0; found.status == Status::interrupted; ++calls) {
    ASSERT_LT(calls, 5000);
    found = distance(s.a, s.b, {.cache = &cache, .budget = budget});
  }
  EXPECT_EQ(found.upper, s.truth);
  EXPECT_EQ(distance(s.a, s.b, {.budget = {.deadline = Clock::now() + std::chrono::hours(1)}}).status, Status::exact);
}

TEST(Budget, LeavesYesAndNoOpenUntilOneIsProven) {
  const SheetAndBall s;
  const Placed touching{s.ball, {{}, {2, 2, 0.2}}};
  ASSERT_TRUE(collide(s.a, touching).is_yes());
  struct Question {
    Placed b;
    double limit;
    Answer wanted;
  };
  for (const Question& q : {Question{touching, 0, Answer::yes}, Question{s.b, s.truth * 1.01, Answer::yes},
                            Question{s.b, s.truth * 0.99, Answer::no}}) {
    QueryCache cache;
    int unknown = 0;
    const auto ask = [&] {
      return q.limit == 0 ? collide(s.a, q.b, {.cache = &cache, .budget = {.max_steps = 1}})
                          : within(s.a, q.b, q.limit, {.cache = &cache, .budget = {.max_steps = 1}});
    };
    CollideResult found = ask();
    for (; found.answer == Answer::unknown; found = ask(), ++unknown) {
      ASSERT_LT(unknown, 5000);
      EXPECT_EQ(found.stopped_by, StoppedBy::max_steps);
      EXPECT_FALSE(found.witness);
    }
    EXPECT_EQ(found.answer, q.wanted);
    EXPECT_EQ(found.stopped_by, StoppedBy::nothing);
    EXPECT_EQ(found.witness.has_value(), q.wanted == Answer::yes);
    EXPECT_GT(unknown, 3);
  }
}

TEST(Budget, CountsNothingThatTheErrorsAllow) {
  // An interval as narrow as the errors allow is an answer, however it came about.
  const SheetAndBall s;
  for (std::uint64_t steps = 0; steps < 1000; steps = steps * 2 + 1) {
    const DistanceResult found = distance(s.a, s.b, {.relative_error = 0.1, .budget = {.max_steps = steps}});
    const bool is_close_enough = found.upper <= 1.1 * (1 + 1e-15) * found.lower;
    EXPECT_EQ(found.status == Status::interrupted, !is_close_enough) << steps;
  }
}

TEST(Budget, BeyondTheLimitIsFoundWhenItIsProven) {
  const SheetAndBall s;
  const DistanceOptions options{.max_distance = s.truth / 2};
  QueryCache cache;
  DistanceResult found = distance(s.a, s.b, with(options, &cache, {.max_steps = 1}));
  for (int calls = 0; found.status == Status::interrupted; ++calls) {
    ASSERT_LT(calls, 5000);
    ASSERT_LE(found.lower, s.truth);
    ASSERT_GE(found.upper, s.truth);
    ASSERT_TRUE(found.witness);
    found = distance(s.a, s.b, with(options, &cache, {.max_steps = 1}));
  }
  EXPECT_EQ(found.status, Status::beyond_limit);
  EXPECT_FALSE(found.witness);
}

TEST(Budget, ThatIsSpentWhenTheErrorsAreMetInterruptsNothing) {
  scenes::Rng rng(2211);
  int met = 0;
  for (int i = 0; i < 400; ++i) {
    const Model a(scenes::random_soup(rng, 40, 0.3)), b(scenes::random_soup(rng, 40, 0.3));
    const Placed far{b, {{}, {rng.uniform(1, 4), 0, 0}}};
    const DistanceOptions errors{.relative_error = rng.uniform(0, 1), .absolute_error = rng.uniform(0, 0.5)};
    const DistanceResult found = distance({a}, far, with(errors, nullptr, {.max_steps = rng.below(30)}));
    const bool is_met =
        found.upper / (1 + errors.relative_error) <= found.lower || found.upper - found.lower <= errors.absolute_error;
    ASSERT_FALSE(is_met && found.status == Status::interrupted) << i;
    ASSERT_EQ(found.stopped_by == StoppedBy::nothing, found.status != Status::interrupted) << i;
    met += is_met && found.stats.node_tests > 1 ? 1 : 0;
  }
  EXPECT_GT(met, 50);
}

}  // namespace
}  // namespace limber::testing

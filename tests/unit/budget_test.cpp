// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries that end early: what their budget says, and what they say then. A query with a budget that is asked again at
// rest ends, after hardly more work than one without a budget, and its interval never becomes wider: also where all
// pairs of triangles are about as far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "pair/budget_meter.h"
#include "scenes/scenes.h"
#include "support/random_scene.h"
#include "support/right_answers.h"

namespace limber::testing {
namespace {

using Clock = std::chrono::steady_clock;

TEST(Budget, EndsWithCancellation) {
  const Model sheet(scenes::wave_sheet(60, 60, 0)), ball(scenes::ball(40, 21));
  const Placed a{sheet}, b{ball, {{}, {2, 2, 1.5}}};
  std::atomic<bool> cancel{true};
  const QueryBudget budget{.cancel = &cancel};
  const DistanceResult found = distance(a, b, {.budget = budget});
  EXPECT_EQ(found.status, DistanceStatus::interrupted);
  EXPECT_EQ(found.stopped_by, StoppedBy::cancel);
  EXPECT_LE(found.stats.node_tests, 1U);
  EXPECT_EQ(collide(a, {ball, {{}, {2, 2, 0}}}, {.budget = budget}).answer, Answer::undecided);
  cancel = false;
  EXPECT_EQ(distance(a, b, {.budget = budget}).status, DistanceStatus::exact);
}

TEST(Budget, WhoseDeadlineHasPassedLeavesTimeForOneStep) {
  const QueryBudget passed{.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1)};
  pair::BudgetMeter meter(passed);
  // Records of a front are compared without a step; the meter is asked before each.
  for (int i = 0; i < 10; ++i) ASSERT_FALSE(meter.is_spent(0));
  EXPECT_TRUE(meter.is_spent(1) || meter.is_spent(1));  // it looks at the clock every other time
  EXPECT_EQ(meter.stopped_by(), StoppedBy::deadline);
  // But not for ever.
  pair::BudgetMeter idle(passed);
  int calls = 0;
  while (!idle.is_spent(0)) ASSERT_LT(++calls, 1000);
}

TEST(Budget, ThatIsSpentWhenTheErrorsAreMetInterruptsNothing) {
  scenes::Rng rng(2211);
  int met = 0;
  for (int i = 0; i < 400; ++i) {
    const Model a(scenes::random_soup(rng, 40, 0.3)), b(scenes::random_soup(rng, 40, 0.3));
    const Placed far{b, {{}, {rng.uniform(1, 4), 0, 0}}};
    const DistanceOptions errors{.relative_error = rng.uniform(0, 1), .absolute_error = rng.uniform(0, 0.5)};
    const DistanceResult found = distance({a}, far, with(errors, nullptr, {.max_steps = rng.below(30)}));
    const bool may_meet = found.lower == 0 && found.upper > 0;  // then no error is met
    const bool is_met = !may_meet && (found.upper / (1 + errors.relative_error) <= found.lower ||
                                      found.upper - found.lower <= errors.absolute_error);
    ASSERT_FALSE(is_met && found.status == DistanceStatus::interrupted) << i;
    ASSERT_FALSE(may_meet && found.status != DistanceStatus::interrupted) << i;
    ASSERT_EQ(found.stopped_by == StoppedBy::nothing, found.status != DistanceStatus::interrupted) << i;
    met += is_met && found.stats.node_tests > 1 ? 1 : 0;
  }
  EXPECT_GT(met, 50);
}

// --- queries that are asked to their end ---

struct Ending {
  std::string name;
  Model a, b;
  Transform pose_b;
};

/// One triangle many times, its corners in turn.
Mesh stacked_triangle(std::uint32_t count) {
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < count; ++i) triangles.push_back({i % 3, (i + 1) % 3, (i + 2) % 3});
  return Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::move(triangles)).value();
}

/// Triangles of different sizes in one plane around one center.
Mesh concentric_triangles(std::uint32_t count) {
  std::vector<Triangle> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double r = 1 + 1e-4 * i;
    triangles.push_back({{r, 0, 0}, {-0.5 * r, 0.8 * r, 0}, {-0.5 * r, -0.8 * r, 0}});
  }
  return soup(triangles);
}

/// Thin needles along the axes: two such lattices stand in each other without touching.
Mesh needles(std::uint32_t per_side) {
  std::vector<Triangle> triangles;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t i = 0; i < per_side * per_side; ++i) {
      const double u = static_cast<double>(i % per_side) / per_side, v = static_cast<double>(i / per_side) / per_side;
      const auto turned = [&](double x, double y, double z) {
        return axis == 0 ? Vec3{x, y, z} : axis == 1 ? Vec3{z, x, y} : Vec3{y, z, x};
      };
      triangles.push_back({turned(u, v, 0), turned(u + 1e-3, v, 0), turned(u, v + 1e-3, 1)});
    }
  }
  return soup(triangles);
}

std::vector<Ending> endings() {
  const Transform turned = transform_from_quaternion({}, 1, 0.1, 0.2, 0.3).value();
  const Mesh ball = scenes::ball(40, 21), sheet = scenes::wave_sheet(40, 40, 0);
  std::vector<Ending> all;
  all.push_back({"a ball in a shell", Model(moved(ball, {}, 1.01)), Model(ball), turned});
  all.push_back({"needles", Model(needles(10)), Model(needles(10)), {{}, {0.05, 0.04, 0.03}}});
  all.push_back({"one triangle", Model(stacked_triangle(300)), Model(stacked_triangle(300)), {{}, {0, 0, 1}}});
  all.push_back({"concentric", Model(concentric_triangles(300)), Model(concentric_triangles(300)), {{}, {0, 0, 1}}});
  all.push_back({"sheets", Model(sheet), Model(sheet), {{}, {0, 0, 1e-3}}});
  all.push_back({"a ball over a sheet", Model(sheet), Model(ball), {{}, {2, 2, 1.5}}});
  all.push_back({"a ball in a sheet", Model(sheet), Model(ball), {{}, {2, 2, 0.2}}});
  return all;
}

struct Effort {
  std::uint64_t calls = 0, node_tests = 0;
};

/// Asks until there is an answer. `ask` returns the work, and whether it was the last call.
template <typename Ask>
Effort ask_to_the_end(std::uint64_t most_calls, const Ask& ask) {
  Effort effort;
  for (bool is_done = false; !is_done;) {
    const auto [stats, done] = ask();
    effort.node_tests += stats.node_tests;
    is_done = done;
    if (++effort.calls > most_calls) {
      ADD_FAILURE() << "no end after " << most_calls << " calls";
      break;
    }
  }
  return effort;
}

// A step compares two pairs of nodes at most, of eight children each; every call compares the roots.
constexpr std::uint64_t tests_a_step = 16, tests_a_call = 1;

TEST(Endings, ComeAfterHardlyMoreWorkThanWithoutABudget) {
  for (const Ending& s : endings()) {
    const Placed a{s.a}, b{s.b, s.pose_b};
    const Truth truth{distance(a, b).upper, 1e-12};
    for (const DistanceOptions& options : {DistanceOptions{}, DistanceOptions{.relative_error = 0.1},
                                           DistanceOptions{.max_distance = truth.distance / 2}}) {
      const std::uint64_t whole = distance(a, b, options).stats.node_tests;
      for (const std::uint64_t steps : {1, 7, 100, 1000}) {
        SCOPED_TRACE(s.name + ", error " + std::to_string(options.relative_error) + ", steps " + std::to_string(steps));
        QueryCache cache;
        DistanceResult last;
        last.upper = std::numeric_limits<double>::infinity();
        const Effort effort = ask_to_the_end(2 * whole + 10, [&] {
          const DistanceResult found = distance(a, b, with(options, &cache, {.max_steps = steps}));
          const bool is_done = found.status != DistanceStatus::interrupted;
          EXPECT_EQ(wrong_answer(found, options, a, b, truth), "");
          EXPECT_EQ(found.stopped_by, is_done ? StoppedBy::nothing : StoppedBy::max_steps);
          EXPECT_GE(found.lower, std::min(last.lower, found.upper));
          EXPECT_TRUE(found.upper <= last.upper || found.status == DistanceStatus::beyond_limit);
          last = found;
          return std::pair(found.stats, is_done);
        });
        EXPECT_LE(effort.node_tests, 2 * whole + tests_a_call * effort.calls + tests_a_step);
      }
    }
  }
}

TEST(Endings, OfYesAndNoComeTheSameWay) {
  for (const Ending& s : endings()) {
    const Placed a{s.a}, b{s.b, s.pose_b};
    const Truth truth{distance(a, b).upper, 1e-12};
    for (const double limit : {0.0, 0.9 * truth.distance, 1.1 * truth.distance}) {
      const auto ask = [&](const QueryOptions& options) {
        return limit == 0 ? collide(a, b, options) : within(a, b, limit, options);
      };
      const std::uint64_t whole = ask({}).stats.node_tests;
      for (const std::uint64_t steps : {1, 50}) {
        SCOPED_TRACE(s.name + ", limit " + std::to_string(limit) + ", steps " + std::to_string(steps));
        QueryCache cache;
        const Effort effort = ask_to_the_end(2 * whole + 10, [&] {
          const CollideResult found = ask({&cache, {.max_steps = steps}});
          EXPECT_EQ(wrong_answer(found, limit, a, b, truth), "");
          return std::pair(found.stats, found.answer != Answer::undecided);
        });
        EXPECT_LE(effort.node_tests, 2 * whole + tests_a_call * effort.calls + tests_a_step);
      }
    }
  }
}

TEST(Endings, ComeWhenEveryDeadlineHasPassed) {
  const QueryBudget passed{.deadline = Clock::now() - std::chrono::seconds(1)};
  for (const Ending& s : endings()) {
    SCOPED_TRACE(s.name);
    const Placed a{s.a}, b{s.b, s.pose_b};
    const DistanceResult whole = distance(a, b, {.budget = {.deadline = Clock::now() + std::chrono::hours(1)}});
    EXPECT_NE(whole.status, DistanceStatus::interrupted);
    QueryCache cache;
    const Effort effort = ask_to_the_end(2 * whole.stats.node_tests + 10, [&] {
      const DistanceResult found = distance(a, b, {.cache = &cache, .budget = passed});
      const bool is_done = found.status != DistanceStatus::interrupted;
      EXPECT_EQ(found.stopped_by, is_done ? StoppedBy::nothing : StoppedBy::deadline);
      return std::pair(found.stats, is_done);
    });
    EXPECT_TRUE(effort.calls > 1 || whole.stats.node_tests < 20);
  }
}

}  // namespace
}  // namespace limber::testing

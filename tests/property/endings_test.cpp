// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A query with a budget that is asked again and again at rest ends, after hardly more work than one without a budget,
// and its interval never becomes wider: also where all pairs of triangles are about as far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/scenes.h"
#include "support/options.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

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
    for (const double error : {0.0, 0.1}) {
      const DistanceOptions options{.relative_error = error};
      const DistanceResult whole = distance(a, b, options);
      for (const std::uint64_t steps : {1, 7, 100, 1000}) {
        SCOPED_TRACE(s.name + ", error " + std::to_string(error) + ", steps " + std::to_string(steps));
        QueryCache cache;
        DistanceResult last;
        last.upper = std::numeric_limits<double>::infinity();
        const Effort effort = ask_to_the_end(2 * whole.stats.node_tests + 10, [&] {
          const DistanceResult found = distance(a, b, with(options, &cache, {.max_steps = steps}));
          EXPECT_GE(found.lower, std::min(last.lower, found.upper));
          EXPECT_LE(found.upper, last.upper);
          last = found;
          return std::pair(found.stats, found.status != Status::interrupted);
        });
        EXPECT_LE(effort.node_tests, 2 * whole.stats.node_tests + tests_a_call * effort.calls + tests_a_step);
        EXPECT_NEAR(last.upper, whole.upper, 1e-12 + error * whole.upper);
      }
    }
  }
}

TEST(Endings, OfYesAndNoComeTheSameWay) {
  for (const Ending& s : endings()) {
    const Placed a{s.a}, b{s.b, s.pose_b};
    const double truth = distance(a, b).upper;
    for (const double limit : {0.0, 0.9 * truth, 1.1 * truth}) {
      const bool wanted = limit == 0 ? truth == 0 : truth <= limit;
      const QueryStats whole = limit == 0 ? collide(a, b).stats : within(a, b, limit).stats;
      for (const std::uint64_t steps : {1, 50}) {
        SCOPED_TRACE(s.name + ", limit " + std::to_string(limit) + ", steps " + std::to_string(steps));
        QueryCache cache;
        CollideResult last;
        const Effort effort = ask_to_the_end(2 * whole.node_tests + 10, [&] {
          last = limit == 0 ? collide(a, b, {.cache = &cache, .budget = {.max_steps = steps}})
                            : within(a, b, limit, {.cache = &cache, .budget = {.max_steps = steps}});
          return std::pair(last.stats, last.answer != Answer::unknown);
        });
        EXPECT_EQ(last.answer == Answer::yes, wanted);
        EXPECT_LE(effort.node_tests, 2 * whole.node_tests + tests_a_call * effort.calls + tests_a_step);
      }
    }
  }
}

TEST(Endings, ComeWhenEveryDeadlineHasPassed) {
  for (const Ending& s : endings()) {
    SCOPED_TRACE(s.name);
    const Placed a{s.a}, b{s.b, s.pose_b};
    const DistanceResult whole = distance(a, b);
    QueryCache cache;
    const auto passed = std::chrono::steady_clock::now() - std::chrono::seconds(1);
    ask_to_the_end(2 * whole.stats.node_tests + 10, [&] {
      const DistanceResult found = distance(a, b, {.cache = &cache, .budget = {.deadline = passed}});
      return std::pair(found.stats, found.status != Status::interrupted);
    });
  }
}

TEST(Endings, ComeForQueriesThatFollowEachOther) {
  // What one query has left is of use to another that asks less, and never misleads one that asks more.
  Rng rng(1603);
  for (const Ending& s : endings()) {
    SCOPED_TRACE(s.name);
    const Placed a{s.a}, b{s.b, s.pose_b};
    const double truth = distance(a, b).upper;
    QueryCache cache;
    for (int i = 0; i < 60; ++i) {
      const std::uint64_t steps = rng.below(200);
      const double error = rng.below(2) == 0 ? 0 : 0.3;
      if (rng.below(3) == 0) {
        const Answer answer = collide(a, b, {.cache = &cache, .budget = {.max_steps = steps}}).answer;
        ASSERT_TRUE(answer == Answer::unknown || (answer == Answer::yes) == (truth == 0));
      } else {
        const DistanceResult found =
            distance(a, b, {.relative_error = error, .cache = &cache, .budget = {.max_steps = steps}});
        ASSERT_LE(found.lower, truth + 1e-14);
        ASSERT_GE(found.upper, truth - 1e-14);
        if (found.status != Status::interrupted) {
          ASSERT_LE(found.upper, truth * (1 + error) + 1e-14);
        }
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing

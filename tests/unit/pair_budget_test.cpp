// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries for pairs that a budget ends: what they have found by then is right and comes once, and they say that it is
// not all.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <vector>

#include "scenes/scenes.h"
#include "support/keys.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using Clock = std::chrono::steady_clock;

/// Two waves that cross each other, and one that is folded.
struct Waves {
  Model low{scenes::wave_sheet(24, 24, 0)}, high{scenes::wave_sheet(24, 24, 1)};
  Placed a{low}, b{high, {{}, {0.3, 0.2, 0.05}}};
  static constexpr double margin = 0.2;
};

/// Whether `some` are the first of `all`.
template <typename Pair>
bool are_first(const std::vector<Pair>& some, const std::vector<Pair>& all) {
  const auto are_same = [](const Pair& p, const Pair& q) { return ids_of(p) == ids_of(q); };
  return some.size() <= all.size() && std::equal(some.begin(), some.end(), all.begin(), are_same);
}

/// Calls ask(steps) with more and more steps until it says that it has found all.
template <typename Ask>
void ask_with_more_steps(int least_interrupted, const Ask& ask) {
  int interrupted = 0;
  for (std::uint64_t steps = 0; !::testing::Test::HasFailure(); steps = steps * 5 / 4 + 1) {
    SCOPED_TRACE(steps);
    const auto count = ask(steps);
    EXPECT_EQ(count.stopped_by, count.is_complete ? StoppedBy::nothing : StoppedBy::max_steps);
    if (count.is_complete) break;
    ++interrupted;
  }
  EXPECT_GT(interrupted, least_interrupted);
}

/// Asks find(visitor, options) with budgets of more and more steps.
template <typename Pair, typename Find>
void check_steps(const Find& find) {
  std::vector<Pair> all, some;
  find([&](const Pair& p) { return all.push_back(p), true; }, PairOptions{});
  ASSERT_GT(all.size(), 50U);
  std::size_t last = 0;
  ask_with_more_steps(10, [&](std::uint64_t steps) {
    some.clear();
    const PairCount count =
        find([&](const Pair& p) { return some.push_back(p), true; }, PairOptions{.budget = {.max_steps = steps}});
    EXPECT_EQ(count.count, some.size());
    EXPECT_TRUE(are_first(some, all));
    EXPECT_GE(some.size(), last);
    EXPECT_TRUE(steps > 0 || some.empty());
    last = some.size();
    return count;
  });
  EXPECT_EQ(last, all.size());
}

TEST(PairBudget, OfStepsGivesTheFirstPairs) {
  const Waves w;
  check_steps<TrianglePair>(
      [&](auto visit, const auto& options) { return visit_intersections(w.a, w.b, visit, options); });
  check_steps<Contact>(
      [&](auto visit, const auto& options) { return visit_contacts(w.a, w.b, Waves::margin, visit, options); });
  check_steps<Contact>(
      [&](auto visit, const auto& options) { return visit_self_contacts(w.low, 0.4, visit, options); });
}

TEST(PairBudget, OfElementsGivesTheFirstPairs) {
  const Waves w;
  for (const bool is_self : {false, true}) {
    std::vector<VertexFacePair> faces;
    std::vector<EdgeEdgePair> edges;
    const auto find = [&](const ElementPairOptions& options) {
      faces.resize(100'000), edges.resize(100'000);
      const ElementPairCount count = is_self ? self_element_pairs(w.low, 0.3, faces, edges, options)
                                             : element_pairs(w.a, w.b, Waves::margin, faces, edges, options);
      faces.resize(count.vertex_face), edges.resize(count.edge_edge);
      return count;
    };
    find({});
    const std::vector<VertexFacePair> all_faces = faces;
    const std::vector<EdgeEdgePair> all_edges = edges;
    ASSERT_GT(std::min(all_faces.size(), all_edges.size()), 50U);
    ask_with_more_steps(10, [&](std::uint64_t steps) {
      const ElementPairCount some = find({.budget = {.max_steps = steps}});
      EXPECT_TRUE(are_first(faces, all_faces) && are_first(edges, all_edges));
      return some;
    });
    EXPECT_EQ(faces.size(), all_faces.size());
    EXPECT_EQ(edges.size(), all_edges.size());
  }
}

/// Asks find(room, options) for the closest pairs with budgets of more and more steps.
template <typename Find>
void check_closest(const Find& find, const std::vector<Contact>& all, double max_distance) {
  std::vector<Contact> room(40);
  ask_with_more_steps(5, [&](std::uint64_t steps) {
    const PairCount count =
        find(room, ClosestPairsOptions{.max_distance = max_distance, .budget = {.max_steps = steps}});
    EXPECT_LE(count.count, room.size());
    for (std::size_t i = 0; i < count.count; ++i) {
      EXPECT_LE(room[i].distance, max_distance);
      EXPECT_TRUE(i == 0 || room[i - 1].distance <= room[i].distance);
      for (std::size_t j = 0; j < i; ++j) EXPECT_NE(ids_of(room[i]), ids_of(room[j])) << "a pair came twice";
      EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const Contact& c) {
        return ids_of(c) == ids_of(room[i]) && c.distance == room[i].distance;
      }));
    }
    EXPECT_TRUE(!count.is_complete || count.count == std::min(room.size(), all.size()));
    EXPECT_TRUE(steps > 0 || count.is_complete || count.count == 0);
    return count;
  });
}

TEST(PairBudget, OfTheClosestPairsGivesRightOnesNearestFirst) {
  const Waves w;
  std::vector<Contact> all;
  const Placed above{w.high, {{}, {0.3, 0.2, 2}}};
  for (const Placed& b : {w.b, above}) {
    const double near = distance(w.a, b).upper + 0.05;
    all.resize(contacts(w.a, b, near, {}).count);
    contacts(w.a, b, near, all);
    ASSERT_GT(all.size(), 40U);
    check_closest([&](std::span<Contact> room, const auto& options) { return closest_pairs(w.a, b, room, options); },
                  all, near);
  }
  all.resize(self_contacts(w.low, 0.4, {}).count);
  self_contacts(w.low, 0.4, all);
  check_closest([&](std::span<Contact> room, const auto& options) { return self_closest_pairs(w.low, room, options); },
                all, 0.4);
}

TEST(PairBudget, BringsNoPairTwice) {
  const Model one(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}));
  std::vector<Contact> room(3);
  const PairCount count = closest_pairs({one}, {one, {{}, {0, 0, 1}}}, room, {.budget = {.max_steps = 100}});
  EXPECT_EQ(count.count, 1U);
  EXPECT_TRUE(count.is_complete);
}

TEST(PairBudget, IsNotSpentWhereBoundsPruneAll) {
  const Waves w;
  const Placed far{w.high, {{}, {0, 0, 50}}};
  const QueryBudget none{.max_steps = 0};
  std::vector<Contact> room(4);
  EXPECT_TRUE(contacts(w.a, far, Waves::margin, room, {.budget = none}).is_complete);
  EXPECT_TRUE(closest_pairs(w.a, far, room, {.max_distance = Waves::margin, .budget = none}).is_complete);
  EXPECT_TRUE(element_pairs(w.a, far, Waves::margin, {}, {}, {.budget = none}).is_complete);
  EXPECT_FALSE(closest_pairs(w.a, far, room, {.budget = none}).is_complete);
}

TEST(PairBudget, IsLookedAtBetweenTheTrianglesOfLeaves) {
  const Model many(soup(std::vector<Triangle>(60, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}})));
  std::atomic<bool> cancel = false;
  std::size_t seen = 0;
  const auto visit = [&](const TrianglePair&) { return ++seen, cancel = true, true; };
  const PairCount count = visit_intersections({many}, {many}, visit, {.budget = {.cancel = &cancel}});
  EXPECT_EQ(seen, 1U);
  EXPECT_EQ(count.count, 1U);
  EXPECT_FALSE(count.is_complete);
  EXPECT_EQ(count.stopped_by, StoppedBy::cancel);
  EXPECT_EQ(visit_intersections({many}, {many}, visit, {.budget = {.cancel = &cancel}}).count, 0U);
}

TEST(PairBudget, WhoseDeadlineHasPassedEndsSoon) {
  const Model sheet(scenes::wave_sheet(200, 200, 0)), other(scenes::wave_sheet(200, 200, 1));
  const QueryBudget passed{.deadline = Clock::now() - std::chrono::seconds(1)};
  const auto start = Clock::now();
  const PairCount count = contacts({sheet}, {other}, 0.5, {}, {.budget = passed});
  EXPECT_FALSE(count.is_complete);
  EXPECT_EQ(count.stopped_by, StoppedBy::deadline);
  EXPECT_LT(count.stats.primitive_tests, 200U);
  EXPECT_LT(Clock::now() - start, std::chrono::seconds(1));
  EXPECT_EQ(self_contacts(sheet, 0.5, {}, {.budget = passed}).stopped_by, StoppedBy::deadline);
  std::vector<Contact> room(1000);
  EXPECT_EQ(closest_pairs({sheet}, {other}, room, {.budget = passed}).stopped_by, StoppedBy::deadline);
}

TEST(ClosestPairs, WithinADistanceAreThoseAtMostSoFarApart) {
  const Model low(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}})), high(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}));
  const Placed a{low}, b{high, {{}, {0, 0, 0.5}}};
  std::vector<Contact> room(2);
  EXPECT_EQ(closest_pairs(a, b, room, {.max_distance = 0.5}).count, 1U);
  EXPECT_EQ(closest_pairs(a, b, room, {.max_distance = std::nextafter(0.5, 0)}).count, 0U);
  EXPECT_EQ(closest_pairs(a, b, room, {.max_distance = 0}).count, 0U);
  EXPECT_EQ(closest_pairs(a, a, room, {.max_distance = 0}).count, 1U);
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(closest_pairs(a, b, room, {.max_distance = bad}), std::invalid_argument);
    EXPECT_THROW(self_closest_pairs(low, room, {.max_distance = bad}), std::invalid_argument);
  }
}

}  // namespace
}  // namespace limber::testing

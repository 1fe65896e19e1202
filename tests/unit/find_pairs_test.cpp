// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What a search of pairs is made of: the queue by buckets; a collector of all hits, the example of
// docs/design/adding_a_query.md; and the guess of the closest triangles where one model is flat.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include "geometry/primitives.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/bucket_order.h"
#include "pair/collectors/collector.h"
#include "pair/flat_seed.h"
#include "pair/search.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/brute_force.h"
#include "support/random_scene.h"
#include "support/right_answers.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

// --- the queue ---

using pair::BucketQueue;
using pair::NodePair;

NodePair pair_with(float bound_sq) { return {bound_sq, {0, 0}, 0, 0, false, true}; }

// Not inlined: GCC 12 would warn of an overflow that an assertion excludes.
[[gnu::noinline]] void push(BucketQueue& queue, float bound_sq) { queue.push(pair_with(bound_sq)); }
[[gnu::noinline]] void push_first(BucketQueue& queue, float bound_sq) { queue.push_first(pair_with(bound_sq)); }

TEST(BucketQueue, HoldsWhatItWasGivenAndKnowsTheLeast) {
  scenes::Rng rng(60);
  for (int i = 0; i < 200; ++i) {
    const auto queue = std::make_unique<BucketQueue>();
    queue->focus(1, static_cast<float>(rng.uniform(1, 30)));
    std::multiset<float> held;
    const auto pop = [&] {
      ASSERT_EQ(queue->least_bound_sq(), *held.begin());
      const auto taken = held.find(queue->pop().bound_sq);
      ASSERT_NE(taken, held.end());
      held.erase(taken);
    };
    for (std::uint64_t k = rng.below(100); k > 0; --k) {
      const float bound_sq = *held.insert(static_cast<float>(rng.uniform(0, 40)));
      rng.below(8) == 0 ? push_first(*queue, bound_sq) : push(*queue, bound_sq);
      if (rng.below(4) == 0) pop();
      if (rng.below(16) == 0) queue->focus(1, static_cast<float>(rng.uniform(1, 30)));
    }
    while (!queue->empty() && !HasFatalFailure()) pop();
    ASSERT_TRUE(held.empty());
  }
}

TEST(BucketQueue, IsTakenNearestFirstToWithinABucket) {
  scenes::Rng rng(61);
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);
  for (int i = 0; i < 1000; ++i) push(*queue, static_cast<float>(rng.uniform(0, 64)));
  float last = 0;
  while (!queue->empty()) {
    const float bound_sq = queue->pop().bound_sq;
    ASSERT_GT(bound_sq, last - 1);
    last = bound_sq;
  }
  EXPECT_GT(last, 60);
}

TEST(BucketQueue, UsesTheRoomOfTakenPairsAgain) {
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);
  push(*queue, 63);
  for (int i = 0; i < 100'000; ++i) {  // more than there is room for
    push(*queue, 1);
    push(*queue, 2);  // would be taken first if there were no room, and both went to the stack
    ASSERT_EQ(queue->pop().bound_sq, 1) << i;
    ASSERT_EQ(queue->pop().bound_sq, 2) << i;
  }
}

TEST(BucketQueue, IsNotGivenUpWhileAPairIsBelowTheLimit) {
  const auto queue = std::make_unique<BucketQueue>();
  queue->focus(0, 64);  // buckets of width 1
  push(*queue, 10.25F);
  EXPECT_FALSE(queue->all_beyond(10.5F));  // in the bucket of the limit, and below the limit
  EXPECT_FALSE(queue->all_beyond(40));
  EXPECT_TRUE(queue->all_beyond(9.5F));
  push_first(*queue, 50);
  EXPECT_FALSE(queue->all_beyond(9.5F));
}

// --- a collector of all hits ---

/// How many pairs of triangles are at most a given distance apart.
class CountWithin {
 public:
  static constexpr pair::Hits hits = pair::Hits::all;
  static constexpr bool is_self = false;

  explicit CountWithin(double max_distance) : max_distance_(max_distance) {}

  /// Just above the limit: a pair exactly max_distance apart counts.
  double initial_cutoff() const { return std::nextafter(max_distance_, std::numeric_limits<double>::infinity()); }
  bool is_done() const { return false; }

  void compare(const pair::PlacedTriangle& a, const pair::PlacedTriangle& b) {
    if (geometry::closest_points(a.corners, b.corners).distance <= max_distance_) ++count;
  }

  std::uint64_t count = 0;

 private:
  double max_distance_;
};

std::uint64_t count_within(const Placed& a, const Placed& b, double max_distance) {
  const pair::PlacedPair placed(a, b);
  CountWithin collector(max_distance);
  QueryStats stats;
  pair::BudgetMeter meter;
  pair::search_all(placed, collector, meter, stats);
  return collector.count;
}

std::uint64_t brute_force_count(const Placed& a, const Placed& b, double max_distance) {
  return reference::contacts({a.model().mesh(), a.pose}, {b.model().mesh(), b.pose}, max_distance).size();
}

TEST(CountingCollector, IsOfferedEachOfManyCoincidentTriangles) {
  const Triangle low{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, high{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  const Model many(soup(std::vector<Triangle>(500, low))), few(soup(std::vector<Triangle>(3, high)));
  EXPECT_EQ(count_within({many}, {few}, 2), 1500U);
  EXPECT_EQ(count_within({few}, {many}, 2), 1500U);
  EXPECT_EQ(count_within({many}, {few}, 1.9), 0U);
}

TEST(CountingCollector, CountsWhatBruteForceDoesInRandomScenes) {
  Rng rng(801);
  std::uint64_t counted = 0;
  for (int i = 0; i < 500; ++i) {
    const auto s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    // Pairs within rounding of the limit may count or not; contacts are exact.
    const double limit = i % 4 == 0 ? 0 : distance(a, b).upper + rng.uniform(0, 0.1) * s.size;
    const double rounding = limit == 0 ? 0 : s.tolerance;
    const std::uint64_t count = count_within(a, b, limit);
    ASSERT_GE(count, brute_force_count(a, b, std::max(limit - rounding, 0.0))) << i;
    ASSERT_LE(count, brute_force_count(a, b, limit + rounding)) << i;
    counted += count;
  }
  EXPECT_GT(counted, 1000U);
}

// --- the guess ---

using pair::FlatPart;
using pair::PlacedPair;
using pair::Side;

struct Guess {
  std::optional<FlatPart> part;
  std::optional<TrianglePair> pair;
  double distance;  // of the pair
  QueryStats stats;
};

/// What is guessed about two models near two slots.
Guess guess(const Placed& a, const Placed& b, bvh::SlotId near_a = bvh::root_slot,
            bvh::SlotId near_b = bvh::root_slot) {
  const PlacedPair placed(a, b);
  Guess g{pair::flat_part(placed, near_a, near_b), {}, std::numeric_limits<double>::infinity(), {}};
  if (g.part) g.pair = pair::likely_pair(placed, *g.part, g.stats);
  if (g.pair) {
    EXPECT_TRUE(placed.has_triangle(Side::a, g.pair->a) && placed.has_triangle(Side::b, g.pair->b));
    g.distance = closest_points(placed.triangle(Side::a, g.pair->a), placed.triangle(Side::b, g.pair->b)).distance;
  }
  return g;
}

/// A sheet of that many squares, each of size 1, in the plane z = 0, about the origin.
Mesh flat_sheet(std::uint32_t n) { return scenes::grid(n, n, -0.5 * n, -0.5 * n, 1, 1); }

/// What is guessed about a model near each of its leaves and another one.
std::vector<Guess> guesses_at_leaves(const Model& model, const Placed& other) {
  const bvh::Tree& tree = tree_of(model);
  std::vector<Guess> guesses;
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    for (std::uint32_t k = 0; k < tree.nodes[n].child_count; ++k) {
      guesses.push_back(guess({model}, other, n * bvh::width + k));
    }
  }
  return guesses;
}

TEST(LikelyPair, IsTheClosestWhereABallIsOverASquare) {
  Rng rng(1701);
  const Mesh square_mesh = scenes::thesis_square(), ball_mesh = scenes::thesis_ball();
  const Model square(square_mesh), ball(ball_mesh);
  for (const double separation : {64.0, 8.0, 1.0, 0.1, 0.01, 0.001}) {
    for (std::uint32_t pose = 0; pose < 8; ++pose) {
      const Transform world = random_pose(rng, 10);
      const Placed a{square, world}, b{ball, world * scenes::ball_over_square(ball_mesh, separation, pose)};
      for (const Guess& g : {guess(a, b), guess(b, a)}) {
        ASSERT_TRUE(g.part && g.pair) << separation;
        EXPECT_NEAR(g.distance, separation, 1e-12 * (1 + separation));
        EXPECT_NEAR(dot(g.part->normal, world.rotation * Vec3{0, 0, 1}), 1, 1e-6);
        EXPECT_LE(g.part->room, separation + 1e-6);
        EXPECT_GE(g.part->room, separation - 0.375);
      }
      EXPECT_EQ(guess(a, b).part->side, Side::a);
      EXPECT_EQ(guess(b, a).part->side, Side::b);
    }
  }
}

TEST(LikelyPair, NeedsAFlatModelAtLeastAsLargeAsTheOtherWhichIsOnOneSideOfIt) {
  const Model ball(scenes::thesis_ball()), small_sheet(flat_sheet(1)), sheet(flat_sheet(2)),
      wave(scenes::wave_sheet(40, 40, 1)), square(scenes::thesis_square());
  const Transform above{{}, {0, 0, 3}};
  const struct {
    const Model &a, &b;
    Transform pose;
    bool has_part, has_pair;
  } cases[] = {
      {ball, ball, above, false, false},
      {small_sheet, ball, above, false, false},
      {wave, ball, above, false, false},
      {sheet, small_sheet, above, true, true},
      {square, ball, {{}, {1, 2, -3}}, true, true},
      {square, ball, scenes::ball_over_square(ball.mesh(), -0.001, 1), true, false},
      {square, ball, scenes::ball_over_square(ball.mesh(), -0.9, 1), true, false},
  };
  for (const auto& [a, b, pose, has_part, has_pair] : cases) {
    SCOPED_TRACE(pose.translation.z);
    const Guess g = guess({a}, {b, pose});
    EXPECT_EQ(g.part.has_value(), has_part);
    EXPECT_EQ(g.pair.has_value(), has_pair);
  }
  const Guess below = guess({square}, {ball, {{}, {1, 2, -3}}});
  EXPECT_NEAR(below.part.value().normal.z, -1, 1e-6);
  EXPECT_NEAR(below.distance, 2, 1e-12);
}

TEST(LikelyPair, IsNotLookedForOnPartsSmallerThanTheOtherModel) {
  Mesh mesh = scenes::grid(2, 2, 0, 0, 0.5, 0.5);  // flights of stairs, each step as large as the leaf that holds it
  const Mesh step = mesh;
  for (int k = 1; k < 64; ++k) {
    mesh = joined(mesh, mapped(step, [&](const Vec3& p) { return p + Vec3{1.0 * k, 0, 0.5 * k}; }));
  }
  const Model stairs(mesh), small(scenes::grid(1, 1, 0, 0, 0.1, 0.1)), large(scenes::thesis_ball());
  const Transform above{{}, {20, 0, 30}};
  int flat = 0;
  for (const Guess& g : guesses_at_leaves(stairs, {small, above})) flat += g.part ? 1 : 0;
  for (const Guess& g : guesses_at_leaves(stairs, {large, above})) EXPECT_FALSE(g.part);
  EXPECT_GT(flat, 50);
}

TEST(LikelyPair, IsFoundWhereAPartOfAModelIsFlat) {
  // A sheet with a ball on it.
  const Mesh ball = mapped(scenes::ball(24, 12), [](const Vec3& p) { return p + Vec3{-7, 0, 1}; });
  const Model floor(joined(flat_sheet(20), ball)), object(scenes::ball(4, 2));
  const Placed above{object, {{}, {6, 5, 1.5}}};
  EXPECT_FALSE(guess({floor}, above).part);  // as a whole it is not flat
  int found = 0;
  for (const Guess& g : guesses_at_leaves(floor, above)) {
    if (!g.part) continue;
    ++found;
    EXPECT_GE(g.part->radius, 1);
    EXPECT_NEAR(g.distance, 0.5, 1e-12);
  }
  EXPECT_GT(found, 20);
}

TEST(LikelyPair, TakesAFixedNumberOfStepsWhateverTies) {
  const Mesh sheet = flat_sheet(200);
  const Model a(sheet), b(sheet);
  const Guess g = guess({a}, {b, {{}, {0.3, 0.2, 0.1}}});
  ASSERT_TRUE(g.pair);
  EXPECT_LE(g.stats.node_tests, 2U * 32 * bvh::width);
  Rng rng(1703);
  const Mat3 turn = scenes::random_rotation(rng);
  const Model c(mapped(flat_sheet(100), [&](const Vec3& p) {  // turned, so that all boxes reach below all vertices
    return turn * (p + Vec3{0, 0, 0.001 * rng.uniform()});
  }));
  const Guess above = guess({a}, {c, {transpose(turn), {0, 0, 2}}});
  ASSERT_TRUE(above.pair);
  EXPECT_NEAR(above.distance, 2, 0.001);
  EXPECT_LE(above.stats.node_tests, 2U * 32 * bvh::width);
  const std::vector<Triangle> one_place(5000, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const Model same(soup(one_place));
  EXPECT_NEAR(guess({same}, {same, {{}, {0, 0, 2}}}).distance, 2, 1e-12);
}

// Poses that have nothing to do with each other, so that the pair from the last query is far from the closest.
TEST(LikelyPair, IsLookedForLaterThanAPairFromTheLastQuery) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  QueryCache cache;
  std::uint64_t primitive_tests = 0;
  for (std::uint32_t index = 0; index < 16; ++index) {
    const Transform pose = scenes::ball_over_square(ball.mesh(), 64, index);
    const DistanceResult warm = distance({square}, {ball, pose}, {.cache = &cache});
    EXPECT_NEAR(warm.upper, 64, 1e-12);
    primitive_tests += warm.stats.primitive_tests;
  }
  EXPECT_LE(primitive_tests, 500U);  // 870 without
}

TEST(LikelyPair, IsOfNoHarmWhereItIsWrong) {
  Rng rng(1702);
  int flat = 0;
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const double scale = rng.below(4) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150) : 1;
    const std::uint32_t n = some(rng, 1, 12);
    // Flat, but for some bumps, or as good as flat.
    const double height = rng.below(2) == 0 ? std::pow(10.0, rng.uniform(-12, 0)) : 0;
    const Mesh ground = mapped(flat_sheet(n), [&](const Vec3& p) {
      return scale * Vec3{p.x, p.y, rng.below(8) == 0 ? height * rng.uniform(-1, 1) : 0};
    });
    const Mesh object = arbitrary_mesh(rng, 20, {}, scale * std::pow(2.0, rng.uniform(-6, 1)));
    Transform pose_ground = random_pose(rng, 3), pose = random_pose(rng, 0.7 * n);
    pose_ground.translation *= scale, pose.translation *= scale;
    const Model model_ground(ground), model(object);
    const Placed a{model_ground, pose_ground}, b{model, pose};
    const Truth truth{brute_force_distance({ground, pose_ground}, {object, pose}), 1e-14 * scale * 40};
    for (const double error : {0.0, 0.1}) {
      const DistanceOptions options{.relative_error = error};
      ASSERT_EQ(wrong_answer(distance(a, b, options), options, a, b, truth), "") << error;
    }
    flat += guess(a, b).pair ? 1 : 0;
  }
  EXPECT_GT(flat, 500);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Where one model is flat, the closest triangles are guessed.
#include "limber/distance.h"
#include "pair/traversal_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "scenes/scenes.h"
#include "support/brute_force.h"
#include "support/random_scene.h"
#include "support/right_answers.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

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

TEST(LikelyPair, IsOnTheSideWhereTheOtherModelIsAndNoneWhereThatReachesBeyondThePlane) {
  const Mesh ball_mesh = scenes::thesis_ball();
  const Model square(scenes::thesis_square()), ball(ball_mesh);
  const Guess below = guess({square}, {ball, {{}, {1, 2, -3}}});
  ASSERT_TRUE(below.pair);
  EXPECT_NEAR(below.part->normal.z, -1, 1e-6);
  EXPECT_NEAR(below.distance, 2, 1e-12);
  for (const double separation : {-0.001, -0.1, -0.9}) {
    const Guess g = guess({square}, {ball, scenes::ball_over_square(ball_mesh, separation, 1)});
    ASSERT_TRUE(g.part);
    EXPECT_FALSE(g.pair) << separation;
  }
}

TEST(LikelyPair, NeedsAFlatModelAtLeastAsLargeAsTheOther) {
  const Model ball(scenes::thesis_ball()), small_sheet(flat_sheet(1)), sheet(flat_sheet(2)),
      wave(scenes::wave_sheet(40, 40, 1));
  const Transform above{{}, {0, 0, 3}};
  EXPECT_FALSE(guess({ball}, {ball, above}).part);
  EXPECT_FALSE(guess({small_sheet}, {ball, above}).part);
  EXPECT_FALSE(guess({wave}, {ball, above}).part);
  EXPECT_TRUE(guess({sheet}, {small_sheet, above}).part);
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

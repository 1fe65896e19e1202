// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "pair/pruning.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/error_bounds.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/placed_pair.h"
#include "pair/query_cache_impl.h"
#include "pair/traversal_state.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/internals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

using pair::BoundUpdate;
using pair::PlacedLeaf;
using pair::PlacedPair;
using pair::Pruning;
using pair::Side;

const Triangle level_triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

Triangle lifted(const Triangle& t, double height) {
  return mapped(t, [height](const Vec3& p) { return p + Vec3{0, 0, height}; });
}

/// Two models and their first leaves. Both poses shift them, so placing might round, though here it does not.
struct TwoLeaves {
  PlacedPair placed;
  PlacedLeaf leaf_a{placed, Side::a}, leaf_b{placed, Side::b};

  TwoLeaves(const Model& a, const Model& b) : placed({a, {{}, {1, 2, 3}}}, {b, {{}, {1, 2, 3}}}) {
    leaf_a.take(tree_of(a).leaves[0]), leaf_b.take(tree_of(b).leaves[0]);
  }
};

/// A triangle below another one.
struct ModelsOfTwo {
  Model a{soup({level_triangle})}, b;
  explicit ModelsOfTwo(double height) : b(soup({lifted(level_triangle, height)})) {}
};
struct TwoTriangles : ModelsOfTwo, TwoLeaves {
  explicit TwoTriangles(double height) : ModelsOfTwo(height), TwoLeaves(a, b) {}

  bool is_pruned_after(const BoundUpdate& update) {
    Pruning pruning(placed, 1000);
    pruning.update(update);
    return pruning.prunes(leaf_a, 0, leaf_b, 0);
  }
};

/// Whether no triangles of two leaves need be compared. What is said of their distance is checked.
bool prunes(const Pruning& pruning, PlacedLeaf& a, PlacedLeaf& b) {
  double apart = 0;
  const bool is_pruned = pruning.prunes(a, b, apart);
  for (std::uint32_t i = 0; is_pruned && i < bvh::width; ++i) {
    for (std::uint32_t k = 0; k < bvh::width; ++k) {
      EXPECT_LE(apart, closest_points(a.at(i).corners, b.at(k).corners).distance * (1 + 1e-15));
    }
  }
  return is_pruned;
}

TEST(Pruning, ComparesWhatIsNearerThanThePruneDistance) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  struct Known {
    double height;
    BoundUpdate update;
    bool is_pruned;
  };
  const Vec3 up{0, 0, 1};
  for (const Known& k : {Known{2, {1, 1, up}, true}, Known{0.5, {1, 1, up}, false}, Known{0, {1, 1, up}, false},
                         Known{1, {1, 1, up}, true},  // a tie
                         // An error is asked for: what is pruned has to be at least the cutoff apart, whatever rounding
                         // does.
                         Known{1, {2, 1, up}, false}, Known{1 + 0x1p-30, {2, 1, up}, true},
                         Known{1000, {1001, infinity, up}, false}}) {  // may be within the limit
    TwoTriangles scene(k.height);
    EXPECT_EQ(scene.is_pruned_after(k.update), k.is_pruned) << k.height;
    Pruning pruning(scene.placed, 1000);
    pruning.update(k.update);
    EXPECT_EQ(prunes(pruning, scene.leaf_a, scene.leaf_b), k.is_pruned) << k.height;
  }
}

TEST(Pruning, ComparesTiesWhereTheyAreToBeCompared) {
  for (const double height : {1.0, 1 + 0x1p-52, 1 - 0x1p-53, 1 + 0x1p-48}) {
    TwoTriangles scene(height);
    Pruning pruning(scene.placed, 1000, pair::Ties::compared);
    pruning.update({1, 1, {0, 0, 1}});
    EXPECT_FALSE(pruning.prunes(scene.leaf_a, 0, scene.leaf_b, 0)) << height;
  }
  TwoTriangles scene(1 + 0x1p-30);
  Pruning pruning(scene.placed, 1000, pair::Ties::compared);
  pruning.update({1, 1, {0, 0, 1}});
  EXPECT_TRUE(pruning.prunes(scene.leaf_a, 0, scene.leaf_b, 0));
}

TEST(Pruning, TakesForTiesOnlyWhatRoundingOfTheModelsAsTheyAreCanHide) {
  // A vertex of b has come home from 2^50 within the motion margin. The bounds, and the rounding that they allow for,
  // are as large.
  const double far = 0x1p50, height = 999.75, distance = 1000;
  const Model a(soup({level_triangle}));
  Model b(soup({{{0, 0, height}, {1, 0, height}, {0, far, height}}}), {.motion_margin = 2 * far});
  ASSERT_TRUE(b.move_all(std::vector<Vec3>{{0, 0, height}, {1, 0, height}, {0, 1, height}}));
  b.commit();
  ASSERT_GE(tree_of(b).slack, far / 2);
  TwoLeaves two(a, b);
  ASSERT_LT(distance - height, base::usual_local_gap_part * base::local_gap_error * two.placed.error());
  Pruning pruning(two.placed, 2 * distance);
  pruning.update({distance, distance, {0, 0, 1}});
  EXPECT_FALSE(pruning.prunes(two.leaf_a, 0, two.leaf_b, 0));
  pruning.update({height, height, {0, 0, 1}});
  EXPECT_TRUE(pruning.prunes(two.leaf_a, 0, two.leaf_b, 0));
}

TEST(Pruning, PrunesTwoLeavesIfAllTheirTrianglesAreFarEnoughApart) {
  const Triangle hill{{0, 0, 0}, {1, 0, 0.25}, {0, 1, 0}};
  const Model a(soup({level_triangle, hill})),
      b(soup({lifted(level_triangle, 1), lifted(level_triangle, 2), lifted(level_triangle, 3)}));
  TwoLeaves two(a, b);
  Pruning pruning(two.placed, 1000);
  EXPECT_FALSE(prunes(pruning, two.leaf_a, two.leaf_b));  // no direction yet
  pruning.update({1, 1, {0, 0, 1}});
  EXPECT_FALSE(prunes(pruning, two.leaf_a, two.leaf_b));
  EXPECT_TRUE(pruning.prunes(two.leaf_a, 0, two.leaf_b, 0));  // a tie
  pruning.update({0.75 + 0x1p-30, 0.75 + 0x1p-30, {0, 0, 1}});
  EXPECT_FALSE(prunes(pruning, two.leaf_a, two.leaf_b));
  pruning.update({0.75, 0.75, {0, 0, 1}});
  EXPECT_TRUE(prunes(pruning, two.leaf_a, two.leaf_b));  // a tie
  pruning.restore_direction(Vec3{0, 1, 0});
  EXPECT_FALSE(prunes(pruning, two.leaf_a, two.leaf_b));
  pruning.restore_direction(Vec3{0, 0, 1});
  EXPECT_TRUE(prunes(pruning, two.leaf_a, two.leaf_b));
}

TEST(Pruning, KnowsWhichLeavesItIsAskedAbout) {
  std::vector<Triangle> triangles;
  triangles.reserve(64);
  for (int k = 0; k < 64; ++k)
    triangles.push_back({{3.0 * k, 0, 0.1 * k}, {3.0 * k + 1, 0, 0.1 * k}, {3.0 * k, 1, 0.1 * k}});
  const Model stairs(soup(triangles)), roof(soup({{{0, 0, 10}, {200, 0, 10}, {0, 1, 10}}}));
  TwoLeaves two(stairs, roof);
  Pruning pruning(two.placed, 1000);
  pruning.update({6, 6, {0, 0, 1}});
  int pruned = 0;
  for (const bvh::Leaf& l : tree_of(stairs).leaves) {
    double most = 0;
    for (const TriangleId t : l.triangle) most = std::max(most, triangles[t].v0.z);
    two.leaf_a.take(l);
    ASSERT_EQ(prunes(pruning, two.leaf_a, two.leaf_b), 10 - most > 6) << most;
    ASSERT_EQ(two.leaf_a.at(7).corners.v0, triangles[l.triangle[7]].v0 + (Vec3{1, 2, 3}));
    pruned += 10 - most > 6 ? 1 : 0;
  }
  EXPECT_GT(pruned, 2);
  EXPECT_LT(pruned, 7);
}

TEST(WholeLeaves, AreTriedWhileThatPrunes) {
  pair::WholeLeaves leaves;
  EXPECT_FALSE(leaves.are_tested());
  leaves.allow_some();
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(leaves.are_tested()) << i;
    leaves.note(false);
  }
  EXPECT_FALSE(leaves.are_tested());
  leaves.allow_many();
  for (int i = 0; i < 1000; ++i) leaves.note(true);  // no success counts for more than some failures later
  for (int i = 0; i < 64; ++i) leaves.note(false);
  EXPECT_FALSE(leaves.are_tested());
  // One success in three tries is enough.
  leaves.allow_some();
  for (int i = 0; i < 1000; ++i) leaves.note(i % 3 == 0);
  EXPECT_TRUE(leaves.are_tested());
}

TEST(SquaredLimits, AreInTheUnitOfEitherTreeAndPruneNoContact) {
  const Model small(scenes::ball(8, 6));
  const Model large(scaled(small.mesh(), 1000));
  const pair::PlacedPair placed({small}, {large});
  pair::SquaredLimits limits(placed);
  EXPECT_TRUE(limits.update(3));
  EXPECT_FALSE(limits.update(3));
  for (const Side s : {Side::a, Side::b}) {
    const double units = 3 / placed.tree(s).unit;
    EXPECT_GE(static_cast<double>(limits.of(s)), units * units);
    EXPECT_LE(static_cast<double>(limits.of(s)), units * units * 1.001);
  }
  EXPECT_TRUE(limits.update(std::numeric_limits<double>::min()));
  EXPECT_GT(limits.of(Side::a), 0);
  EXPECT_GT(limits.of(Side::b), 0);
  EXPECT_TRUE(limits.update(std::numeric_limits<double>::infinity()));
  EXPECT_EQ(limits.of(Side::b), pair::no_limit_sq);
}

TEST(SquaredLimits, RoundBoundsDown) {
  const Model model(scenes::ball(8, 6));
  const pair::PlacedPair placed({model}, {model});
  const pair::SquaredLimits limits(placed);
  for (const double length : {0.0, 1e-15, 0.1, 1.0, 12345.678}) {
    const double back = limits.length_of(Side::a, limits.bound_of(length));
    EXPECT_LE(back, length);
    EXPECT_GE(back, length * (1 - 1e-5));
  }
  EXPECT_EQ(limits.bound_of(std::numeric_limits<double>::max()), pair::largest_bound_sq);
  EXPECT_EQ(limits.bound_of_child(Side::a, 2, 3), 3);
  EXPECT_EQ(limits.bound_of_child(Side::a, 4, 3), 4);
  EXPECT_LT(limits.bound_of_child(Side::b, std::numeric_limits<float>::max(), 3), pair::no_limit_sq);
}

using pair::Trial;

/// How many of 1000 queries try what changes the time of each by `gain`.
int tries(Trial& trial, double gain) {
  int count = 0;
  for (int i = 0; i < 1000; ++i) {
    if (!trial.is_due()) continue;
    ++count;
    trial.add_gain(gain);
  }
  return count;
}

TEST(Trial, GoesOnForeverWithWhatPays) {
  Trial trial;
  EXPECT_EQ(tries(trial, 0.1), 1000);
}

TEST(Trial, SpendsFewQueriesOnWhatDoesNotPay) {
  for (const double loss : {0.1, 0.25, 0.5}) {
    Trial trial;
    const int count = tries(trial, -loss);
    EXPECT_GT(count, 10) << loss;
    EXPECT_LT(count * loss, 1000 / 50) << loss;  // 2 % of the time of all queries
  }
}

TEST(Trial, NoticesSoonThatSomethingPaysNowOrNoLonger) {
  Trial trial;
  tries(trial, -0.25);
  int waited = 0;
  while (!trial.is_due()) ++waited;
  EXPECT_LT(waited, 50);
  EXPECT_GT(tries(trial, 0.5), 900);
  EXPECT_LT(tries(trial, -0.25), 100);
}

TEST(PlacedPair, ErrorCoversTheCoordinatesOfModelsThatDriftVertexByVertex) {
  // Few vertices at a time, so the tree is never fitted whole, and its root keeps its origin for long.
  Model model(scenes::ball(60, 31), {.rebuild_policy = RebuildPolicy::off});
  const Model still(scenes::ball(6, 4));
  const std::vector<Vec3> home = model.mesh().positions();
  for (int step = 1; step <= 8; ++step) {
    for (std::size_t first = 0; first < home.size(); first += 8) {
      std::vector<VertexId> ids;
      std::vector<Vec3> to;
      for (std::size_t v = first; v < std::min(first + 8, home.size()); ++v) {
        ids.push_back(static_cast<VertexId>(v)), to.push_back(home[v] + Vec3{10.0 * step, 5.0 * step, 0});
      }
      ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, to)));
      model.commit();
    }
    double largest = 0;
    for (const Vec3& p : model.mesh().positions()) largest = std::max(largest, max_abs(p));
    ASSERT_GE(pair::PlacedPair({model}, {still}).error(), 0x1p-45 * largest) << step;
  }
}

TEST(PlacedPair, BoundOfTheRootsHoldsWhereSquaresOfLengthsUnderflow) {
  const Mesh ball = scenes::ball(10, 5);
  for (int exponent = -480; exponent >= -560; --exponent) {
    // Next to their distance the models are nearly points.
    const double distance = std::ldexp(1.3, exponent), size = std::ldexp(distance, -34);
    const Mesh tiny = scaled(ball, size);
    const Model model(tiny);
    const Transform pose{{}, {0.6 * distance, 0.64 * distance, 0.48 * distance}};
    const double expected = reference::distance({tiny}, {tiny, pose}).upper;
    EXPECT_LE(pair::PlacedPair({model}, {model, pose}).root_bound(), expected) << exponent;
    const DistanceResult found = limber::distance({model}, {model, pose});
    EXPECT_NEAR(found.upper / expected, 1, 1e-13) << exponent;
    EXPECT_LE(found.lower, found.upper) << exponent;
    EXPECT_TRUE(within({model}, {model, pose}, expected * (1 + 1e-13)).is_yes()) << exponent;
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The small classes that decide what a best-first traversal does on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "pair/placed_pair.h"
#include "pair/squared_limits.h"
#include "pair/trial.h"
#include "pair/whole_leaves.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

using pair::Side;

TEST(WholeLeaves, AreTriedWhileThatPrunes) {
  pair::WholeLeaves leaves;
  EXPECT_FALSE(leaves.are_tried());
  leaves.try_some();
  for (int i = 0; i < 8; ++i) {
    EXPECT_TRUE(leaves.are_tried()) << i;
    leaves.note(false);
  }
  EXPECT_FALSE(leaves.are_tried());
  leaves.try_many();
  for (int i = 0; i < 1000; ++i) leaves.note(true);  // no success counts for more than some failures later
  for (int i = 0; i < 64; ++i) leaves.note(false);
  EXPECT_FALSE(leaves.are_tried());
  // One success in three tries is enough.
  leaves.try_some();
  for (int i = 0; i < 1000; ++i) leaves.note(i % 3 == 0);
  EXPECT_TRUE(leaves.are_tried());
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
  EXPECT_EQ(limits.of(Side::b), pair::BucketQueue::no_limit_sq);
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
  EXPECT_EQ(limits.bound_of(std::numeric_limits<double>::max()), pair::BucketQueue::largest_bound);
  EXPECT_EQ(limits.bound_of_child(Side::a, 2, 3), 3);
  EXPECT_EQ(limits.bound_of_child(Side::a, 4, 3), 4);
  EXPECT_LT(limits.bound_of_child(Side::b, std::numeric_limits<float>::max(), 3), pair::BucketQueue::no_limit_sq);
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

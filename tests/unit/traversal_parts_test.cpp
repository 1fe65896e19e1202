// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The small classes that decide what a best-first traversal does on its way.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "limber/model.h"
#include "pair/descents.h"
#include "pair/expansion.h"
#include "pair/squared_limits.h"
#include "pair/whole_leaves.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using pair::Side;

TEST(Descents, BeginWithOneThatEndsAtTheFirstLeaves) {
  pair::Descents descents;
  EXPECT_TRUE(descents.is_descending());
  EXPECT_FALSE(descents.has_reached_leaves());
  EXPECT_FALSE(descents.is_due(1'000'000));
  EXPECT_TRUE(descents.end_at_leaves(5));
  EXPECT_TRUE(descents.has_reached_leaves());
  EXPECT_FALSE(descents.is_descending());
  EXPECT_FALSE(descents.end_at_leaves(6));
}

TEST(Descents, AreDueAfterStepsWithoutLeavesAndAtThreeTimesTheStepOfTheLast) {
  pair::Descents descents;
  descents.end_at_leaves(5);
  EXPECT_FALSE(descents.is_due(13));
  EXPECT_TRUE(descents.is_due(14));
  descents.end_at_leaves(10);
  EXPECT_FALSE(descents.is_due(18));
  EXPECT_TRUE(descents.is_due(19));
  descents.start(20, true);
  EXPECT_TRUE(descents.is_descending());
  descents.end_at_leaves(22);
  EXPECT_FALSE(descents.is_due(59));
  EXPECT_TRUE(descents.is_due(60));
  descents.start(60, false);
  EXPECT_FALSE(descents.is_descending());
  EXPECT_FALSE(descents.is_due(179));
}

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
  std::vector<Vec3> positions(small.mesh().positions().begin(), small.mesh().positions().end());
  for (Vec3& p : positions) p = 1000 * p;
  const Model large(Mesh::create(positions, small.mesh().triangles()).value());
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

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

#include "limber/classic.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

TEST(ClassicDistance, OfSingleTrianglesIsThatOfThePrimitive) {
  const Triangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const classic::Model a(soup({unit})), b(soup({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  const DistanceResult r = classic::distance({a}, {b});
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.lower, 2);
  EXPECT_EQ(r.status, Status::exact);
  EXPECT_EQ(r.witness->triangle_a, 0U);
  EXPECT_EQ(r.stats.node_tests, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 1U);
}

TEST(ClassicDistance, AContactIsFoundEvenWhenThePruneDistanceUnderflows) {
  // The first pair that the query compares is 1e-20 apart. Its distance divided by 1 + the error underflows to 0. The
  // contact must not be pruned all the same.
  const Triangle near{{1, 1, 1e-20}, {1, 1, 3}, {1, 1.5, 3}}, touching{{4, 1, 0}, {4, 1, 3}, {4, 1.5, 3}};
  const classic::Model a(soup({near, touching})), b(soup({{{0, 0, 0}, {20, 0, 0}, {0, 20, 0}}}));
  const DistanceResult r = classic::distance({a}, {b}, {.relative_error = 1e308});
  EXPECT_EQ(r.status, Status::collision);
  EXPECT_EQ(r.stats.triangle_tests, 2U);
}

TEST(ClassicDistance, ErrorSavesWorkAndKeepsItsPromise) {
  const classic::Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const Transform pose = scenes::ball_over_square(ball.mesh(), 4, 0);
  const DistanceResult exact = classic::distance({square}, {ball, pose});
  EXPECT_NEAR(exact.upper, 4, 1e-13);
  std::uint64_t tests = exact.stats.node_tests;
  for (const double error : {0.01, 0.1, 0.5, 1.0}) {
    const DistanceResult r = classic::distance({square}, {ball, pose}, {.relative_error = error});
    EXPECT_LE(exact.upper, r.upper);
    EXPECT_LE(r.upper, exact.upper * (1 + error));
    EXPECT_LE(r.lower, exact.upper);
    EXPECT_GE(r.lower * (1 + error), r.upper * (1 - 1e-15));
    EXPECT_LT(r.stats.node_tests, tests);
    tests = r.stats.node_tests;
  }
}

TEST(ClassicCollide, StopsAtTheFirstPair) {
  const classic::Model a(scenes::thesis_ball()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b});
  ASSERT_TRUE(r.is_yes());
  EXPECT_LT(r.stats.triangle_tests, 20U);
  EXPECT_TRUE(intersects(a.mesh().triangle(r.witness->triangle_a), b.mesh().triangle(r.witness->triangle_b)));
}

TEST(ClassicCollide, FarModelsCostOneTest) {
  const classic::Model a(scenes::thesis_square()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b, {{}, {0, 0, 50}}});
  EXPECT_FALSE(r.is_yes());
  EXPECT_FALSE(r.witness.has_value());
  EXPECT_EQ(r.stats.node_tests, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 0U);
}

TEST(ClassicQueries, DoTheWorkThatWasMeasured) {
  // The counts are the same on every machine. Other counts mean another traversal, and then the experiments have to be
  // run again.
  const classic::Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const Transform pose = scenes::ball_over_square(ball.mesh(), 0.1, 0);
  const QueryStats collide = classic::collide({square}, {ball, pose}).stats;
  EXPECT_EQ(collide.node_tests, 6919U);
  EXPECT_EQ(collide.triangle_tests, 560U);
  const QueryStats distance = classic::distance({square}, {ball, pose}).stats;
  EXPECT_EQ(distance.node_tests, 29055U);
  EXPECT_EQ(distance.triangle_tests, 5914U);
}

TEST(Reference, PicksTheFirstPairInTheOrderOfIds) {
  const Triangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  const Mesh a = soup({unit, unit}), b = soup({{{0, 0, 9}, {1, 0, 9}, {0, 1, 9}}, {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}});
  const DistanceResult r = reference::distance({a}, {b});
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.witness->triangle_a, 0U);
  EXPECT_EQ(r.witness->triangle_b, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 4U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <thread>
#include <vector>

#include "limber/classic.h"
#include "limber/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using classic::Model;

const Triangle unit{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

TEST(ClassicDistance, OfSingleTrianglesIsThatOfThePrimitive) {
  const Model a(soup({unit})), b(soup({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  const DistanceResult r = classic::distance({a}, {b});
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.lower, 2);
  EXPECT_EQ(r.status, Status::exact);
  EXPECT_EQ(r.witness.triangle_a, 0U);
  EXPECT_EQ(r.stats.node_tests, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 1U);
}

TEST(ClassicDistance, PointsAreInTheWorldFrame) {
  const Model a(soup({unit})), b(soup({unit}));
  const Transform up{{}, {0, 0, 7}}, higher{{}, {0, 0, 10}};
  const DistanceResult r = classic::distance({a, up}, {b, higher});
  EXPECT_EQ(r.upper, 3);
  EXPECT_EQ(r.witness.point_a.z, 7);
  EXPECT_EQ(r.witness.point_b.z, 10);
}

TEST(ClassicDistance, TrianglesAreSurfacesNotSolids) {
  const Model shell(scenes::ball(32, 17));
  std::vector<Vec3> positions = scenes::ball(16, 9).positions();
  for (Vec3& p : positions) p *= 0.25;
  const Model kernel(Mesh::create(positions, scenes::ball(16, 9).triangles()).value());
  EXPECT_FALSE(classic::collide({shell}, {kernel}).collision);
  EXPECT_GT(classic::distance({shell}, {kernel}).upper, 0.7);
}

TEST(ClassicDistance, TouchingIsCollidingAtEveryError) {
  const Model a(soup({unit})), b(soup({{{1, 0, 0}, {3, 0, 1}, {3, 1, 1}}}));
  EXPECT_TRUE(classic::collide({a}, {b}).collision);
  for (const double error : {0.0, 0.5, 100.0, 1e308}) {
    const DistanceResult r = classic::distance({a}, {b}, {.relative_error = error});
    EXPECT_EQ(r.status, Status::collision);
    EXPECT_EQ(r.upper, 0);
    EXPECT_EQ(r.witness.point_a, (Vec3{1, 0, 0}));
    EXPECT_EQ(r.witness.point_b, (Vec3{1, 0, 0}));
  }
}

TEST(ClassicDistance, AContactIsFoundEvenWhenTheCutUnderflows) {
  // The pair that is looked at first is 1e-20 apart; divided by the error that is 0, yet the contact must not be
  // dropped.
  const Triangle near{{1, 1, 1e-20}, {1, 1, 3}, {1, 1.5, 3}}, touching{{4, 1, 0}, {4, 1, 3}, {4, 1.5, 3}};
  const Model a(soup({near, touching})), b(soup({{{0, 0, 0}, {20, 0, 0}, {0, 20, 0}}}));
  const DistanceResult r = classic::distance({a}, {b}, {.relative_error = 1e308});
  EXPECT_EQ(r.status, Status::collision);
  EXPECT_EQ(r.stats.triangle_tests, 2U);
}

TEST(ClassicDistance, TheSmallestGapIsNotAContact) {
  const double gap = std::numeric_limits<double>::denorm_min();
  const Model a(soup({unit})), b(soup({{{0.2, 0.2, gap}, {3, 0, 1}, {3, 1, 1}}}));
  EXPECT_FALSE(classic::collide({a}, {b}).collision);
  EXPECT_GT(classic::distance({a}, {b}).upper, 0);
}

TEST(ClassicDistance, ErrorSavesWorkAndKeepsItsPromise) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
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
  const Model a(scenes::thesis_ball()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b});
  ASSERT_TRUE(r.collision);
  EXPECT_LT(r.stats.triangle_tests, 20U);
  EXPECT_TRUE(intersects(a.mesh().triangle(r.witness->triangle_a), b.mesh().triangle(r.witness->triangle_b)));
}

TEST(ClassicCollide, FarModelsCostOneTest) {
  const Model a(scenes::thesis_square()), b(scenes::thesis_ball());
  const CollideResult r = classic::collide({a}, {b, {{}, {0, 0, 50}}});
  EXPECT_FALSE(r.collision);
  EXPECT_FALSE(r.witness.has_value());
  EXPECT_EQ(r.stats.node_tests, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 0U);
}

TEST(ClassicQueries, DoTheWorkThatWasMeasured) {
  // The counts are the same on every machine; a change here is a change of the descent and belongs into the
  // experiments.
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const Transform pose = scenes::ball_over_square(ball.mesh(), 0.1, 0);
  const QueryStats collide = classic::collide({square}, {ball, pose}).stats;
  EXPECT_EQ(collide.node_tests, 6919U);
  EXPECT_EQ(collide.triangle_tests, 560U);
  const QueryStats distance = classic::distance({square}, {ball, pose}).stats;
  EXPECT_EQ(distance.node_tests, 29055U);
  EXPECT_EQ(distance.triangle_tests, 5914U);
}

TEST(ClassicQueries, EqualTheReferenceOnLatticeAndUniformSoups) {
  Rng rng(70);
  for (int i = 0; i < 3000; ++i) {
    const Model a(i % 2 == 0 ? scenes::lattice_soup(rng, 6, 4) : scenes::random_soup(rng, 6, 2));
    const Model b(i % 2 == 0 ? scenes::lattice_soup(rng, 6, 4) : scenes::random_soup(rng, 6, 2));
    const DistanceResult truth = reference::distance({a.mesh()}, {b.mesh()});
    const DistanceResult found = classic::distance({a}, {b});
    ASSERT_EQ(found.upper, truth.upper) << "case " << i;
    ASSERT_EQ(classic::collide({a}, {b}).collision, truth.upper == 0) << "case " << i;
    ASSERT_EQ(reference::collide({a.mesh()}, {b.mesh()}).collision, truth.upper == 0) << "case " << i;
  }
}

TEST(ClassicQueries, HoldFarFromTheOrigin) {
  Rng rng(71);
  for (int i = 0; i < 200; ++i) {
    const Model a(scenes::random_soup(rng, 10, 2)), b(scenes::random_soup(rng, 10, 2));
    const Transform far_a{scenes::random_rotation(rng), {1e8, -1e8, 3e8}};
    const Transform far_b{scenes::random_rotation(rng), {1e8 + 1, -1e8, 3e8}};
    const DistanceResult truth = reference::distance({a.mesh(), far_a}, {b.mesh(), far_b});
    const DistanceResult found = classic::distance({a, far_a}, {b, far_b});
    ASSERT_EQ(found.upper, truth.upper) << "case " << i;
  }
}

TEST(ClassicQueries, RoundingOfThePlacementNeverHidesAContact) {
  // A corner of a is the point b, so they touch wherever both are placed together; the spheres' gap is pure rounding
  // there.
  Rng rng(72);
  for (int i = 0; i < 500; ++i) {
    const Vec3 corner = uniform_point(rng), other = uniform_point(rng);
    const Model a(soup({{corner, other, other}})), b(soup({{corner, corner, corner}}));
    Transform pose = random_pose(rng, i % 2 == 0 ? 1e8 : 1);
    if (i % 3 == 0) pose.rotation.row1 += uniform_point(rng) * 1e-10;  // as orthonormal as is_rigid() asks for
    ASSERT_TRUE(classic::collide({a, pose}, {b, pose}).collision) << "case " << i;
    ASSERT_EQ(classic::distance({a, pose}, {b, pose}, {.relative_error = 0.1}).upper, 0) << "case " << i;
  }
}

TEST(ClassicQueries, ShareModelsBetweenThreads) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  const auto separation = [](std::size_t i) { return 0.25 + 0.5 * static_cast<double>(i % 4); };
  std::vector<double> found(8);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < found.size(); ++i) {
      threads.emplace_back([&, i] {
        const Transform pose = scenes::ball_over_square(ball.mesh(), separation(i), 0);
        found[i] = classic::distance({square}, {ball, pose}).upper;
      });
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], separation(i), 1e-13);
}

TEST(Reference, PicksTheFirstPairInTheOrderOfIds) {
  const Mesh a = soup({unit, unit}), b = soup({{{0, 0, 9}, {1, 0, 9}, {0, 1, 9}}, {{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}});
  const DistanceResult r = reference::distance({a}, {b});
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.witness.triangle_a, 0U);
  EXPECT_EQ(r.witness.triangle_b, 1U);
  EXPECT_EQ(r.stats.triangle_tests, 4U);
}

}  // namespace
}  // namespace limber::testing

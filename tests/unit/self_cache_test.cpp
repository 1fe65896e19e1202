// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Self-queries with a cache: what it saves, and caches that other queries have filled. Deforming models are in
// tests/property.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "limber/contacts.h"
#include "pair/query_cache_impl.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

/// A strip that is bent down in the middle, through itself if `rise` is negative.
Mesh bent_strip(double rise) {
  const Mesh flat = scenes::grid(40, 4, 0, 0, 0.1, 0.1);
  std::vector<Vec3> positions = flat.positions();
  for (Vec3& p : positions) {
    if (p.x > 2) p = {4 - p.x, p.y, rise + (p.x - 2) * 0.1};
  }
  return Mesh::create(std::move(positions), flat.triangles()).value();
}

TEST(SelfCache, FindsTheSameContactAtOnce) {
  Model model(bent_strip(-0.1));
  QueryCache cache;
  const CollideResult cold = self_collide(model, {.cache = &cache});
  ASSERT_TRUE(cold.is_yes());
  EXPECT_GT(cold.stats.node_tests, 5U);
  // The strip moves a little.
  std::vector<Vec3> positions = model.mesh().positions();
  for (Vec3& p : positions) p.z += 1e-4 * std::sin(9 * p.x);
  model.move_all(positions).value();
  model.commit();
  const CollideResult warm = self_collide(model, {.cache = &cache});
  ASSERT_TRUE(warm.is_yes());
  EXPECT_EQ(warm.stats.node_tests, 0U);
  EXPECT_EQ(warm.stats.triangle_tests, 1U);
  EXPECT_EQ(warm.witness->triangle_a, cold.witness->triangle_a);
  EXPECT_EQ(warm.witness->triangle_b, cold.witness->triangle_b);
  const DistanceResult distance = self_distance(model, {.cache = &cache});
  EXPECT_EQ(distance.upper, 0);
  EXPECT_EQ(distance.lower, 0);
  EXPECT_EQ(distance.status, Status::collision);
  EXPECT_EQ(distance.stats.node_tests, 0U);
}

TEST(SelfCache, KnowsTheClosestPair) {
  const Model above(bent_strip(0.05)), through(bent_strip(-0.1));
  for (const Model* const model : {&above, &through}) {
    QueryCache cache;
    const DistanceResult cold = self_distance(*model, {.cache = &cache}),
                         warm = self_distance(*model, {.cache = &cache});
    EXPECT_EQ(warm.upper, cold.upper);
    EXPECT_EQ(cache.impl().triangle_a, cold.witness.value().triangle_a);
    EXPECT_EQ(cache.impl().triangle_b, cold.witness->triangle_b);
    EXPECT_EQ(warm.witness.value().triangle_a, cold.witness->triangle_a);  // it comes first, so no tie replaces it
    EXPECT_EQ(warm.witness->triangle_b, cold.witness->triangle_b);
    EXPECT_LE(warm.stats.triangle_tests, cold.stats.triangle_tests + 1);  // it comes twice
    EXPECT_EQ(warm.stats.node_tests == 0, model == &through);
  }
}

TEST(SelfCache, SavesWorkWhileAClothCrumples) {
  const scenes::Motion motion = scenes::crumpling_cloth(24);
  Model model(motion.mesh);
  QueryCache of_distance, of_collision;
  std::uint64_t cold = 0, warm = 0, cold_collide = 0, warm_collide = 0;
  for (int frame = 150; frame < 200; ++frame) {
    model.move_all(motion.positions(frame)).value();
    model.commit();
    const DistanceResult fresh = self_distance(model), cached = self_distance(model, {.cache = &of_distance});
    ASSERT_EQ(fresh.upper, cached.upper);
    const CollideResult fresh_collision = self_collide(model),
                        collision = self_collide(model, {.cache = &of_collision});
    ASSERT_EQ(fresh_collision.is_yes(), collision.is_yes());
    cold += fresh.stats.node_tests + fresh.stats.triangle_tests;
    warm += cached.stats.node_tests + cached.stats.triangle_tests;
    cold_collide += fresh_collision.stats.node_tests;
    warm_collide += collision.stats.node_tests;
  }
  EXPECT_LE(warm, cold);
  EXPECT_LE(warm_collide, cold_collide);
}

TEST(SelfCache, OfOtherQueriesDoesNotMislead) {
  const Model strip(bent_strip(0.05)), through(bent_strip(-0.1)), one(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}));
  const DistanceResult fresh = self_distance(strip);
  ASSERT_GT(fresh.upper, 0);
  const TriangleId some_ids[] = {0, 1, 2, 77, 319, 320, 5000, no_id - 1, no_id};
  for (const TriangleId a : some_ids) {
    for (const TriangleId b : some_ids) {
      QueryCache cache;
      cache.impl().triangle_a = a, cache.impl().triangle_b = b;
      EXPECT_EQ(self_distance(strip, {.cache = &cache}).upper, fresh.upper) << a << ' ' << b;
      cache.impl().triangle_a = a, cache.impl().triangle_b = b;
      EXPECT_FALSE(self_collide(strip, {.cache = &cache}).is_yes()) << a << ' ' << b;
      EXPECT_TRUE(self_collide(through, {.cache = &cache}).is_yes()) << a << ' ' << b;
      EXPECT_EQ(self_distance(one, {.cache = &cache}).status, Status::beyond_limit) << a << ' ' << b;
    }
  }
  // In turn with queries of the model and itself, elsewhere: both go on from the same cache.
  QueryCache cache;
  for (int i = 0; i < 5; ++i) {
    const Placed here{strip}, there{strip, {{}, {0, 0, 0.5 + 0.01 * i}}};
    const double apart = distance(here, there).upper;
    EXPECT_NEAR(distance(here, there, {.cache = &cache}).upper, apart, 1e-14);
    EXPECT_EQ(self_distance(strip, {.cache = &cache}).upper, fresh.upper);
    EXPECT_TRUE(collide(here, {through, {{}, {0, 0, 0.05}}}, {.cache = &cache}).is_yes());
  }
}

TEST(SelfCache, ComparesNoPairThatTheFilterRefuses) {
  const Model model(bent_strip(-0.1));
  QueryCache cache;
  const CollideResult cold = self_collide(model, {.cache = &cache});
  ASSERT_TRUE(cold.is_yes());
  const auto refuses_all = [](TriangleId, TriangleId) { return false; };
  EXPECT_FALSE(self_collide(model, {.filter = refuses_all, .cache = &cache}).is_yes());
  EXPECT_EQ(self_distance(model, {.filter = refuses_all, .cache = &cache}).status, Status::beyond_limit);
  EXPECT_EQ(self_collide(model, {.cache = &cache}).stats.triangle_tests, 1U);  // the pair is still known
}

TEST(SelfDistance, IsTheLeastToTheBitWhereManyPairsTie) {
  Rng rng(77);
  for (int i = 0; i < 40; ++i) {
    // All squares of a turned sheet are equal up to rounding.
    const Mesh flat = scenes::grid(6, 5, 0, 0, 0.25, 0.25);
    const Transform pose = random_pose(rng, 3);
    std::vector<Vec3> positions = flat.positions();
    for (Vec3& p : positions) p = pose(p);
    const Model model(Mesh::create(positions, flat.triangles()).value());
    double least = std::numeric_limits<double>::infinity();
    const auto visit = [&](const Contact& c) {
      least = std::min(least, c.distance);
      return true;
    };
    visit_self_contacts(model, 10, visit);
    EXPECT_EQ(self_distance(model).upper, least) << i;
  }
}

}  // namespace
}  // namespace limber::testing

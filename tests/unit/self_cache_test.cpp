// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Self-queries with a cache: what it saves, and caches that other queries have filled. Deforming models are in
// tests/property.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "limber/contacts.h"
#include "pair/query_cache_impl.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

/// A strip that is bent down in the middle, through itself if `rise` is negative.
Mesh bent_strip(double rise) {
  return mapped(scenes::grid(40, 4, 0, 0, 0.1, 0.1), [rise](const Vec3& p) {
    return p.x > 2 ? Vec3{4 - p.x, p.y, rise + (p.x - 2) * 0.1} : p;
  });
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
}

}  // namespace
}  // namespace limber::testing

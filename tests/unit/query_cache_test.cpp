// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "base/access.h"
#include "bvh/subtree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/query_cache_impl.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/internals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

TEST(QueryCache, OfLargerModelsDoesNotMisleadQueriesOfSmallerOnes) {
  // The triangles of the last answer are the last ones of their meshes; the next meshes have no such triangles.
  const Model sheet(scenes::grid(40, 40, 0, 0, 1, 1)), ball(scenes::ball(60, 31));
  const Model one(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}})), other(soup({{{0, 0, 2}, {1, 0, 3}, {0, 1, 3}}}));
  const auto last = static_cast<TriangleId>(1500);
  for (const auto& [a, b] : std::vector<std::pair<const Model*, const Model*>>{
           {&one, &ball}, {&sheet, &other}, {&one, &other}, {&other, &one}}) {
    const DistanceResult fresh = distance({*a}, {*b});
    QueryCache cache;
    Access::impl(cache).triangle_a = last, Access::impl(cache).triangle_b = last;
    const DistanceResult cached = distance({*a}, {*b}, {.cache = &cache});
    EXPECT_EQ(cached.upper, fresh.upper);
    EXPECT_EQ(cached.stats.primitive_tests, fresh.stats.primitive_tests);
    Access::impl(cache).triangle_a = last, Access::impl(cache).triangle_b = last;
    EXPECT_EQ(collide({*a}, {*b}, {.cache = &cache}).is_yes(), fresh.upper == 0);
  }
}

/// The least distance of any triangles below two slots. Pre: all triangles of a leaf are equal.
double distance_below(const Model& a, bvh::SlotId slot_a, const Model& b, bvh::SlotId slot_b, const Transform& pose_b) {
  const bvh::Tree &tree_a = tree_of(a), &tree_b = tree_of(b);
  const bvh::Subtree below_a = bvh::subtree_of(tree_a, slot_a), below_b = bvh::subtree_of(tree_b, slot_b);
  double best = std::numeric_limits<double>::infinity();
  for (std::uint32_t i = below_a.first_leaf; i < below_a.end_leaf; ++i) {
    const Triangle s = a.mesh().triangle(tree_a.leaves[i].triangle[0]);
    for (std::uint32_t j = below_b.first_leaf; j < below_b.end_leaf; ++j) {
      const Triangle t = b.mesh().triangle(tree_b.leaves[j].triangle[0]);
      best = std::min(best, closest_points(s, {pose_b(t.v0), pose_b(t.v1), pose_b(t.v2)}).distance);
    }
  }
  return best;
}

TEST(QueryCache, RecordsOnlyDistancesThatWhatIsNotExpandedIsApart) {
  Rng rng(310);
  int tight = 0;
  for (int i = 0; i < 50; ++i) {
    // Specks far apart, so that bounds are nearly as large as distances.
    const auto specks = [&] {
      std::vector<Triangle> triangles;
      for (int k = 0; k < 100; ++k) {
        const Vec3 p = uniform_point(rng);
        triangles.insert(triangles.end(), bvh::width, {p, p + 1e-6 * uniform_point(rng), p});
      }
      return soup(triangles);
    };
    const Model a(specks()), b(specks());
    const Transform pose = random_pose(rng, 3);
    QueryCache cache;
    QueryBudget budget;
    if (i % 2 == 1) budget.max_steps = rng.below(100);  // then some records have open pairs
    const double found = distance({a}, {b, pose}, {.cache = &cache, .budget = budget}).upper;
    const pair::Front& front = Access::impl(cache).front;
    for (const pair::Front::Record& record : front.records()) {
      const bvh::SlotId expanded = record.slot[record.expands_a ? 0 : 1];
      const bvh::Tree& tree = tree_of(record.expands_a ? a : b);
      const std::uint32_t node = tree.nodes[bvh::node_of(expanded)].first_child + bvh::slot_of(expanded);
      double least = std::numeric_limits<double>::infinity();
      for (unsigned rest = record.children[0] | record.children[1]; rest != 0; rest &= rest - 1) {
        const bvh::SlotId child = node * bvh::width + static_cast<std::uint32_t>(std::countr_zero(rest));
        least = std::min(least, record.expands_a ? distance_below(a, child, b, record.slot[1], pose)
                                                 : distance_below(a, record.slot[0], b, child, pose));
      }
      const double bound = front.bound_of(record);
      ASSERT_LE(bound, least * (1 + 1e-14)) << i;
      tight += bound > found && bound > 0.9999 * least && least < 1e300 ? 1 : 0;
    }
  }
  EXPECT_GT(tight, 100);
}

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
  EXPECT_EQ(warm.stats.primitive_tests, 1U);
  EXPECT_EQ(warm.witness->triangle_a, cold.witness->triangle_a);
  EXPECT_EQ(warm.witness->triangle_b, cold.witness->triangle_b);
  const DistanceResult distance = self_distance(model, {.cache = &cache});
  EXPECT_EQ(distance.upper, 0);
  EXPECT_EQ(distance.lower, 0);
  EXPECT_EQ(distance.status, DistanceStatus::collision);
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
      Access::impl(cache).triangle_a = a, Access::impl(cache).triangle_b = b;
      EXPECT_EQ(self_distance(strip, {.cache = &cache}).upper, fresh.upper) << a << ' ' << b;
      Access::impl(cache).triangle_a = a, Access::impl(cache).triangle_b = b;
      EXPECT_FALSE(self_collide(strip, {.cache = &cache}).is_yes()) << a << ' ' << b;
      EXPECT_TRUE(self_collide(through, {.cache = &cache}).is_yes()) << a << ' ' << b;
      EXPECT_EQ(self_distance(one, {.cache = &cache}).status, DistanceStatus::beyond_limit) << a << ' ' << b;
    }
  }
}

}  // namespace
}  // namespace limber::testing

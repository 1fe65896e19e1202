// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>
#include <vector>

#include "bvh/subtree.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/query_cache_impl.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

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
    cache.impl().triangle_a = last, cache.impl().triangle_b = last;
    const DistanceResult cached = distance({*a}, {*b}, {.cache = &cache});
    EXPECT_EQ(cached.upper, fresh.upper);
    EXPECT_EQ(cached.stats.triangle_tests, fresh.stats.triangle_tests);
    cache.impl().triangle_a = last, cache.impl().triangle_b = last;
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
    const pair::Front& front = cache.impl().front;
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

}  // namespace
}  // namespace limber::testing

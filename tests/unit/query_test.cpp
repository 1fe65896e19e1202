// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Promises of every engine about its queries, and what caches keep of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <future>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "base/access.h"
#include "bvh/tree.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/query_cache_impl.h"
#include "scenes/scenes.h"
#include "support/brute_force.h"
#include "support/engines.h"
#include "support/random_geometry.h"
#include "unit/internals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

const Triangle unit_triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

template <typename Engine>
class Query : public ::testing::Test, public Asking<Engine> {};

TYPED_TEST_SUITE(Query, Engines, EngineNames);

TYPED_TEST(Query, TakesTrianglesAsSurfacesNotSolids) {
  const typename TestFixture::Model shell(scenes::ball(32, 17));
  const typename TestFixture::Model kernel(scaled(scenes::ball(16, 9), 0.25));
  EXPECT_FALSE(this->collide(shell, kernel).is_yes());
  EXPECT_GT(this->distance(shell, kernel).upper, 0.7);
}

TYPED_TEST(Query, TouchingIsCollidingAtEverySetting) {
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{1, 0, 0}, {3, 0, 1}, {3, 1, 1}}}));
  const CollideResult hit = this->collide(a, b);
  ASSERT_TRUE(hit.is_yes());
  EXPECT_EQ(hit.witness->point_a, (Vec3{1, 0, 0}));
  EXPECT_TRUE(this->within(a, b, 0).is_yes());
  for (const DistanceOptions& options : std::vector<DistanceOptions>{{},
                                                                     {.relative_error = 0.5},
                                                                     {.relative_error = 1e308},
                                                                     {.absolute_error = 100},
                                                                     {.absolute_error = 1e300},
                                                                     {.max_distance = 0},
                                                                     {.max_distance = 1}}) {
    const DistanceResult r = this->distance(a, b, {}, options);
    EXPECT_EQ(r.status, DistanceStatus::collision);
    EXPECT_EQ(r.lower, 0);
    EXPECT_EQ(r.upper, 0);
    EXPECT_EQ(r.witness->point_a, (Vec3{1, 0, 0}));
    EXPECT_EQ(r.witness->point_b, (Vec3{1, 0, 0}));
  }
}

TYPED_TEST(Query, FindsAContactBehindANearMiss) {
  // The first pair compared is 1e-20 apart. Divided by 1 + the relative error, or less the absolute error, that leaves
  // no cutoff. The contact must not be pruned all the same.
  const Triangle near{{1, 1, 1e-20}, {1, 1, 3}, {1, 1.5, 3}}, touching{{4, 1, 0}, {4, 1, 3}, {4, 1.5, 3}};
  const typename TestFixture::Model a(soup({near, touching})), b(soup({{{0, 0, 0}, {20, 0, 0}, {0, 20, 0}}}));
  EXPECT_EQ(this->distance(a, b, {}, {.relative_error = 1e308}).status, DistanceStatus::collision);
  EXPECT_EQ(this->distance(a, b, {}, {.absolute_error = 1}).status, DistanceStatus::collision);
}

TYPED_TEST(Query, TellsTheSmallestGapFromAContact) {
  const double gap = std::numeric_limits<double>::denorm_min();
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{0.2, 0.2, gap}, {3, 0, 1}, {3, 1, 1}}}));
  EXPECT_FALSE(this->collide(a, b).is_yes());
  EXPECT_GT(this->distance(a, b).upper, 0);
  EXPECT_FALSE(this->within(a, b, 0).is_yes());
}

TYPED_TEST(Query, OfSingleTrianglesIsThatOfThePrimitiveAndItsLimitIsClosed) {
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  const DistanceResult r = this->distance(a, b);
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.lower, 2);
  EXPECT_EQ(r.status, DistanceStatus::exact);
  EXPECT_TRUE(r.witness->triangle_a == 0 && r.witness->triangle_b == 0);
  EXPECT_EQ(r.stats.primitive_tests, 1U);
  const double below = std::nextafter(2.0, 0.0);
  EXPECT_TRUE(this->within(a, b, 2).is_yes());
  EXPECT_FALSE(this->within(a, b, below).is_yes());
  EXPECT_FALSE(this->within(a, b, below).witness.has_value());
  EXPECT_EQ(this->distance(a, b, {}, {.max_distance = 2}).status, DistanceStatus::exact);
  const DistanceResult beyond = this->distance(a, b, {}, {.max_distance = below});
  EXPECT_EQ(beyond.status, DistanceStatus::beyond_limit);
  EXPECT_EQ(beyond.lower, below);
  EXPECT_EQ(beyond.upper, std::numeric_limits<double>::infinity());
  EXPECT_FALSE(beyond.witness.has_value());
}

TYPED_TEST(Query, AnErrorDoesNotHideWhatIsWithinTheLimit) {
  // The first pair found may be beyond the limit but within the error of the closest pair, which is within the limit.
  const Triangle farther{{0, 0, 1.05}, {1, 0, 1.05}, {0, 1, 1.05}}, closer{{5, 0, 1}, {6, 0, 1}, {5, 1, 1}};
  for (const auto& triangles : {std::vector{farther, closer}, std::vector{closer, farther}}) {
    const typename TestFixture::Model a(scenes::grid(8, 8, -1, -1, 1, 1)), b(soup(triangles));
    const DistanceResult r = this->distance(a, b, {}, {.relative_error = 0.1, .max_distance = 1.01});
    EXPECT_EQ(r.upper, 1);
    EXPECT_EQ(this->distance(a, b, {}, {.absolute_error = 0.1, .max_distance = 1.01}).upper, 1);
  }
}

TEST(Queries, FindTheClosestOfManyNearlyClosestPairs) {
  const Mesh ring = scenes::ring(60, 60, 0.1);  // surfaces alongside each other over a long way
  const limber::Model model(ring);
  for (const std::uint32_t index : {0U, 8U}) {
    const Transform pose = scenes::linked_ring(index);
    const double truth = brute_force_distance({ring}, {ring, pose});
    const DistanceResult exact = limber::distance({model}, {model, pose});
    EXPECT_NEAR(exact.upper, truth, 1e-14);
    const DistanceResult close = limber::distance({model}, {model, pose}, {.relative_error = 0.01});
    EXPECT_LE(close.lower, truth);
    EXPECT_GE(close.upper, truth);
    EXPECT_LE(close.upper, 1.01 * truth);
    // So long that the order of children changes on the way.
    EXPECT_GT(exact.stats.node_tests, 10'000U) << index;
  }
}

// All slabs of a flat disk have thickness 0, but where the search direction runs along it, its nodes reach farther.
TEST(Queries, TakeApartAFlatDiskThatStandsOverAFloor) {
  const Mesh floor = scenes::grid(64, 64, -1, -1, 1.0 / 32, 1.0 / 32);
  std::vector<Corners> disk;
  for (TriangleId t = 0; t < floor.triangles().size(); ++t) {
    if (length(floor.triangle(t).v0) < 1) disk.push_back(floor.triangles()[t]);
  }
  const Model a(Mesh::create(floor.positions(), disk).value()), b(floor);
  Rng rng(0x5EED0055);
  std::uint64_t node_tests = 0, swapped = 0;
  for (int i = 0; i < 8; ++i) {
    const Transform over{random_rotation(rng), {0, 0, 8}};
    node_tests += distance({a, over}, {b}).stats.node_tests;
    swapped += distance({b}, {a, over}).stats.node_tests;
  }
  EXPECT_LE(node_tests, 3000U);  // 15 083 where the thickness of slabs decides alone
  EXPECT_LE(swapped, 3000U);
}

TEST(Queries, OfTwoTrianglesAreExactWhateverErrorIsAllowed) {
  const Model model(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}).value());
  const Placed a{model}, b{model, {{}, {0.25, 0.25, 3}}};
  QueryCache cache;
  for (const double error : {0.0, 0.1, 2.0}) {
    for (QueryCache* const used : {static_cast<QueryCache*>(nullptr), &cache}) {
      const DistanceResult found = distance(a, b, {.relative_error = error, .cache = used, .budget = {.max_steps = 1}});
      EXPECT_EQ(found.lower, 3);
      EXPECT_EQ(found.upper, 3);
      EXPECT_EQ(found.status, DistanceStatus::exact);
    }
  }
  const DistanceResult beyond = distance(a, b, {.relative_error = 1, .max_distance = 2.5});
  EXPECT_EQ(beyond.status, DistanceStatus::beyond_limit);
  EXPECT_EQ(beyond.lower, 2.5);
}

TEST(Queries, WithinAFarLimitGiveOnePointWhereModelsMeet) {
  const Model touched(scenes::grid(1, 1, 0, 0, 1, 1)), vertex(soup({{{0.5, 0.5, 0}, {0, 0, 1}, {1, 0, 1}}}));
  const CollideResult near = within({touched}, {vertex}, 100);
  ASSERT_TRUE(near.is_yes());
  EXPECT_EQ(near.witness->point_a, near.witness->point_b);
}

TYPED_TEST(Query, RoundingOfThePlacementNeverHidesAContact) {
  // A corner of a is the point b, so the models touch at every pose that they share. Any gap of the bounds is rounding.
  Rng rng(72);
  for (int i = 0; i < 500; ++i) {
    const Vec3 corner = uniform_point(rng), other = uniform_point(rng);
    const typename TestFixture::Model a(soup({{corner, other, other}})), b(soup({{corner, corner, corner}}));
    Transform pose = random_pose(rng, i % 2 == 0 ? 1e8 : 1);
    if (i % 3 == 0) pose.rotation.row1 += uniform_point(rng) * 1e-10;  // as orthonormal as is_rigid() asks for
    ASSERT_TRUE(this->collide(a, b, pose, pose).is_yes()) << "case " << i;
    ASSERT_EQ(this->distance(a, b, pose, {.relative_error = 0.1}, pose).upper, 0) << "case " << i;
  }
}

TYPED_TEST(Query, SharesModelsBetweenThreads) {
  const typename TestFixture::Model square(scenes::grid(16, 16, -4, -4, 0.5, 0.5)), ball(scenes::ball(16, 9));
  const auto separation = [](std::size_t i) { return 0.25 + 0.5 * static_cast<double>(i % 4); };
  std::vector<double> found(8);
  {
    std::vector<std::future<void>> threads;
    for (std::size_t i = 0; i < found.size(); ++i) {
      threads.push_back(std::async(std::launch::async, [&, i] {
        const Transform pose = scenes::ball_over_square(ball.mesh(), separation(i), 0);
        for (int repeat = 0; repeat < 5; ++repeat) found[i] = this->distance(square, ball, pose).upper;
        if (this->collide(square, ball, pose).is_yes()) found[i] = -1;
      }));
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], separation(i), 1e-13);
}

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
      best = std::min(best, closest_points(s, mapped(t, pose_b)).distance);
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
    QueryBudget budget{.max_steps = 1'000'000};         // with any budget, the first query records
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Self-queries with a cache, while models deform, are rebuilt and replaced: the same bits as without one, and as brute
// force finds.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "limber/contacts.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// A regular sheet somewhere in space: a great many pairs are equally close up to rounding.
Mesh regular(Rng& rng) {
  const Mesh flat = scenes::grid(some(rng, 2, 8), some(rng, 2, 8), 0, 0, 0.125, 0.125);
  const Transform pose = random_pose(rng, 5);
  const double bend = rng.below(2) == 0 ? 0 : rng.uniform(0.5, 6);
  return mapped(flat, [&](const Vec3& p) {
    return pose(bend > 0 ? Vec3{std::cos(bend * p.x), p.y, std::sin(bend * p.x)} : p);
  });
}

Mesh any_mesh(Rng& rng) { return rng.below(3) == 0 ? regular(rng) : crumpled(rng); }

/// The least distance of the pairs that count.
double min_distance(const std::vector<Contact>& pairs, const TrianglePairFilter& filter) {
  double least = std::numeric_limits<double>::infinity();
  for (const Contact& c : pairs) {
    if (filter(c.triangle_a, c.triangle_b)) least = std::min(least, c.distance);
  }
  return least;
}

void expect_attains(const Model& model, const DistanceResult& result) {
  ASSERT_TRUE(result.witness.has_value());
  ASSERT_LT(result.witness->triangle_a, result.witness->triangle_b);
  const Mesh& mesh = model.mesh();
  const double distance =
      closest_points(mesh.triangle(result.witness->triangle_a), mesh.triangle(result.witness->triangle_b)).distance;
  ASSERT_EQ(distance, result.upper);
}

struct Counts {
  std::size_t asked = 0, colliding = 0, beyond = 0;
};

/// Every self-query with a cache against the same without, and against brute force.
void check_cached(const Model& model, Rng& rng, QueryCache& cache, Counts& counts) {
  const std::uint64_t salt = rng.below(1000), refused = rng.below(3);
  const auto filter = [&](TriangleId a, TriangleId b) { return (a * 31 + b * 17 + salt) % 4 >= refused; };
  const SelfQueryOptions options{.filter = filter}, with_cache{.filter = filter, .cache = &cache};
  const std::vector<Contact> pairs = reference::self_contacts(model.mesh(), std::numeric_limits<double>::max());
  const double least = min_distance(pairs, filter), rounding = 1e-14 * extent_of(model.mesh());

  const DistanceResult exact = self_distance(model, {.filter = filter, .cache = &cache});
  ASSERT_EQ(exact.upper, least);
  ASSERT_EQ(self_distance(model, {.filter = filter}).upper, least);
  ASSERT_EQ(exact.status, std::isinf(least) ? DistanceStatus::beyond_limit
                          : least == 0      ? DistanceStatus::collision
                                            : DistanceStatus::exact);
  if (!std::isinf(least)) {
    ASSERT_EQ(exact.lower, least);
    expect_attains(model, exact);
  }

  const CollideResult collision = self_collide(model, with_cache);
  ASSERT_EQ(collision.is_yes(), least == 0);
  ASSERT_EQ(self_collide(model, options).is_yes(), least == 0);
  if (collision.is_yes()) {
    const TriangleId a = collision.witness->triangle_a, b = collision.witness->triangle_b;
    ASSERT_TRUE(filter(a, b));
    ASSERT_TRUE(std::any_of(pairs.begin(), pairs.end(), [&](const Contact& c) {
      return c.triangle_a == a && c.triangle_b == b && c.distance == 0;
    }));
  }

  // A limit just at the distance decides to the bit, too.
  const double limit = std::isinf(least) || rng.below(2) == 0 ? rng.uniform(0, 2) : std::nextafter(least, 0);
  for (const double max_distance : {limit, std::isinf(least) ? 1 : least}) {
    const DistanceResult limited =
        self_distance(model, {.max_distance = max_distance, .filter = filter, .cache = &cache});
    ASSERT_EQ(limited.status == DistanceStatus::beyond_limit, least > max_distance);
    if (least <= max_distance) {
      ASSERT_EQ(limited.upper, least);
    }
    counts.beyond += least > max_distance ? 1 : 0;
  }

  const double error = rng.uniform(0, 0.5);
  for (QueryCache* const used : {static_cast<QueryCache*>(nullptr), &cache}) {
    const DistanceResult near = self_distance(model, {.relative_error = error, .filter = filter, .cache = used});
    if (std::isinf(least)) continue;
    ASSERT_LE(near.lower, least + rounding);
    ASSERT_LE(near.upper, least * (1 + error) + rounding);
    expect_attains(model, near);
  }
  ++counts.asked, counts.colliding += least == 0 ? 1 : 0;
}

/// Queries of two models with the same cache.
void check_two_models(const Model& a, const Model& b, Rng& rng, QueryCache& cache) {
  const Placed first{a}, second{b, random_pose(rng, 2)};
  const DistanceResult fresh = distance(first, second), cached = distance(first, second, {.cache = &cache});
  const double rounding = 1e-13 * (2 + extent_of(a.mesh()) + extent_of(b.mesh()));
  ASSERT_NEAR(cached.upper, fresh.upper, rounding);
  ASSERT_EQ(collide(first, second, {.cache = &cache}).is_yes(), fresh.upper == 0);
}

void deform_some(Model& model, Rng& rng) {
  const double length = extent_of(model.mesh()) * std::pow(10.0, rng.uniform(-6, -0.5));
  const std::uint64_t every = 1 + rng.below(3);
  deform(model, [&](const Vec3& p) { return rng.below(every) == 0 ? p + length * uniform_point(rng) : p; });
}

TEST(SelfCacheProperty, ChangesNoAnswerWhileModelsDeformAndAreReplaced) {
  Rng rng(1601);
  Counts counts;
  QueryCache cache;  // kept from one model to the next
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const RebuildPolicy policy = rng.below(2) == 0 ? RebuildPolicy::off : RebuildPolicy::in_commit;
    const double margin = rng.below(2) == 0 ? 0.05 : 0.002;
    Model model(any_mesh(rng), {.motion_margin = margin, .rebuild_policy = policy});
    const Model other(any_mesh(rng));
    simd::use_kernels(rng.below(3) == 0 ? &simd::scalar_kernels : nullptr);
    for (int step = 0; step < 8; ++step) {
      if (step > 0) deform_some(model, rng);
      if (step == 3) model.rebuild();
      if (step == 6) model.reset(any_mesh(rng));
      check_cached(model, rng, cache, counts);
      if (rng.below(3) == 0) check_two_models(model, other, rng, cache);
      if (rng.below(3) == 0) check_two_models(model, model, rng, cache);
      if (rng.below(4) == 0) check_cached(other, rng, cache, counts);
      if (::testing::Test::HasFailure()) break;
    }
    simd::use_kernels(nullptr);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(counts.colliding, counts.asked / 20);
  EXPECT_LT(counts.colliding, 4 * counts.asked / 5);
  EXPECT_GT(counts.beyond, counts.asked / 20);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models of sizes down to the smallest numbers: caches, limits and budgets do not change what is answered.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "limber/distance.h"
#include "limber/model.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

struct TinyScene {
  Model a, b;
  Transform pose_b;
  double size;
};

/// Two soups at 2^-1074 to 2^-300, a few of their own sizes apart or in each other.
TinyScene tiny_scene(Rng& rng) {
  const double size = std::ldexp(1.0, -300 - static_cast<int>(rng.below(760)));
  const auto mesh = [&] {
    std::vector<Triangle> triangles;
    for (std::size_t i = 0, count = 1 + rng.below(20); i < count; ++i) {
      triangles.push_back(arbitrary_triangle(rng, rng.below(6)));
    }
    return moved(soup(triangles), {}, size);
  };
  Mesh a = mesh(), b = mesh();
  Transform pose;
  if (rng.below(2) == 0) pose.translation = size * uniform_point(rng, -8, 8);
  return {Model(a), Model(b), pose, 16 * size};
}

TEST(TinyScenes, AreAnsweredWithACacheAsWithout) {
  Rng rng(1601);
  for (int i = 0; i < 3000; ++i) {
    SCOPED_TRACE(i);
    const TinyScene s = tiny_scene(rng);
    const Placed a{s.a}, b{s.b, s.pose_b};
    const double truth = distance(a, b).upper, tolerance = std::max(1e-13 * s.size, 0x1p-1060);
    QueryCache cache;
    for (int k = 0; k < 6; ++k) {
      const double limit = truth * rng.uniform(0.5, 1.5);
      switch (rng.below(5)) {
        case 0:
          ASSERT_EQ(collide(a, b, {.cache = &cache}).is_yes(), truth == 0);
          break;
        case 1:
          if (std::abs(limit - truth) > tolerance) {
            ASSERT_EQ(within(a, b, limit, {.cache = &cache}).is_yes(), truth <= limit);
          }
          break;
        case 2: {
          const DistanceResult found = distance(a, b, {.cache = &cache, .budget = {.max_steps = rng.below(20)}});
          ASSERT_LE(found.lower, truth + tolerance);
          ASSERT_GE(found.upper, truth - tolerance);
          break;
        }
        default:
          ASSERT_NEAR(distance(a, b, {.cache = &cache}).upper, truth, tolerance);
      }
    }
  }
}

TEST(TinyScenes, AndLargeOnesHaveAPairWithinWhatADistanceWithAnErrorHasFound) {
  Rng rng(1602);
  for (int i = 0; i < 20000; ++i) {
    SCOPED_TRACE(i);
    const bool is_tiny = i % 2 == 0;
    const double size = std::ldexp(1.0, is_tiny ? -480 - static_cast<int>(rng.below(300)) : 0);
    // Triangles whose closest points are often corners, so that rounding alone decides.
    const auto model = [&](const Vec3& at) {
      const Vec3 p = at + uniform_point(rng);
      return Model(moved(soup({{p, p + 0.1 * uniform_point(rng), p + 0.1 * uniform_point(rng)}}), {}, size));
    };
    const Model model_a = model({}), model_b = model(uniform_point(rng, -3, 3));
    const Placed a{model_a}, b{model_b, {{}, size * uniform_point(rng)}};
    const double upper = distance(a, b, {.relative_error = rng.uniform(0, 0.9)}).upper;
    ASSERT_NE(distance(a, b, {.max_distance = upper}).status, Status::beyond_limit);
    ASSERT_TRUE(within(a, b, upper).is_yes());
    ASSERT_LE(distance(a, b).upper, upper);
  }
}

}  // namespace
}  // namespace limber::testing

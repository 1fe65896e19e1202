// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "geometry/primitives.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

using geometry::contains;
using geometry::enclosing_sphere;

TEST(EnclosingSphere, OfTrianglesHasKnownValues) {
  const Vec3 p{3, -4, 5};
  const struct {
    Triangle triangle;
    Vec3 center;
    double radius;
  } cases[] = {
      {{{0, 0, 0}, {6, 0, 0}, {0, 8, 0}}, {3, 4, 0}, 5},  // a right angle: at the middle of the longest edge
      {{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, Vec3{1, 1, 1} * (1.0 / 3), std::sqrt(2.0 / 3)},  // equilateral
      {{p, p, p}, p, 0},
      {{{0, 0, 0}, {1, 0, 0}, {-1e-170, 1e-170, 0}}, {0.5, 0, 0}, 0.5},  // a needle with a vanishing side
  };
  for (const auto& [triangle, center, radius] : cases) {
    const Sphere s = enclosing_sphere(triangle);
    EXPECT_LE(length(s.center - center), radius * 1e-15) << radius;
    EXPECT_NEAR(s.radius, radius, radius * 1e-14);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_TRUE(exactly_inside(s, triangle[k])) << radius;
  }
}

TEST(EnclosingSphere, ContainsTheCornersExactlyAndIsAlmostSmallest) {
  Rng rng(30);
  for (int i = 0; i < 3500; ++i) {
    const auto kind = static_cast<PairKind>(i % static_cast<int>(PairKind::count));
    const Triangle t = random_pair(rng, kind).first;
    for (const double scale : {1.0, 0x1p-180, 0x1p-400, 0x1p150}) {
      const Triangle scaled{t.v0 * scale, t.v1 * scale, t.v2 * scale};
      const Sphere s = enclosing_sphere(scaled);
      for (std::size_t k = 0; k < 3; ++k) ASSERT_TRUE(exactly_inside(s, scaled[k])) << "case " << i;
      ASSERT_TRUE(contains(s, scaled));
    }
    // The smallest sphere is never above longest edge / sqrt 3.
    const double longest = std::max({length(t.v1 - t.v0), length(t.v2 - t.v1), length(t.v0 - t.v2)});
    const double rounding = 0x1p-51 * std::max({max_abs(t.v0), max_abs(t.v1), max_abs(t.v2)});
    ASSERT_LE(enclosing_sphere(t).radius, longest * (1 / std::sqrt(3.0) + 1e-9) + rounding) << "case " << i;
  }
}

TEST(EnclosingSphere, OfTwoSpheresContainsBothExactly) {
  Rng rng(31);
  for (int i = 0; i < 3000; ++i) {
    const Sphere a{uniform_point(rng), rng.uniform() * (i % 3)}, b{uniform_point(rng) * rng.uniform(), rng.uniform()};
    const Sphere s = enclosing_sphere(a, b);
    for (const Sphere& inner : {a, b}) {
      ASSERT_TRUE(contains(s, inner));
      const RationalVec d = minus(rational(inner.center), rational(s.center));
      const Rational room = Rational(s.radius) - Rational(inner.radius);
      ASSERT_TRUE(room >= 0 && dot(d, d) <= room * room) << "case " << i;
    }
    const double needed = std::max({a.radius, b.radius, (length(a.center - b.center) + a.radius + b.radius) / 2});
    ASSERT_NEAR(s.radius, needed, 1e-14);
  }
}

TEST(EnclosingSphere, OfNestedAndEqualSpheresIsTheLarger) {
  const Sphere large{{0, 0, 0}, 5}, small{{1, 0, 0}, 1}, touching{{3, 0, 0}, 2};
  EXPECT_EQ(enclosing_sphere(large, small).center, large.center);
  EXPECT_EQ(enclosing_sphere(small, large).radius, 5);
  EXPECT_NEAR(enclosing_sphere(large, touching).radius, 5, 1e-14);
  EXPECT_EQ(enclosing_sphere(large, large).radius, 5);
  const Sphere point{{1, 2, 3}, 0};
  EXPECT_EQ(enclosing_sphere(point, point).radius, 0);
}

TEST(Contains, SaysNoWhenInDoubt) {
  EXPECT_TRUE(contains(Sphere{{0, 0, 0}, 2}, Sphere{{0, 0, 0}, 2}));
  EXPECT_FALSE(contains(Sphere{{0, 0, 0}, 2}, Sphere{{1, 0, 0}, 1}));  // equality through a rounded sum
  EXPECT_FALSE(contains(Sphere{{0, 0, 0}, 1}, Triangle{{2, 0, 0}, {0, 0, 0}, {0, 0, 0}}));
}

}  // namespace
}  // namespace limber::testing

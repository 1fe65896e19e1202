// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "geometry/plane_sides.h"
#include "limber/geometry.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

int rational_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const RationalVec o = rational(a);
  return sgn(determinant(minus(rational(b), o), minus(rational(c), o), minus(rational(d), o)));
}

int rational_area_sign(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const RationalVec p = minus(rational(b), rational(a)), q = minus(rational(c), rational(a));
  return sgn(p[i] * q[j] - p[j] * q[i]);
}

TEST(Orientation, IsPositiveOnTheSideTheNormalPointsTo) {
  const Vec3 a{0, 0, 0}, b{1, 0, 0}, c{0, 1, 0};
  EXPECT_EQ(orient3d(a, b, c, {0, 0, 1}), 1);
  EXPECT_EQ(orient3d(a, b, c, {0, 0, -1}), -1);
  EXPECT_EQ(orient3d(a, b, c, {5, 7, 0}), 0);
  EXPECT_EQ(orient2d(a, b, c, 2), 1);
  EXPECT_EQ(orient2d(a, c, b, 2), -1);
  EXPECT_EQ(orient2d(a, b, c, 0), 0);
}

using FourPoints = std::array<Vec3, 4>;

/// Any of the numbers that a function makes, as the coordinates of four points.
template <typename Coordinate>
FourPoints points_of(const Coordinate& coordinate) {
  FourPoints points;
  for (Vec3& p : points) p.x = coordinate(), p.y = coordinate(), p.z = coordinate();
  return points;
}

/// Four points of one kind; see the switch.
FourPoints points_of_kind(Rng& rng, int kind) {
  const auto power = [&](std::uint64_t below, int shift) { return static_cast<int>(rng.below(below)) + shift; };
  switch (kind) {
    case 0: {  // a plane through irregular points, and a point moved off it by single units in the last place
      const Triangle t = uniform_triangle(rng);
      return {t.v0, t.v1, t.v2, nudged(rng, point_on(t, rng.uniform(), rng.uniform()), 1)};
    }
    case 1: {  // a lattice of any scale
      const double scale = std::ldexp(1.0, power(2071, -1070));
      return points_of([&] { return scale * static_cast<double>(rng.below(6)); });
    }
    case 2:  // mixed magnitudes
      return points_of([&] { return std::ldexp(rng.uniform(-1, 1), power(1900, -1000)); });
    case 3: {  // the smallest and the largest numbers at once
      FourPoints points = points_of([&] {
        const double sign = rng.below(2) == 0 ? 1 : -1;
        if (rng.below(3) == 0) return 0.0;
        return sign * (rng.below(2) == 0 ? std::ldexp(rng.uniform(0.5, 1), 1024 - power(3, 0))
                                         : std::ldexp(1.0, power(4, -1074)));
      });
      if (rng.below(2) == 0) points[0] = {};
      return points;
    }
    default: {
      const auto [s, t] =
          random_pair(rng, static_cast<PairKind>(rng.below(static_cast<std::uint64_t>(PairKind::count))));
      return {s.v0, s.v1, s.v2, t.v0};
    }
  }
}

TEST(Orientation, AgreesWithRationalsAndChangesSignWithEverySwap) {
  Rng rng(1);
  for (int i = 0; i < 8000; ++i) {
    const auto [a, b, c, d] = points_of_kind(rng, i % 6);
    const int sign = orient3d(a, b, c, d);
    ASSERT_EQ(sign, rational_volume_sign(a, b, c, d)) << "case " << i;
    ASSERT_EQ(orient3d(b, a, c, d), -sign) << "case " << i;
    ASSERT_EQ(orient3d(a, b, d, c), -sign) << "case " << i;
    ASSERT_EQ(orient3d(d, b, c, a), -sign) << "case " << i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(orient2d(a, b, d, axis), rational_area_sign(a, b, d, axis)) << "case " << i;
    }
  }
}

TEST(Orientation, IsExactFromTheSmallestToTheLargestNumberAtOnce) {
  const double small = 0x1p-1074, large = 0x1p1023;
  EXPECT_EQ(orient3d({}, {large, small, 0}, {0, large, 0}, {0, 0, large}), 1);
  EXPECT_EQ(orient3d({}, {large, small, 0}, {0, 0, large}, {0, large, 0}), -1);
}

TEST(Orientation, IsExactWhereAProductUnderflowsInTheFilter) {
  // 1.49 of the smallest double rounds to 1, which turns 1.49 - 1.2 > 0 into 1 - 1.2 < 0.
  const Vec3 origin{0, 0, 0}, p{0, 0, 0x1p-537}, q{1.49 * 0x1p-537, 0x1p-537, 0}, r{1.2 * 0x1p200, 0x1p200, 0};
  EXPECT_EQ(orient3d(origin, p, q, r), 1);
}

TEST(Orientation, IsExactWhereOneCoordinateIsFarLargerThanAllOthers) {
  // The volume is the cube of a small number, which is below the range of float64 when the large one is about 1.
  for (int exponent = 250; exponent <= 1000; exponent += 10) {
    const double small = std::ldexp(1.0, -exponent);
    const Vec3 origin{}, p{small, 0, 0}, q{0, small, 0};
    EXPECT_EQ(orient3d(origin, p, q, {1, 0, small}), 1) << exponent;
    EXPECT_EQ(orient3d(origin, p, q, {1, 0, -small}), -1) << exponent;
    EXPECT_EQ(orient3d(origin, p, q, {1, 1, 0}), 0) << exponent;
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "geometry/exact_sign.h"
#include "support/random_geometry.h"
#include "support/rational_distance.h"

namespace limber::testing {
namespace {

int rational_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const RationalVec p = minus(rational(b), rational(a)), q = minus(rational(c), rational(a)),
                    r = minus(rational(d), rational(a));
  const Rational det =
      r[0] * (p[1] * q[2] - p[2] * q[1]) + r[1] * (p[2] * q[0] - p[0] * q[2]) + r[2] * (p[0] * q[1] - p[1] * q[0]);
  return sgn(det);
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

TEST(Orientation, AgreesWithRationalsOnEveryKindOfPair) {
  Rng rng(1);
  for (int i = 0; i < 4000; ++i) {
    const auto kind = static_cast<PairKind>(i % static_cast<int>(PairKind::count));
    const auto [s, t] = random_pair(rng, kind);
    ASSERT_EQ(orient3d(s.v0, s.v1, s.v2, t.v0), rational_volume_sign(s.v0, s.v1, s.v2, t.v0)) << "case " << i;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      ASSERT_EQ(orient2d(s.v0, s.v1, t.v0, axis), rational_area_sign(s.v0, s.v1, t.v0, axis)) << "case " << i;
    }
  }
}

TEST(Orientation, IsExactWhereTheLastBitDecides) {
  // A point moved off a plane through irregular points by single units in the last place.
  Rng rng(2);
  for (int i = 0; i < 2000; ++i) {
    const Triangle t = uniform_triangle(rng);
    const Vec3 p = nudged(rng, point_on(t, rng.uniform(), rng.uniform()), 1);
    ASSERT_EQ(orient3d(t.v0, t.v1, t.v2, p), rational_volume_sign(t.v0, t.v1, t.v2, p)) << "case " << i;
  }
}

TEST(Orientation, IsExactAtEveryScale) {
  Rng rng(3);
  for (int exponent = -1070; exponent <= 1000; exponent += 23) {
    const auto scaled = [&](const Vec3& v) {
      return Vec3{std::ldexp(v.x, exponent), std::ldexp(v.y, exponent), std::ldexp(v.z, exponent)};
    };
    for (int i = 0; i < 8; ++i) {
      const Triangle t = lattice_triangle(rng, 6);
      const Vec3 a = scaled(t.v0), b = scaled(t.v1), c = scaled(t.v2), d = scaled(lattice_point(rng, 6));
      ASSERT_EQ(orient3d(a, b, c, d), rational_volume_sign(a, b, c, d)) << "exponent " << exponent;
      ASSERT_EQ(orient2d(a, b, c, 2), rational_area_sign(a, b, c, 2)) << "exponent " << exponent;
    }
  }
}

TEST(Orientation, IsExactForMixedMagnitudes) {
  Rng rng(4);
  const auto wild = [&] {
    const auto coordinate = [&] { return std::ldexp(rng.uniform(-1, 1), static_cast<int>(rng.below(1900)) - 1000); };
    const double x = coordinate(), y = coordinate(), z = coordinate();
    return Vec3{x, y, z};
  };
  for (int i = 0; i < 300; ++i) {
    const Vec3 a = wild(), b = wild(), c = wild(), d = wild();
    ASSERT_EQ(orient3d(a, b, c, d), rational_volume_sign(a, b, c, d)) << "case " << i;
  }
}

TEST(Orientation, IsExactFromTheSmallestToTheLargestNumberAtOnce) {
  const double small = 0x1p-1074, large = 0x1p1023;
  EXPECT_EQ(orient3d({}, {large, small, 0}, {0, large, 0}, {0, 0, large}), 1);
  EXPECT_EQ(orient3d({}, {large, small, 0}, {0, 0, large}, {0, large, 0}), -1);
  Rng rng(7);
  const auto coordinate = [&] {
    const double sign = rng.below(2) == 0 ? 1 : -1;
    if (rng.below(3) == 0) return 0.0;
    return rng.below(2) == 0 ? sign * std::ldexp(rng.uniform(0.5, 1), 1024 - static_cast<int>(rng.below(3)))
                             : sign * std::ldexp(1.0, static_cast<int>(rng.below(4)) - 1074);
  };
  const auto point = [&] {
    const double x = coordinate(), y = coordinate(), z = coordinate();
    return Vec3{x, y, z};
  };
  for (int i = 0; i < 500; ++i) {
    const Vec3 a = i % 2 == 0 ? Vec3{} : point(), b = point(), c = point(), d = point();
    ASSERT_EQ(orient3d(a, b, c, d), rational_volume_sign(a, b, c, d)) << "case " << i;
    ASSERT_EQ(orient2d(a, b, c, 1), rational_area_sign(a, b, c, 1)) << "case " << i;
  }
}

TEST(Orientation, IsExactWhereAProductUnderflowsInTheFilter) {
  // 1.49 of the smallest double rounds to 1, which turns 1.49 - 1.2 > 0 into 1 - 1.2 < 0.
  const Vec3 origin{0, 0, 0}, p{0, 0, 0x1p-537}, q{1.49 * 0x1p-537, 0x1p-537, 0}, r{1.2 * 0x1p200, 0x1p200, 0};
  EXPECT_EQ(orient3d(origin, p, q, r), 1);
  EXPECT_EQ(rational_volume_sign(origin, p, q, r), 1);
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

TEST(Orientation, ExpansionsAndBigIntegersAgree) {
  // The same lattice points with and without a factor that forces the big integers.
  Rng rng(5);
  for (int i = 0; i < 500; ++i) {
    const Triangle t = nudged(rng, lattice_triangle(rng));
    const Vec3 p = nudged(rng, lattice_point(rng));
    const double huge = 0x1p400;
    EXPECT_EQ(geometry::exact_volume_sign(t.v0, t.v1, t.v2, p),
              geometry::exact_volume_sign(t.v0 * huge, t.v1 * huge, t.v2 * huge, p * huge));
  }
}

TEST(Orientation, ChangesSignWithEverySwap) {
  Rng rng(6);
  for (int i = 0; i < 1000; ++i) {
    const auto [s, t] = random_pair(rng, PairKind::near_lattice);
    const int sign = orient3d(s.v0, s.v1, s.v2, t.v0);
    EXPECT_EQ(orient3d(s.v1, s.v0, s.v2, t.v0), -sign);
    EXPECT_EQ(orient3d(s.v0, s.v1, t.v0, s.v2), -sign);
    EXPECT_EQ(orient3d(t.v0, s.v1, s.v2, s.v0), -sign);
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The closest point of one triangle, next to exact arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr double half_ulp = 0x1p-53;

double extent_from(const Vec3& p, const Triangle& t) {
  return std::max({max_abs(t.v0 - p), max_abs(t.v1 - p), max_abs(t.v2 - p)});
}

/// A point near a triangle: on it up to rounding, around it, far away.
Vec3 point_near(Rng& rng, const Triangle& t) {
  switch (rng.below(5)) {
    case 0:
      return nudged(rng, point_on(t, rng.uniform(-1, 1), rng.uniform(-1, 1)));
    case 1:
      return t[rng.below(3)] + std::ldexp(1.0, -static_cast<int>(rng.below(60))) * uniform_point(rng);
    case 2:
      return 1000 * uniform_point(rng);
    case 3:
      return t[rng.below(3)] + std::ldexp(1.0, -static_cast<int>(rng.below(1075))) * uniform_point(rng);
    default:
      return uniform_point(rng);
  }
}

TEST(PointDistance, KnownValuesAndFeatures) {
  const Triangle t{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
  const auto expect = [&](const Vec3& p, double distance, const Vec3& weights, const Feature& feature) {
    const geometry::PointOnTriangle found = geometry::closest_on(t, p);
    EXPECT_EQ(found.distance, distance);
    EXPECT_EQ(found.weights, weights);
    EXPECT_EQ(geometry::feature_of(found.weights), feature);
  };
  expect({1, 1, 3}, 3, {0.5, 0.25, 0.25}, {FeatureKind::face, 0});
  expect({1, 1, 0}, 0, {0.5, 0.25, 0.25}, {FeatureKind::face, 0});
  expect({-3, -4, 0}, 5, {1, 0, 0}, {FeatureKind::vertex, 0});
  expect({8, -3, 0}, 5, {0, 1, 0}, {FeatureKind::vertex, 1});
  expect({-4, 7, 0}, 5, {0, 0, 1}, {FeatureKind::vertex, 2});
  expect({1, -7, 0}, 7, {0.75, 0.25, 0}, {FeatureKind::edge, 0});
  expect({5, 5, 0}, std::sqrt(18.0), {0, 0.5, 0.5}, {FeatureKind::edge, 1});
  expect({-3, 1, 4}, 5, {0.75, 0, 0.25}, {FeatureKind::edge, 2});
}

TEST(PointDistance, OfDegenerateTrianglesIsThatOfTheirHull) {
  const Vec3 o{0, 0, 0}, x{2, 0, 0}, y{6, 0, 0};
  for (const Triangle& t : {Triangle{o, x, y}, {x, o, y}, {o, y, x}, {o, y, o}, {o, y, y}, {y, o, o}}) {
    EXPECT_EQ(geometry::closest_on(t, {3, 4, 0}).distance, 4);
    EXPECT_EQ(geometry::closest_on(t, {-3, 4, 0}).distance, 5);
    EXPECT_EQ(geometry::closest_on(t, {9, 0, 4}).distance, 5);
    EXPECT_EQ(geometry::closest_on(t, {1, 0, 0}).distance, 0);
  }
  EXPECT_EQ(geometry::closest_on({x, x, x}, {2, 3, 4}).distance, 5);
  EXPECT_EQ(geometry::closest_on({x, x, x}, x).distance, 0);
}

/// Whether weights are those of a point of a triangle.
void expect_weights(const Vec3& w) {
  EXPECT_TRUE(w.x >= 0 && w.y >= 0 && w.z >= 0);
  EXPECT_FALSE(std::signbit(w.x) || std::signbit(w.y) || std::signbit(w.z)) << "no -0";
  EXPECT_NEAR(w.x + w.y + w.z, 1, 4 * half_ulp);
}

TEST(PointDistance, OfNeedlesWhoseAreasVanishHasWeights) {
  for (int exponent = 0; exponent >= -1074; --exponent) {
    const double width = std::ldexp(1.0, exponent);
    const Triangle needle{{0, 1, 0}, {0, 0, width}, {0, 0, 0}};
    for (const Vec3& p : {needle.v0, needle.v1, needle.v2, Vec3{width, 0.5, 0}, Vec3{width, width, width}}) {
      SCOPED_TRACE("width 2^" + std::to_string(exponent));
      expect_weights(geometry::closest_on(needle, p).weights);
    }
    // In one line up to rounding, and a point beside the end of it.
    const Triangle line{{3, 1, 0}, {1, 1 / 3.0, 0}, {0, 0, 0}};
    for (const Vec3& p : {Vec3{width, 0, 0}, Vec3{0, -width, 0}, Vec3{0, 0, width}, Vec3{-width, width, width}}) {
      SCOPED_TRACE("distance 2^" + std::to_string(exponent));
      const geometry::PointOnTriangle found = geometry::closest_on(line, p);
      expect_weights(found.weights);
      EXPECT_LE(found.distance, 2 * width);
    }
  }
}

TEST(PointDistance, IsWithinEightRoundingsOfTheExactOne) {
  Rng rng(821);
  for (int i = 0; i < 13'000; ++i) {
    const auto kind = static_cast<PairKind>(i % static_cast<int>(PairKind::count));
    const Triangle t = random_pair(rng, kind).second;
    const Vec3 p = rng.below(4) == 0 ? random_pair(rng, kind).first.v0 : point_near(rng, t);
    const geometry::PointOnTriangle found = geometry::closest_on(t, p);
    const exact::Fraction truth_sq = exact::squared_distance({p, p, p}, t);
    const double tolerance = 8 * half_ulp * extent_from(p, t) + 0x1p-1022;
    ASSERT_TRUE(exact::is_at_most(found.distance, truth_sq, tolerance)) << "case " << i;
    ASSERT_TRUE(exact::is_at_least(found.distance, truth_sq, tolerance)) << "case " << i;
    expect_weights(found.weights);
    ASSERT_FALSE(HasFailure()) << "case " << i;
    const double largest = std::max({max_abs(t.v0), max_abs(t.v1), max_abs(t.v2), max_abs(p)});
    const Vec3 off = geometry::point_at(t, found.weights) - p;
    ASSERT_NEAR(std::hypot(off.x, off.y, off.z), found.distance, 2 * tolerance + 8 * half_ulp * largest)
        << "case " << i;
  }
}

TEST(PointDistance, NeverExceedsThatOfTheEdges) {
  // Where rounding decides about the signs of areas, the edges are all that is certain.
  Rng rng(823);
  for (const PairKind kind : {PairKind::sliver, PairKind::near_lattice, PairKind::tiny_coordinates}) {
    for (int i = 0; i < 60'000; ++i) {
      const Triangle t = random_pair(rng, kind).second;
      const Vec3 p = point_near(rng, t);
      const double found = geometry::closest_on(t, p).distance,
                   tolerance = 16 * half_ulp * extent_from(p, t) + 0x1p-1022;
      for (std::size_t k = 0; k < 3; ++k) {
        const double of_edge = closest_points(Segment{p, p}, Segment{t[k], t[(k + 1) % 3]}).distance;
        ASSERT_LE(found, of_edge + tolerance) << "kind " << static_cast<int>(kind) << ", case " << i;
      }
    }
  }
}

TEST(PointDistance, IsTheSameToTheBitForAllTrianglesAtACorner) {
  Rng rng(822);
  int corner_count = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 corner = uniform_point(rng), p = corner + 0.3 * uniform_point(rng);
    const Vec3 away = corner - p;
    double first = -1;
    for (int k = 0; k < 6; ++k) {
      // Behind the plane through the corner, so the corner is the closest point.
      const auto behind = [&] {
        const Vec3 v = uniform_point(rng);
        return corner + (dot(v, away) < 0 ? -v : v);
      };
      const Vec3 v1 = behind(), v2 = behind();
      const Triangle turns[] = {{corner, v1, v2}, {v2, corner, v1}, {v1, v2, corner}};
      const geometry::PointOnTriangle found = geometry::closest_on(turns[rng.below(3)], p);
      if (geometry::feature_of(found.weights).kind != FeatureKind::vertex) continue;
      ++corner_count;
      if (first < 0) first = found.distance;
      ASSERT_EQ(found.distance, first) << "case " << i;
    }
  }
  EXPECT_GT(corner_count, 10'000);
}

}  // namespace
}  // namespace limber::testing

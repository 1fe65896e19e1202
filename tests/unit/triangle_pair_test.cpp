// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/features.h"
#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "simd/kernels.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

/// The exact distance rounded to a double.
double true_distance(const Triangle& a, const Triangle& b) { return std::sqrt(squared_distance(a, b).get_d()); }

double misfit(const Vec3& point, const Triangle& triangle) { return closest_points(point, triangle).distance; }

TEST(SegmentDistance, KnownValues) {
  const ClosestPoints crossing = closest_points(Segment{{-1, 0, 0}, {1, 0, 0}}, Segment{{0, -1, 2}, {0, 1, 2}});
  EXPECT_EQ(crossing.distance, 2);
  EXPECT_EQ(crossing.point_a, (Vec3{0, 0, 0}));
  EXPECT_EQ(crossing.point_b, (Vec3{0, 0, 2}));
  EXPECT_EQ(closest_points(Segment{{0, 0, 0}, {1, 0, 0}}, Segment{{3, 4, 0}, {9, 4, 0}}).distance, std::sqrt(20.0));
  EXPECT_EQ(closest_points(Segment{{0, 0, 0}, {0, 0, 0}}, Segment{{3, 4, 0}, {3, 4, 0}}).distance, 5);
  EXPECT_EQ(closest_points(Segment{{0, 0, 0}, {8, 0, 0}}, Segment{{3, 4, 0}, {9, 4, 0}}).distance, 4);
}

TEST(SegmentDistance, NearlyParallelSegmentsKeepTheirDigits) {
  Rng rng(20);
  for (int i = 0; i < 400; ++i) {
    const double angle = std::pow(10.0, -1 - (i % 16));
    const Vec3 direction = uniform_point(rng), off = uniform_point(rng);
    const Vec3 center = uniform_point(rng);
    const Segment a{center - direction, center + direction};
    const Segment b{center - direction - angle * off, center + direction + angle * off};
    const double exact = true_distance({a.p0, a.p1, a.p1}, {b.p0, b.p1, b.p1});
    EXPECT_NEAR(closest_points(a, b).distance, exact, 1e-15) << "angle " << angle;
  }
}

constexpr PairKind tame_kinds[] = {PairKind::uniform, PairKind::lattice,  PairKind::near_lattice, PairKind::touching,
                                   PairKind::sliver,  PairKind::coplanar, PairKind::shared_edge,  PairKind::needle};

TEST(TriangleDistance, ASharedPointIsThatOfClosestPointsAtAnyScale) {
  Rng rng(71);
  int intersecting = 0;
  for (std::size_t i = 0; i < 40'000; ++i) {
    const auto [a, b] = random_pair(rng, tame_kinds[i % std::size(tame_kinds)]);
    for (const double scale : {0x1p-180, 1.0, 0x1p180}) {
      const auto scaled = [scale](const Vec3& p) { return p * scale; };
      const Triangle a2 = mapped(a, scaled), b2 = mapped(b, scaled);
      if (!intersects(a2, b2)) continue;
      ++intersecting;
      const Vec3 shared = geometry::shared_point(a2, b2);
      ASSERT_EQ(shared, closest_points(a2, b2).point_a) << "case " << i << ", scale " << scale;
      const double tolerance = 4e-15 * std::max(extent_of_pair(a, b), 1e-300);
      ASSERT_LE(misfit(shared * (1 / scale), a), tolerance) << "case " << i << ", scale " << scale;
      ASSERT_LE(misfit(shared * (1 / scale), b), tolerance) << "case " << i << ", scale " << scale;
    }
  }
  EXPECT_GT(intersecting, 400);
}

/// Checks that points are on their triangles, as docs/algorithms/numerics.md says.
void expect_points_as_promised(const Triangle& a, const Triangle& b) {
  constexpr double u = 0x1p-53;
  const ClosestPoints found = closest_points(a, b);
  const double extent = extent_of_pair(a, b);
  double tolerance = 32 * u * extent + 2 * u * largest_coordinate(a, b) + 0x1p-1021;
  if (found.distance == 0) {
    const double height = std::min(smallest_height_of(a), smallest_height_of(b));
    const double of_slivers = height > 0 ? 8 * u * extent / height * extent : extent;
    tolerance += std::min(of_slivers, 0x1p-26 * extent);
  }
  EXPECT_LE(misfit(found.point_a, a), tolerance);
  EXPECT_LE(misfit(found.point_b, b), tolerance);
  EXPECT_NEAR(length(found.point_b - found.point_a), found.distance, 2 * tolerance);
  EXPECT_EQ(found.distance == 0, intersects(a, b));
  EXPECT_TRUE(found.distance > 0 || found.point_a == found.point_b);
}

/// The vector between the closest points of a triangle and one that is a point, from what the kernel for any two finds.
Vec3 as_any_two(const geometry::Face& a, const geometry::Face& b) {
  simd::TriangleFeatures found;
  simd::kernels().compare_triangles(a, b, found);
  const Vec3 start = b.corner[found.edge_b] - a.corner[found.edge_a];
  Vec3 best = start + (found.at_b * b.edge[found.edge_b] - found.at_a * a.edge[found.edge_a]);
  EXPECT_TRUE(found.feet_of_a == 0 || found.feet_of_b == 0);
  const Vec3 foot_of_b = b.corner.v0 - geometry::point_at(a.corner, a.foot_weights(b.corner.v0));
  if (found.feet_of_b != 0 && length_sq(foot_of_b) < length_sq(best)) best = foot_of_b;
  const Vec3 foot_of_a = geometry::point_at(b.corner, b.foot_weights(a.corner.v0)) - a.corner.v0;
  if (found.feet_of_a != 0 && length_sq(foot_of_a) < length_sq(best)) best = foot_of_a;
  return best;
}

TEST(TriangleDistance, OfAPointIsThatOfAnyTwoTrianglesToTheBit) {
  Rng rng(27);
  for (int i = 0; i < 20000; ++i) {
    // On lattices, where distances tie, and anywhere; also slivers, segments and points.
    const auto point = [&] { return i % 2 == 0 ? lattice_point(rng, 3) : uniform_point(rng); };
    Triangle t{point(), point(), point()};
    if (i % 5 == 0) t.v2 = t.v1 + 1e-9 * (t.v1 - t.v0);
    if (i % 7 == 0) t.v1 = t.v0;
    const Vec3 p = point() + Vec3{0, 0, i % 3 == 0 ? 1.0 : 0.0};
    const Triangle at_p{p, p, p};
    const auto local = [](const Triangle& of, const Vec3& origin) {
      return geometry::Face({of.v0 - origin, of.v1 - origin, of.v2 - origin});
    };
    const Vec3 t_to_p = as_any_two(local(t, t.v0), local(at_p, t.v0)), p_to_t = as_any_two(local(at_p, p), local(t, p));
    if (length_sq(t_to_p) < 1e-20) continue;  // they may meet
    EXPECT_EQ(closest_points(t, at_p).distance, length(t_to_p));
    EXPECT_EQ(closest_points(at_p, t).distance, length(p_to_t));
    EXPECT_EQ(closest_points(t, at_p).point_b, p);
    EXPECT_EQ(closest_points(at_p, t).point_a, p);
    const double extent = extent_of_pair(t, at_p);
    EXPECT_NEAR(length(closest_points(t, at_p).point_a - (p - t_to_p)), 0, 1e-14 * extent);
    EXPECT_NEAR(length(closest_points(at_p, t).point_b - (p + p_to_t)), 0, 1e-14 * extent);
  }
}

TEST(TriangleDistance, PointsLieOnTrianglesOfAnyScaleAnywhere) {
  Rng rng(131);
  for (int i = 0; i < 50'000 && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const auto [a, b] = random_pair(rng, static_cast<PairKind>(i % static_cast<int>(PairKind::count)));
    expect_points_as_promised(a, b);
  }
}

TEST(TriangleDistance, PointsLieOnSliversThatArePierced) {
  // The plane of a sliver is known up to rounding / height, and no point is farther than height / 2 from an edge.
  Rng rng(132);
  const auto direction = [&] {
    const Vec3 v = uniform_point(rng);
    return v * (1 / std::max(length(v), 1e-3));
  };
  for (int i = 0; i < 20'000 && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const Vec3 edge = direction(), side = cross(edge, direction()), at = rng.below(2) == 0 ? Vec3{} : direction();
    const double width = std::ldexp(rng.uniform(1, 2), -static_cast<int>(rng.below(50)));
    const Triangle a{at, at + edge, at + rng.uniform() * edge + width * side};
    const double u = rng.uniform(), v = rng.uniform() * (1 - u);
    const Vec3 inside = point_on(a, u, v), out = std::ldexp(1.0, -static_cast<int>(rng.below(50))) * direction();
    expect_points_as_promised(a, {inside - out, inside + rng.uniform() * out, inside + out});
  }
}

TEST(TriangleDistance, OfTrianglesInOneLineIsWithinEightRoundings) {
  // Half of them have heights from 2^-40 to 2^-49 of the length: the normals are off by up to a tenth, and a corner
  // over a face may be nearer than all edges by more than rounding.
  Rng rng(122);
  for (int i = 0; i < 8000; ++i) {
    const auto [a, b] = random_pair(rng, PairKind::one_line);
    const exact::Fraction truth_sq = exact::squared_distance(a, b);
    const double found = closest_points(a, b).distance, tolerance = 0x1p-50 * extent_of_pair(a, b) + 0x1p-1022;
    ASSERT_TRUE(exact::is_at_most(found, truth_sq, tolerance)) << "case " << i;
    ASSERT_TRUE(exact::is_at_least(found, truth_sq, tolerance)) << "case " << i;
  }
}

const Triangle flat_triangle{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};

struct KnownCase {
  const char* what;
  Triangle other;
  bool meets;
};

TEST(TriangleIntersection, KnownCases) {
  const KnownCase cases[] = {
      {"pierced by an edge", {{1, 1, -1}, {1, 1, 1}, {9, 9, 1}}, true},
      {"pierces with a corner", {{1, 1, -1}, {1, 0.5, 1}, {0.5, 1, 1}}, true},
      {"above", {{0, 0, 1}, {4, 0, 1}, {0, 4, 1}}, false},
      {"plane crossed beside the triangle", {{5, 5, -1}, {5, 5, 1}, {9, 9, 1}}, false},
      {"corner touches the face", {{1, 1, 0}, {1, 1, 5}, {2, 1, 5}}, true},
      {"corner touches a corner", {{4, 0, 0}, {6, 0, 1}, {6, 1, 1}}, true},
      {"corner touches an edge", {{2, 0, 0}, {2, -3, 1}, {3, -3, 1}}, true},
      {"edge touches an edge", {{2, -1, -1}, {2, 1, 1}, {2, -5, 0}}, true},
      {"shares an edge", {{0, 0, 0}, {4, 0, 0}, {0, -4, 3}}, true},
      {"the same", flat_triangle, true},
      {"the same reversed", {{0, 4, 0}, {4, 0, 0}, {0, 0, 0}}, true},
      {"coplanar, inside", {{0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0}}, true},
      {"coplanar, around", {{-9, -9, 0}, {20, -9, 0}, {-9, 20, 0}}, true},
      {"coplanar, crossing", {{1, -1, 0}, {2, -1, 0}, {1, 9, 0}}, true},
      {"coplanar, touching at a corner", {{4, 0, 0}, {8, 0, 0}, {8, 4, 0}}, true},
      {"coplanar, touching along an edge", {{1, 0, 0}, {3, 0, 0}, {2, -4, 0}}, true},
      {"coplanar, beside", {{3, 3, 0}, {5, 3, 0}, {3, 5, 0}}, false},
      {"segment through the face", {{1, 1, -1}, {1, 1, 1}, {1, 1, 1}}, true},
      {"segment with its middle corner between", {{1, 1, 1}, {1, 1, 0.5}, {1, 1, -1}}, true},
      {"segment ending on the face", {{1, 1, 0}, {1, 1, 1}, {1, 1, 2}}, true},
      {"segment short of the face", {{1, 1, 0.5}, {1, 1, 1}, {1, 1, 2}}, false},
      {"segment in the plane, crossing", {{-1, 1, 0}, {9, 1, 0}, {2, 1, 0}}, true},
      {"segment in the plane, inside", {{0.5, 0.5, 0}, {1, 1, 0}, {1, 1, 0}}, true},
      {"segment in the plane, beside", {{4, 4, 0}, {5, 5, 0}, {5, 5, 0}}, false},
      {"segment along an edge, beyond it", {{5, 0, 0}, {6, 0, 0}, {7, 0, 0}}, false},
      {"segment along an edge, reaching it", {{4, 0, 0}, {6, 0, 0}, {7, 0, 0}}, true},
      {"point in the face", {{1, 1, 0}, {1, 1, 0}, {1, 1, 0}}, true},
      {"point on the slanted edge", {{2, 2, 0}, {2, 2, 0}, {2, 2, 0}}, true},
      {"point at a corner", {{0, 4, 0}, {0, 4, 0}, {0, 4, 0}}, true},
      {"point beside", {{3, 3, 0}, {3, 3, 0}, {3, 3, 0}}, false},
      {"point above", {{1, 1, 1e-300}, {1, 1, 1e-300}, {1, 1, 1e-300}}, false},
  };
  for (const KnownCase& c : cases) {
    EXPECT_EQ(intersects(flat_triangle, c.other), c.meets) << c.what;
    EXPECT_EQ(intersects(c.other, flat_triangle), c.meets) << c.what;
  }
}

TEST(TriangleIntersection, DegenerateAgainstDegenerate) {
  const auto segment = [](const Vec3& a, const Vec3& b) { return Triangle{a, b, 0.5 * (a + b)}; };
  const auto point = [](const Vec3& a) { return Triangle{a, a, a}; };
  EXPECT_TRUE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({0, -1, 0}, {0, 1, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({0, -1, 1}, {0, 1, 1})));
  EXPECT_TRUE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({1, 0, 0}, {2, 0, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({2, 0, 0}, {3, 0, 0})));
  EXPECT_FALSE(intersects(segment({-1, 0, 0}, {1, 0, 0}), segment({-1, 1, 0}, {1, 1, 0})));
  EXPECT_TRUE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({2, 2, 2})));
  EXPECT_FALSE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({6, 6, 6})));
  EXPECT_FALSE(intersects(segment({1, 1, 1}, {5, 5, 5}), point({2, 2, 3})));
  EXPECT_TRUE(intersects(point({1, 2, 3}), point({1, 2, 3})));
  EXPECT_FALSE(intersects(point({1, 2, 3}), point({1, 2, std::nextafter(3.0, 4.0)})));
}

TEST(TriangleIntersection, DoesNotDependOnOrderOrScale) {
  Rng rng(13);
  for (int i = 0; i < 2000; ++i) {
    const auto kind = static_cast<PairKind>(i % static_cast<int>(PairKind::count));
    const auto [a, b] = random_pair(rng, kind);
    const bool answer = intersects(a, b);
    ASSERT_EQ(intersects(b, a), answer) << "case " << i;
    ASSERT_EQ(intersects({a.v1, a.v2, a.v0}, {b.v2, b.v1, b.v0}), answer) << "case " << i;
    for (const double scale : {0x1p-150, 0x1p-40, 0x1p190}) {
      const bool has_subnormals =
          kind == PairKind::near_lattice || kind == PairKind::segment_like || kind == PairKind::needle;
      if (has_subnormals && scale < 1) continue;  // zeros that were nudged would vanish
      const auto scaled = [scale](const Vec3& p) { return p * scale; };
      ASSERT_EQ(intersects(mapped(a, scaled), mapped(b, scaled)), answer) << "case " << i << ", scale " << scale;
    }
  }
}

TEST(TriangleIntersection, SegmentOverloadAgreesWithSegmentLikeTriangle) {
  EXPECT_TRUE(intersects(Segment{{1, 1, -1}, {1, 1, 1}}, flat_triangle));
  EXPECT_FALSE(intersects(Segment{{5, 5, -1}, {5, 5, 1}}, flat_triangle));
  EXPECT_TRUE(intersects(Segment{{4, 0, 0}, {9, 0, 0}}, flat_triangle));
}

}  // namespace
}  // namespace limber::testing

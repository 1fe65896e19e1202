// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/points.h"

#include <gtest/gtest.h>

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/local_frame.h"
#include "geometry/primitives.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"
#include "support/random_points.h"
#include "unit/refusals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

TEST(Points, OfTiesAreOnTheFirstTriangle) {
  const Model model(box_mesh({0, 0, 0}, {1, 1, 1}));
  const SurfacePoint corner = closest_point({model}, {-2, -3, -6}).closest.value();
  EXPECT_EQ(corner.distance, 7);
  EXPECT_EQ(corner.position, (Vec3{0, 0, 0}));
  EXPECT_EQ(corner.triangle, 0U);  // the lowest of five
  EXPECT_EQ(corner.feature, (Feature{FeatureKind::vertex, 0}));
}

TEST(Points, BeyondTheLimitAreNotFound) {
  const Model model(box_mesh({0, 0, 0}, {1, 1, 1}));
  const Vec3 point{0.25, 0.25, 3};
  EXPECT_TRUE(closest_point({model}, point, {.max_distance = 2}).closest.has_value());
  EXPECT_FALSE(closest_point({model}, point, {.max_distance = std::nextafter(2, 0)}).closest.has_value());
  EXPECT_FALSE(closest_point({model}, point, {.max_distance = 0}).closest.has_value());
  EXPECT_TRUE(closest_point({model}, {0.25, 0.25, 1}, {.max_distance = 0}).closest.has_value());
  const PointResult far = closest_point({model}, {0x1p199, 0, 0}, {.max_distance = 1});
  EXPECT_FALSE(far.closest.has_value());
  EXPECT_LT(far.stats.node_tests + far.stats.primitive_tests, 20U);
}

TEST(Points, CostLittleHoweverFarAway) {
  const Model model(scenes::ball(200, 100));
  Rng rng(811);
  for (int exponent = 0; exponent < 30; ++exponent) {
    for (int i = 0; i < 10; ++i) {
      const Vec3 point = std::ldexp(1.5, exponent) * uniform_point(rng) + Vec3{0, 0, std::ldexp(1.0, exponent)};
      const PointResult found = closest_point({model}, point);
      EXPECT_LT(found.stats.node_tests, 600U) << exponent;
      EXPECT_LT(found.stats.primitive_tests, 150U) << exponent;
    }
  }
}

TEST(Points, OfCoincidentTrianglesCostNoMoreThanOfAFew) {
  const Triangle t{{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0}};
  const Model model(soup(std::vector<Triangle>(8000, t)));
  const PointResult found = closest_point({model}, {0.3, 0.3, 2});
  EXPECT_EQ(found.closest->distance, 2);
  EXPECT_LT(found.stats.node_tests + found.stats.primitive_tests, 100U);
}

TEST(Points, InBatchesAreThoseOneByOneOnAnyNumberOfThreads) {
  const Model model(scenes::ball(60, 30));
  const Transform pose{{}, {1, 2, 3}};
  Rng rng(813);
  for (const std::size_t count : {0, 1, 63, 64, 65, 1000}) {
    std::vector<Vec3> points(count);
    for (Vec3& p : points) p = arbitrary_query_point(rng, {model.mesh(), pose}, 2);
    const PointOptions options{.max_distance = rng.uniform(0.5, 2)};
    for (const int threads : {1, 2}) {
      // What was in the results before does not matter.
      std::vector<PointResult> results(count, closest_point({model}, {}));
      oneapi::tbb::task_arena(threads).execute([&] { closest_point_many({model, pose}, points, results, options); });
      for (std::size_t i = 0; i < count; ++i) {
        const PointResult alone = closest_point({model, pose}, points[i], options);
        expect_same_point(results[i], alone, std::to_string(i));
        ASSERT_EQ(results[i].stats.node_tests, alone.stats.node_tests);
        ASSERT_EQ(results[i].stats.primitive_tests, alone.stats.primitive_tests);
      }
    }
  }
}

TEST(Points, MisuseIsRefusedAndWritesNothing) {
  Model model(box_mesh({0, 0, 0}, {1, 1, 1}));
  const reference::Placed mesh{model.mesh()};
  std::vector<Vec3> points(100);
  std::vector<PointResult> results(100);
  for (const double bad : {no_number, -1.0, -no_limit}) {
    EXPECT_THROW(static_cast<void>(closest_point({model}, {}, {.max_distance = bad})), std::invalid_argument);
    EXPECT_THROW(closest_point_many({model}, points, results, {.max_distance = bad}), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(reference::closest_point(mesh, {}, {.max_distance = bad})), std::invalid_argument);
  }
  for (const double bad : {no_number, no_limit, 0x1p201}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 point;
      point[axis] = bad;
      EXPECT_THROW(static_cast<void>(closest_point({model}, point)), std::invalid_argument);
      EXPECT_THROW(static_cast<void>(reference::closest_point(mesh, point)), std::invalid_argument);
      points[99] = point;
      EXPECT_TRUE(is_refused([&] { closest_point_many({model}, points, results); }, {"points[99]"}));
    }
  }
  EXPECT_FALSE(results[0].closest.has_value());
  points.pop_back();
  EXPECT_THROW(closest_point_many({model}, points, results), std::invalid_argument);
  EXPECT_THROW(static_cast<void>(closest_point({model, {{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {}}}, {})),
               std::invalid_argument);
  const std::vector<VertexId> ids{0};
  const std::vector<Vec3> to{{0, 0, -1}};
  model.move_vertices(ids, to).value();
  EXPECT_THROW(static_cast<void>(closest_point({model}, {})), std::invalid_argument);
  model.commit();
  EXPECT_NO_THROW(static_cast<void>(closest_point({model}, {})));
  EXPECT_TRUE(is_refused(
      [&] {
        static_cast<void>(closest_point({model}, {no_number, 0, 0}));
      },
      {"limber::closest_point: "}));
}

constexpr double half_ulp = 0x1p-53;

double extent_from(const Vec3& p, const Triangle& t) { return extent_of_pair({p, p, p}, t); }

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
    EXPECT_EQ(closest_points(p, t).distance, distance);
    EXPECT_EQ(closest_points(p, t).point_b, geometry::point_at(t, weights));
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

/// Whether weights are those of a point of a triangle.
void expect_weights(const Vec3& w) {
  EXPECT_TRUE(w.x >= 0 && w.y >= 0 && w.z >= 0);
  EXPECT_FALSE(std::signbit(w.x) || std::signbit(w.y) || std::signbit(w.z)) << "no -0";
  EXPECT_NEAR(w.x + w.y + w.z, 1, 4 * half_ulp);
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
    const double largest = largest_coordinate(t, {p, p, p});
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

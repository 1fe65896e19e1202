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

#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_points.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

TEST(Points, KnownAnswers) {
  const Model model(box_mesh({0, 0, 0}, {1, 1, 1}));
  const auto ask = [&](const Vec3& p) { return closest_point({model}, p).closest.value(); };
  const SurfacePoint above = ask({0.25, 0.5, 3});
  EXPECT_EQ(above.distance, 2);
  EXPECT_EQ(above.position, (Vec3{0.25, 0.5, 1}));
  EXPECT_EQ(above.triangle, 2U);
  EXPECT_EQ(above.feature, (Feature{FeatureKind::face, 0}));
  EXPECT_EQ(above.barycentric, (std::array<double, 3>{0.25, 0.25, 0.5}));
  const SurfacePoint corner = ask({-2, -3, -6});
  EXPECT_EQ(corner.distance, 7);
  EXPECT_EQ(corner.position, (Vec3{0, 0, 0}));
  EXPECT_EQ(corner.triangle, 0U);  // the lowest of five
  EXPECT_EQ(corner.feature, (Feature{FeatureKind::vertex, 0}));
  const SurfacePoint edge = ask({4, 0.5, 5});
  EXPECT_EQ(edge.distance, 5);
  EXPECT_EQ(edge.position, (Vec3{1, 0.5, 1}));
  EXPECT_EQ(edge.triangle, 3U);
  EXPECT_EQ(edge.feature, (Feature{FeatureKind::edge, 0}));
  EXPECT_EQ(ask({0.5, 0.5, 0.75}).distance, 0.25);
  EXPECT_EQ(ask({0.5, 0.25, 1}).distance, 0);
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
  EXPECT_LT(far.stats.node_tests + far.stats.triangle_tests, 20U);
}

TEST(Points, CostLittleHoweverFarAway) {
  const Model model(scenes::ball(200, 100));
  Rng rng(811);
  for (int exponent = 0; exponent < 30; ++exponent) {
    for (int i = 0; i < 10; ++i) {
      const Vec3 point = std::ldexp(1.5, exponent) * uniform_point(rng) + Vec3{0, 0, std::ldexp(1.0, exponent)};
      const PointResult found = closest_point({model}, point);
      EXPECT_LT(found.stats.node_tests, 600U) << exponent;
      EXPECT_LT(found.stats.triangle_tests, 100U) << exponent;
    }
  }
}

TEST(Points, OfCoincidentTrianglesCostNoMoreThanOfAFew) {
  const Triangle t{{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0}};
  const Model model(soup(std::vector<Triangle>(8000, t)));
  const PointResult found = closest_point({model}, {0.3, 0.3, 2});
  EXPECT_EQ(found.closest->distance, 2);
  EXPECT_LT(found.stats.node_tests + found.stats.triangle_tests, 100U);
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
      oneapi::tbb::task_arena(threads).execute([&] { closest_points({model, pose}, points, results, options); });
      for (std::size_t i = 0; i < count; ++i) {
        const PointResult alone = closest_point({model, pose}, points[i], options);
        expect_same_point(results[i], alone, std::to_string(i));
        ASSERT_EQ(results[i].stats.node_tests, alone.stats.node_tests);
        ASSERT_EQ(results[i].stats.triangle_tests, alone.stats.triangle_tests);
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
    EXPECT_THROW(closest_point({model}, {}, {.max_distance = bad}), std::invalid_argument);
    EXPECT_THROW(closest_points({model}, points, results, {.max_distance = bad}), std::invalid_argument);
    EXPECT_THROW(reference::closest_point(mesh, {}, {.max_distance = bad}), std::invalid_argument);
  }
  for (const double bad : {no_number, no_limit, 0x1p201}) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      Vec3 point;
      point[axis] = bad;
      EXPECT_THROW(closest_point({model}, point), std::invalid_argument);
      EXPECT_THROW(reference::closest_point(mesh, point), std::invalid_argument);
      points[99] = point;
      EXPECT_THROW(closest_points({model}, points, results), std::invalid_argument);
    }
  }
  EXPECT_FALSE(results[0].closest.has_value());
  points.pop_back();
  EXPECT_THROW(closest_points({model}, points, results), std::invalid_argument);
  EXPECT_THROW(closest_point({model, {{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {}}}, {}), std::invalid_argument);
  const std::vector<VertexId> ids{0};
  const std::vector<Vec3> to{{0, 0, -1}};
  model.move_vertices(ids, to).value();
  EXPECT_THROW(closest_point({model}, {}), std::invalid_argument);
  model.commit();
  EXPECT_NO_THROW(closest_point({model}, {}));
  try {
    closest_point({model}, {no_number, 0, 0});
  } catch (const std::invalid_argument& thrown) {
    EXPECT_NE(std::string(thrown.what()).find("limber::closest_point: "), std::string::npos);
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Promises of every engine about its queries.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "limber/distance.h"
#include "scenes/scenes.h"
#include "support/brute_force.h"
#include "support/engines.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

const Triangle unit_triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};

template <typename Engine>
class Query : public ::testing::Test, public Asking<Engine> {};

TYPED_TEST_SUITE(Query, Engines, EngineNames);

TYPED_TEST(Query, OfSingleTrianglesIsThatOfThePrimitive) {
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  const DistanceResult r = this->distance(a, b);
  EXPECT_EQ(r.upper, 2);
  EXPECT_EQ(r.lower, 2);
  EXPECT_EQ(r.status, Status::exact);
  EXPECT_EQ(r.witness->triangle_a, 0U);
  EXPECT_EQ(r.witness->triangle_b, 0U);
  EXPECT_EQ(r.stats.triangle_tests, 1U);
}

TYPED_TEST(Query, PointsAreInTheWorldFrame) {
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({unit_triangle}));
  const DistanceResult r = this->distance(a, b, {{}, {0, 0, 10}}, {}, {{}, {0, 0, 7}});
  EXPECT_EQ(r.upper, 3);
  EXPECT_EQ(r.witness->point_a.z, 7);
  EXPECT_EQ(r.witness->point_b.z, 10);
}

TYPED_TEST(Query, TakesTrianglesAsSurfacesNotSolids) {
  const typename TestFixture::Model shell(scenes::ball(32, 17));
  std::vector<Vec3> positions = scenes::ball(16, 9).positions();
  for (Vec3& p : positions) p *= 0.25;
  const typename TestFixture::Model kernel(Mesh::create(positions, scenes::ball(16, 9).triangles()).value());
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
    EXPECT_EQ(r.status, Status::collision);
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
  EXPECT_EQ(this->distance(a, b, {}, {.relative_error = 1e308}).status, Status::collision);
  EXPECT_EQ(this->distance(a, b, {}, {.absolute_error = 1}).status, Status::collision);
}

TYPED_TEST(Query, TellsTheSmallestGapFromAContact) {
  const double gap = std::numeric_limits<double>::denorm_min();
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{0.2, 0.2, gap}, {3, 0, 1}, {3, 1, 1}}}));
  EXPECT_FALSE(this->collide(a, b).is_yes());
  EXPECT_GT(this->distance(a, b).upper, 0);
  EXPECT_FALSE(this->within(a, b, 0).is_yes());
}

TYPED_TEST(Query, LimitIsClosed) {
  const typename TestFixture::Model a(soup({unit_triangle})), b(soup({{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}}}));
  const double below = std::nextafter(2.0, 0.0);
  EXPECT_TRUE(this->within(a, b, 2).is_yes());
  EXPECT_FALSE(this->within(a, b, below).is_yes());
  EXPECT_FALSE(this->within(a, b, below).witness.has_value());
  EXPECT_EQ(this->distance(a, b, {}, {.max_distance = 2}).status, Status::exact);
  const DistanceResult beyond = this->distance(a, b, {}, {.max_distance = below});
  EXPECT_EQ(beyond.status, Status::beyond_limit);
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

TYPED_TEST(Query, KeepsThePromiseOfEveryError) {
  const typename TestFixture::Model square(scenes::grid(16, 16, -4, -4, 0.5, 0.5)), ball(scenes::ball(16, 9));
  for (const double separation : {0.01, 1.0, 16.0}) {
    const Transform pose = scenes::ball_over_square(ball.mesh(), separation, 0);
    const double truth = this->distance(square, ball, pose).upper;
    EXPECT_NEAR(truth, separation, 1e-13);
    EXPECT_FALSE(this->within(square, ball, separation * 0.999, pose).is_yes());
    for (const double error : {0.01, 0.1, 0.5, 1.0}) {
      const DistanceResult relative = this->distance(square, ball, pose, {.relative_error = error});
      EXPECT_LE(truth, relative.upper);
      EXPECT_LE(relative.upper, truth * (1 + error));
      EXPECT_LE(relative.lower, truth);
      EXPECT_GE(relative.lower * (1 + error), relative.upper * (1 - 1e-15));
      const DistanceResult absolute = this->distance(square, ball, pose, {.absolute_error = error});
      EXPECT_LE(truth, absolute.upper);
      EXPECT_LE(absolute.upper, truth + error);
      EXPECT_LE(absolute.lower, truth);
      const CollideResult near = this->within(square, ball, separation + error, pose);
      ASSERT_TRUE(near.is_yes());
      EXPECT_LE(length(near.witness->point_b - near.witness->point_a), separation + error + 1e-13);
    }
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

// The first pair of triangles is seldom close, and best first comes late to others.
TEST(Queries, WithAnErrorFindCloserPairsOnTheirWay) {
  const Model model(scenes::ring(40, 40, 0.1));
  std::uint64_t node_tests = 0;
  for (std::uint32_t index = 0; index < 16; ++index) {
    const Transform pose = scenes::linked_ring(index);
    const double truth = distance({model}, {model, pose}).upper;
    const DistanceResult close = distance({model}, {model, pose}, {.relative_error = 0.3});
    EXPECT_LE(close.lower, truth);
    EXPECT_GE(close.upper, truth);
    EXPECT_LE(close.upper, 1.3 * truth);
    node_tests += close.stats.node_tests;
  }
  EXPECT_LE(node_tests, 12'000U);  // 16 100 with one descent, or if no nearer pairs are looked for where others end
}

TEST(Queries, FarFromEachOtherKeepErrorsAndLimits) {
  const Model square(scenes::grid(16, 16, -4, -4, 0.5, 0.5)), ball(scenes::ball(16, 9));
  const Transform pose = scenes::ball_over_square(ball.mesh(), 64, 0);
  // Any two points are within the error, but not within the limit, or the error is too small.
  for (const DistanceOptions& options : {DistanceOptions{.relative_error = 0.1, .max_distance = 64.0001},
                                         DistanceOptions{.relative_error = 1e-4}, DistanceOptions{}}) {
    const DistanceResult r = distance({square}, {ball, pose}, options);
    EXPECT_LE(r.upper, std::min(64 * (1 + options.relative_error) + 1e-12, options.max_distance));
  }
  EXPECT_TRUE(within({square}, {ball, pose}, 64.0001).is_yes());
  EXPECT_FALSE(within({square}, {ball, pose}, 63.9999).is_yes());
  // Where they may meet, an error hides no contact.
  const Transform touching = scenes::ball_over_square(ball.mesh(), -0.01, 0);
  EXPECT_EQ(distance({square}, {ball, touching}, {.absolute_error = 100}).upper, 0);
  // Nor are two points an answer where one would be.
  const Model touched(scenes::grid(1, 1, 0, 0, 1, 1)), vertex(soup({{{0.5, 0.5, 0}, {0, 0, 1}, {1, 0, 1}}}));
  const CollideResult near = within({touched}, {vertex}, 100);
  ASSERT_TRUE(near.is_yes());
  EXPECT_EQ(near.witness->point_a, near.witness->point_b);
}

TYPED_TEST(Query, EqualsBruteForceOnLatticeAndUniformSoups) {
  Rng rng(70);
  for (int i = 0; i < 3000; ++i) {
    const Mesh mesh_a = i % 2 == 0 ? scenes::lattice_soup(rng, 6, 4) : scenes::random_soup(rng, 6, 2);
    const Mesh mesh_b = i % 2 == 0 ? scenes::lattice_soup(rng, 6, 4) : scenes::random_soup(rng, 6, 2);
    const typename TestFixture::Model a(mesh_a), b(mesh_b);
    const double truth = reference::distance({mesh_a}, {mesh_b}).upper;
    ASSERT_NEAR(this->distance(a, b).upper, truth, 1e-15) << "case " << i;
    ASSERT_EQ(this->distance(a, b).upper == 0, truth == 0) << "case " << i;
    ASSERT_EQ(this->collide(a, b).is_yes(), truth == 0) << "case " << i;
  }
}

TYPED_TEST(Query, HoldsFarFromTheOrigin) {
  Rng rng(71);
  for (int i = 0; i < 200; ++i) {
    const Mesh mesh_a = scenes::random_soup(rng, 10, 2), mesh_b = scenes::random_soup(rng, 10, 2);
    const typename TestFixture::Model a(mesh_a), b(mesh_b);
    const Transform far_a{scenes::random_rotation(rng), {1e8, -1e8, 3e8}};
    const Transform far_b{scenes::random_rotation(rng), {1e8 + 1, -1e8, 3e8}};
    const double truth = reference::distance({mesh_a, far_a}, {mesh_b, far_b}).upper;
    ASSERT_NEAR(this->distance(a, b, far_b, {}, far_a).upper, truth, 1e-15 * 3e8) << "case " << i;
  }
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

TYPED_TEST(Query, WorksAtEveryScale) {
  // Powers of two change nothing but the exponents, as long as squares stay normal.
  Rng rng(73);
  for (const int exponent : {-140, -60, 0, 60, 195}) {
    const double scale = std::ldexp(1.0, exponent);
    const auto scaled = [&](const Mesh& mesh) {
      std::vector<Vec3> positions = mesh.positions();
      for (Vec3& p : positions) p *= scale;
      return Mesh::create(std::move(positions), mesh.triangles()).value();
    };
    for (int i = 0; i < 20; ++i) {
      const Mesh mesh_a = scenes::random_soup(rng, 20, 1), mesh_b = scenes::random_soup(rng, 20, 1);
      const Transform pose{scenes::random_rotation(rng), {3, 1, 2}};
      const double truth = reference::distance({mesh_a}, {mesh_b, pose}).upper;
      const typename TestFixture::Model a(scaled(mesh_a)), b(scaled(mesh_b));
      const double found = this->distance(a, b, {pose.rotation, pose.translation * scale}).upper;
      ASSERT_NEAR(found / scale, truth, 1e-14) << "2^" << exponent;
    }
  }
}

TYPED_TEST(Query, ComparesModelsOfVeryDifferentSize) {
  // A speck over a plane 2^40 times its size, and two specks that are far apart next to their size.
  Rng rng(74);
  const double tiny = 0x1p-40;
  std::vector<Vec3> positions = scenes::ball(8, 5).positions();
  for (Vec3& p : positions) p *= tiny;
  const Mesh speck_mesh = Mesh::create(std::move(positions), scenes::ball(8, 5).triangles()).value();
  const Mesh plane_mesh = scenes::grid(8, 8, -4, -4, 1, 1);
  const typename TestFixture::Model speck(speck_mesh), plane(plane_mesh);
  for (int i = 0; i < 50; ++i) {
    const double x = rng.uniform(-4, 4), y = rng.uniform(-4, 4), height = rng.uniform(-1, 3) * tiny;
    const Transform pose{scenes::random_rotation(rng), {x, y, height}};
    const double truth = reference::distance({plane_mesh}, {speck_mesh, pose}).upper;
    ASSERT_NEAR(this->distance(plane, speck, pose).upper, truth, 4e-15);
    ASSERT_EQ(this->collide(plane, speck, pose).is_yes(), truth == 0);
    ASSERT_NEAR(this->distance(speck, speck, pose).upper, reference::distance({speck_mesh}, {speck_mesh, pose}).upper,
                4e-15);
  }
}

TYPED_TEST(Query, ComparesModelsWorldsApart) {
  // Sizes and distance are powers of two that have nothing to do with each other.
  Rng rng(75);
  const auto any_scale = [&] { return std::ldexp(1.0, static_cast<int>(rng.below(241)) - 120); };
  const Mesh shape = scenes::ball(8, 5);
  const auto scaled = [&](double scale) {
    std::vector<Vec3> positions = shape.positions();
    for (Vec3& p : positions) p *= scale;
    return Mesh::create(std::move(positions), shape.triangles()).value();
  };
  for (int i = 0; i < 100; ++i) {
    const double size_a = any_scale(), size_b = any_scale(), apart = any_scale();
    const Mesh mesh_a = scaled(size_a), mesh_b = scaled(size_b);
    const Transform pose{scenes::random_rotation(rng), apart * uniform_point(rng)};
    const double truth = reference::distance({mesh_a}, {mesh_b, pose}).upper;
    const typename TestFixture::Model a(mesh_a), b(mesh_b);
    ASSERT_NEAR(this->distance(a, b, pose).upper, truth, 1e-14 * (size_a + size_b + apart)) << i;
    ASSERT_EQ(this->collide(a, b, pose).is_yes(), truth == 0) << i;
  }
}

TYPED_TEST(Query, FindsWhatIsCloseToOneSideOfALopsidedModel) {
  // The smallest sphere around a shallow dome has its center in the plane of the rim, so the dome is on one side of it.
  Rng rng(41);
  for (int i = 0; i < 40; ++i) {
    const int rings = 6, sectors = 12;
    std::vector<Vec3> positions{{0, 0, 0.2}};
    for (int r = 1; r <= rings; ++r) {
      for (int s = 0; s < sectors; ++s) {
        const double radius = static_cast<double>(r) / rings, angle = 2 * std::numbers::pi * s / sectors;
        positions.push_back({radius * std::cos(angle), radius * std::sin(angle), 0.2 * (1 - radius * radius)});
      }
    }
    const auto at = [&](int r, int s) { return static_cast<VertexId>(1 + (r - 1) * sectors + s % sectors); };
    std::vector<Corners> triangles;
    for (int s = 0; s < sectors; ++s) {
      triangles.push_back({0, at(1, s), at(1, s + 1)});
      for (int r = 1; r < rings; ++r) {
        triangles.push_back({at(r, s), at(r + 1, s), at(r + 1, s + 1)});
        triangles.push_back({at(r, s), at(r + 1, s + 1), at(r, s + 1)});
      }
    }
    const Transform turn{scenes::random_rotation(rng), uniform_point(rng)};
    for (Vec3& p : positions) p = turn(p);
    const typename TestFixture::Model dome(Mesh::create(positions, triangles).value());
    const Vec3 above = turn({0.1 * rng.uniform(-1, 1), 0.1 * rng.uniform(-1, 1), 0.2 + rng.uniform(0.001, 0.1)});
    const typename TestFixture::Model point(soup({{above, above, above}}));
    const double truth = this->distance(dome, point).upper;
    ASSERT_LE(truth, 0.11);
    ASSERT_TRUE(this->within(dome, point, truth).is_yes()) << i;
    ASSERT_TRUE(this->within(point, dome, truth * (1 + 1e-14)).is_yes()) << i;  // the other order rounds differently
  }
}

TYPED_TEST(Query, SharesModelsBetweenThreads) {
  const typename TestFixture::Model square(scenes::grid(16, 16, -4, -4, 0.5, 0.5)), ball(scenes::ball(16, 9));
  const auto separation = [](std::size_t i) { return 0.25 + 0.5 * static_cast<double>(i % 4); };
  std::vector<double> found(8);
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < found.size(); ++i) {
      threads.emplace_back([&, i] {
        const Transform pose = scenes::ball_over_square(ball.mesh(), separation(i), 0);
        for (int repeat = 0; repeat < 5; ++repeat) found[i] = this->distance(square, ball, pose).upper;
        if (this->collide(square, ball, pose).is_yes()) found[i] = -1;
      });
    }
  }
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], separation(i), 1e-13);
}

}  // namespace
}  // namespace limber::testing

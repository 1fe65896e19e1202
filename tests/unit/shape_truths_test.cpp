// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Shapes next to what formulas say, in queries, scenes and on paths.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "limber/distance.h"
#include "limber/gradients.h"
#include "limber/path.h"
#include "limber/scene.h"
#include "limber/shapes.h"
#include "support/random_bodies.h"
#include "support/random_solids.h"

namespace limber::testing {
namespace {

Transform at(const Vec3& translation) { return {Mat3{}, translation}; }

TEST(ShapeTruths, ThatTouchCollide) {
  for (const double scale : {1.0, 0x1p-500, 0x1p150, 0x1p-1000}) {
    const Shape a = Shape::sphere(scale), b = Shape::sphere(2 * scale);
    const double touching = 3 * scale, apart = std::nextafter(touching, 1e300);
    EXPECT_TRUE(collide(a, {b, at({touching, 0, 0})}).is_yes());
    EXPECT_EQ(distance(a, {b, at({touching, 0, 0})}).status, DistanceStatus::collision);
    const DistanceResult near = distance(a, {b, at({0, apart, 0})});
    EXPECT_EQ(near.upper, apart - touching);
    EXPECT_TRUE(collide(a, {b, at({0, apart, 0})}).is_no());
  }
}

TEST(ShapeTruths, WitnessesAreAsFarApartAsBodiesOfAnySize) {
  for (int exponent = -1020; exponent <= 190; exponent += 10) {
    const double s = std::ldexp(1.0, exponent);
    const Shape ball = Shape::sphere(2 * s);
    const DistanceResult near = distance(ball, {ball, at({3 * s, 4 * s, 0})});
    ASSERT_EQ(near.upper, s);
    const Vec3 gap = (near.witness->point_b - near.witness->point_a) * (1 / s);
    EXPECT_NEAR(gap.x, 0.6, 1e-14) << exponent;
    EXPECT_NEAR(gap.y, 0.8, 1e-14) << exponent;
  }
}

TEST(ShapeTruths, TheRadiusOfTheBodyThatAsksAScene) {
  const Shape large = Shape::sphere(100), small = Shape::sphere(1);
  Scene scene;
  const ObjectId met = scene.add({small, at({-98, 0, 0})});
  static_cast<void>(scene.add({small, at({0, 140, 0})}));
  scene.commit();
  for (const double limit : {std::numeric_limits<double>::infinity(), 10.0, 0.0}) {
    const ClosestObjectResult closest = scene.closest_object(large, {.distance = {.max_distance = limit}});
    EXPECT_EQ(closest.object, met) << limit;
    EXPECT_EQ(closest.result.upper, 0) << limit;
  }
  const auto is_far = [&](ObjectId id) { return id != met; };
  EXPECT_NEAR(scene.closest_object(large, {.filter = is_far}).result.upper, 39, 1e-13);
}

// One vertex tells; a search of the outer surface, all of which is about equally far from the inner one, is not needed.
TEST(ShapeTruths, WhatIsInsideAsAWholeIsFoundSoon) {
  const Model ball(scenes::ball(200, 100));
  const ClosedSurface surface = ClosedSurface::create(ball).value();
  const Shape small = Shape::sphere(0.1);
  const std::vector<Vec3> row{{-3, 0, 0}, {0, 0, 0}, {3, 0, 0}};
  const Shape cloud = Shape::point_cloud(row, 0.1);
  const auto work = [](const CollideResult& r) { return r.stats.node_tests + r.stats.primitive_tests; };
  for (const Shape* shape : {&small, &cloud}) {
    for (const bool is_first : {false, true}) {
      const Placed solid = surface.solid({}), other(*shape);
      const CollideResult met = is_first ? collide(other, solid) : collide(solid, other);
      ASSERT_TRUE(met.is_yes());
      EXPECT_LT(work(met), 2000U);
    }
  }
}

TEST(ShapeTruths, SmallestRadiiChangeNothingThatIsApart) {
  const Shape a = Shape::sphere(std::numeric_limits<double>::denorm_min()), b = Shape::sphere(0);
  EXPECT_TRUE(collide(a, b).is_yes());
  EXPECT_EQ(distance(a, {b, at({1, 0, 0})}).upper, 1);
  EXPECT_TRUE(collide(a, {b, at({0x1p-1030, 0, 0})}).is_no());
}

TEST(ShapeTruths, CapsulesAreApartBySegmentsLessTheirRadii) {
  Rng rng(2);
  for (int i = 0; i < 500; ++i) {
    const auto point = [&] { return i % 2 == 0 ? uniform_point(rng) : 0.5 * lattice_point(rng); };
    const Segment s{point(), point()}, t{point(), point()};
    const double r = 0.25 * std::floor(rng.uniform(0, 4)), q = 0.25 * std::floor(rng.uniform(0, 4));
    const Shape a = Shape::capsule(s.p0, s.p1, r), b = Shape::capsule(t.p0, t.p1, q);
    EXPECT_NEAR(distance(a, b).upper, std::max(0.0, closest_points(s, t).distance - r - q), 1e-14);
  }
}

TEST(ShapeTruths, BoxesAreSolid) {
  Rng rng(3);
  for (int i = 0; i < 500; ++i) {
    const Vec3 half = 0.01 * Vec3{1, 1, 1} + abs(uniform_point(rng)), p = uniform_point(rng, -2, 2);
    const double r = rng.uniform(0, 0.5), s = rng.uniform(0, 0.5);
    const Shape box = Shape::box(half, r), ball = Shape::sphere(s);
    const double expected = std::max(0.0, length(max(abs(p) - half, Vec3{})) - r - s);
    EXPECT_NEAR(distance(box, {ball, at(p)}).upper, expected, 1e-14);
    EXPECT_EQ(collide(box, {ball, at(p)}).is_yes(), expected == 0);
    EXPECT_EQ(collide({ball, at(p)}, box).is_yes(), expected == 0);
  }
}

TEST(ShapeTruths, HalfSpacesAreAsFarAsTheLowestVertex) {
  Rng rng(4);
  const Model model(scenes::ball(12, 9));
  for (int i = 0; i < 200; ++i) {
    const Vec3 normal = uniform_point(rng);
    const double offset = rng.uniform(-3, 3);
    const Transform pose = random_pose(rng, 2);
    const Shape below = Shape::half_space(normal, offset, 64);
    double lowest = 1e9;
    for (const Vec3& p : model.mesh().positions()) {
      lowest = std::min(lowest, dot(normal, pose(p)) / length(normal) - offset);
    }
    EXPECT_NEAR(distance({model, pose}, below).upper, std::max(0.0, lowest), 1e-12);
    EXPECT_EQ(collide({model, pose}, below).is_yes(), lowest <= 0);
  }
}

TEST(ShapeTruths, NestedSolidsCollideAndSurfacesDoNot) {
  const Model mesh(scenes::ball(12, 9));
  const ClosedSurface surface = ClosedSurface::create(mesh).value();
  const Shape small = Shape::box({0.1, 0.1, 0.1}), large = Shape::box({4, 4, 4}), point = Shape::sphere(0.01);
  const Shape above = Shape::half_space({0, 0, 1}, 5, 50), below = Shape::half_space({0, 0, 1}, -5, 50);
  EXPECT_TRUE(collide(mesh, small).is_no());
  EXPECT_TRUE(collide(surface.solid(), small).is_yes());
  EXPECT_TRUE(collide(small, surface.solid()).is_yes());
  EXPECT_TRUE(collide(mesh, large).is_yes());
  EXPECT_TRUE(collide(large, mesh).is_yes());
  EXPECT_TRUE(collide(surface.solid(), point).is_yes());
  EXPECT_TRUE(collide(mesh, point).is_no());
  EXPECT_TRUE(collide(mesh, above).is_yes());
  EXPECT_TRUE(collide(mesh, below).is_no());
  EXPECT_EQ(distance(mesh, below).upper, 4);
  EXPECT_EQ(distance(mesh, above).status, DistanceStatus::collision);
  const DistanceResult found = distance(large, mesh, {.max_distance = 0.5});
  EXPECT_EQ(found.status, DistanceStatus::collision);
  EXPECT_EQ(found.witness->point_a, found.witness->point_b);
  EXPECT_TRUE(within(large, mesh, 0.5).is_yes());
}

TEST(ShapeTruths, PartsInsideOfASolidAreFound) {
  Rng rng(13);
  for (int i = 0; i < 300; ++i) {
    std::vector<Vec3> points;
    for (std::uint64_t k = 2 + rng.below(i % 2 == 0 ? 4 : 200); k > 0; --k) points.push_back(uniform_point(rng));
    const Vec3 half = 0.01 * Vec3{1, 1, 1} + 0.2 * abs(uniform_point(rng));
    const Vec3 at_box = i % 3 == 0 ? uniform_point(rng) : points.back();
    const Shape cloud = Shape::point_cloud(points, 0), box = Shape::box(half);
    const bool is_in = std::any_of(points.begin(), points.end(), [&](const Vec3& p) {
      const Vec3 d = abs(p - at_box);
      return d.x <= half.x && d.y <= half.y && d.z <= half.z;
    });
    EXPECT_EQ(collide(cloud, {box, at(at_box)}).is_yes(), is_in);
  }
}

TEST(ShapeTruths, CavitiesAreOutside) {
  const Mesh outer = scenes::ball(12, 9);
  const Model shell(joined(outer, turned_inside_out(mapped(outer, [](const Vec3& p) { return 0.5 * p; }))));
  const ClosedSurface surface = ClosedSurface::create(shell).value();
  const Shape ball = Shape::sphere(0.1);
  EXPECT_TRUE(collide(surface.solid(), ball).is_no());
  EXPECT_TRUE(collide(surface.solid(), {ball, at({0.75, 0, 0})}).is_yes());
}

TEST(ShapeTruths, FlushOverAFloorIsDecidedAlike) {
  const Model floor(scenes::grid(16, 16, -2, -2, 0.25, 0.25));
  Rng rng(8);
  QueryCache cache;
  for (int i = 0; i < 200; ++i) {
    const double r = i % 2 == 0 ? 0.25 : rng.uniform(0.1, 0.5), half = rng.uniform(0.1, 0.5);
    const Shape box = Shape::box({0.5, 0.5, half}, r);
    double height = half + r;
    for (std::uint64_t k = rng.below(5); k > 0; --k) height = std::nextafter(height, i % 4 < 2 ? 9 : 0);
    const Transform turned = i % 3 == 0 ? Transform{} : random_pose(rng, 2);
    const Placed a(floor, turned), b(box, turned * at({rng.uniform(-1, 1), rng.uniform(-1, 1), height}));
    for (const double error : {0.0, 0.1}) {
      SCOPED_TRACE(::testing::Message() << i << " with error " << error);
      const DistanceResult found = distance(a, b, {.relative_error = error, .absolute_error = error});
      const DistanceResult cached = distance(a, b, {.relative_error = error, .cache = &cache});
      const CollideResult meets = collide(a, b, {.cache = i % 2 == 0 ? &cache : nullptr});
      EXPECT_EQ(found.upper == 0, meets.is_yes());
      EXPECT_EQ(cached.upper == 0, meets.is_yes());
      EXPECT_EQ(truth_of(a, b).cores <= r, meets.is_yes());
      EXPECT_TRUE(within(a, b, found.upper, {.cache = &cache}).is_yes());
    }
  }
}

TEST(ShapeTruths, OneCacheServesAllRadii) {
  const Model body(scenes::ring(40, 12, 0.25));
  const Shape shape = Shape::capsule({-1, 0, 0}, {1, 0.5, 0}, 0.25);
  Rng rng(9);
  QueryCache cache;
  for (int i = 0; i < 300; ++i) {
    const Transform pose = i % 3 == 0 ? random_pose(rng, 2) : at({0, 0.001 * i, 1});
    const Placed core(shape.model(), pose), swept(shape, pose);
    EXPECT_EQ(distance(body, core, {.cache = &cache}).upper, distance(body, core).upper);
    EXPECT_EQ(distance(body, swept, {.cache = &cache}).upper, distance(body, swept).upper);
    EXPECT_EQ(collide(body, swept, {.cache = &cache}).answer, collide(body, swept).answer);
    EXPECT_EQ(collide(body, core, {.cache = &cache}).answer, collide(body, core).answer);
  }
}

TEST(ShapeTruths, ScenesFindTheClosestBodies) {
  Rng rng(10);
  for (int round = 0; round < 20; ++round) {
    std::vector<OwnedBody> bodies;
    for (std::uint64_t i = 0; i < 8; ++i) {
      const std::uint64_t kind = rng.below(body_kinds);
      bodies.push_back(random_body(rng, kind == 5 ? 0 : kind, false));
    }
    std::vector<Placed> placed;
    Scene scene;
    for (const OwnedBody& body : bodies) {
      placed.emplace_back(body.body(), random_pose(rng, 4));
      static_cast<void>(scene.add(placed.back()));
    }
    scene.commit();
    double least = 1e9;
    std::size_t meeting = 0;
    for (ObjectId b = 0; b < placed.size(); ++b) {
      const Box box = scene.bounding_box(b);
      for (ObjectId a = 0; a < b; ++a) {
        const double d = distance(placed[a], placed[b]).upper;
        least = std::min(least, d), meeting += d == 0 ? 1 : 0;
        bool is_candidate = false;
        scene.visit_candidate_pairs(d, [&](const ObjectPair& pair) {
          is_candidate = is_candidate || (pair.a == a && pair.b == b);
          return true;
        });
        EXPECT_TRUE(is_candidate);
      }
      for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(box.low[k], box.high[k]);
    }
    EXPECT_EQ(scene.closest_objects().result.upper, least);
    EXPECT_EQ(scene.any_within(0).result.is_yes(), meeting > 0);
    const std::vector<ObjectId> ids{3};
    const std::vector<Transform> poses{placed[3].pose, at({50, 0, 0})};
    std::vector<ClosestObjectsResult> results(2);
    scene.closest_objects_many(ids, poses, results);
    EXPECT_EQ(results[0].result.upper, least);
    double next_to = 1e9;
    for (ObjectId b = 1; b < placed.size(); ++b) next_to = std::min(next_to, distance(placed[0], placed[b]).upper);
    const auto others = [](ObjectId id) { return id != 0; };
    EXPECT_EQ(scene.closest_object(placed[0], {.filter = others}).result.upper, next_to);
  }
}

TEST(ShapeTruths, MovingSpheresTouchWhenFormulasSay) {
  Rng rng(11);
  std::uint64_t most_distances = 0;
  for (int i = 0; i < 60; ++i) {
    const Shape a = Shape::sphere(rng.uniform(0.1, 0.5)), b = Shape::sphere(rng.uniform(0.1, 0.5));
    const Vec3 p = uniform_point(rng, -2, 2), v = uniform_point(rng, -4, 4);
    const double r = a.radius() + b.radius();
    const RigidMotion still, moving(at(p), {scenes::random_rotation(rng), p + v});
    const PathImpact found = time_of_impact(a, still, b, moving);
    const double discriminant = dot(p, v) * dot(p, v) - dot(v, v) * (dot(p, p) - r * r);
    const double time = (-dot(p, v) - std::sqrt(std::max(0.0, discriminant))) / dot(v, v);
    const double closest = std::clamp(-dot(p, v) / dot(v, v), 0.0, 1.0);
    const double gap = std::max(0.0, length(p + closest * v) - r);
    const PathDistance least = min_distance(a, still, b, moving);
    EXPECT_LE(least.lower, gap + 1e-12);
    EXPECT_GE(least.upper, gap - 1e-12);
    EXPECT_LE(least.upper - least.lower, 1e-2);
    most_distances = std::max(most_distances, found.distance_count);
    if (length(p) <= r) {
      EXPECT_EQ(found.status, ImpactStatus::initial_contact);
    } else if (discriminant > 1e-3 && time > 0 && time < 1) {
      EXPECT_EQ(found.status, ImpactStatus::contact);
      EXPECT_NEAR(found.time, time, 1e-3);
    } else if (gap > 1e-3) {
      EXPECT_EQ(found.status, ImpactStatus::clear);
    }
  }
  EXPECT_LE(most_distances, 20U);  // the default error is a part of the radii
}

TEST(ShapeTruths, WhatBeginsInsideOfASolidIsInContact) {
  const Shape box = Shape::box({2, 2, 2}), ball = Shape::sphere(0.1);
  EXPECT_EQ(time_of_impact(box, RigidMotion{}, ball, RigidMotion{}).status, ImpactStatus::initial_contact);
  const RigidMotion inward(at({5, 0, 0}), at({0, 0, 0}));
  const PathImpact found = time_of_impact(box, RigidMotion{}, ball, inward);
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_NEAR(found.time, 2.9 / 5, 1e-5);
}

TEST(ShapeTruths, GradientsAreThoseOfTheDistanceLessTheRadii) {
  Rng rng(12);
  const Model body(scenes::ring(40, 12, 0.25));
  const Shape capsule = Shape::capsule({-1, 0, 0}, {1, 0.5, 0}, 0.25);
  for (int i = 0; i < 30; ++i) {
    const Transform pose = random_pose(rng, 1);
    const Transform far{pose.rotation, pose.translation + Vec3{0, 0, 3}};
    const Placed a(body), b(capsule, far);
    const TriangleContact contact = contact_of(a, b, *distance(a, b).witness);
    const PoseGradient gradient = pose_gradient_b(contact, far.translation);
    const Vec3 step = 1e-6 * uniform_point(rng), turn = 1e-6 * uniform_point(rng);
    const double angle = length(turn);
    const Transform small = transform_from_quaternion({}, 1, 0.5 * turn.x, 0.5 * turn.y, 0.5 * turn.z).value();
    const Transform moved{small.rotation * far.rotation, far.translation + step};
    const double change = distance(a, {capsule, moved}).upper - distance(a, b).upper;
    EXPECT_NEAR(change, dot(gradient.force, step) + dot(gradient.moment, turn), 1e-10) << angle;
  }
}

}  // namespace
}  // namespace limber::testing

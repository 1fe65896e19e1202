// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/penetration.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <vector>

#include "pair/budget_meter.h"
#include "penetration/sweep.h"
#include "scenes/scenes.h"
#include "support/random_solids.h"
#include "support/rational_geometry.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

SolidDistance signed_distance_of(const SolidModel& a, const SolidModel& b, const Transform& pose = {},
                                 const SolidDistanceOptions& options = {}) {
  return signed_distance({a.surface}, {b.surface, pose}, options);
}
Transform placed_at(const Vec3& place) { return {{}, place}; }

/// Whether the interval ends where it should, up to a part of the length.
void expect_depth(const SolidDistance& found, double depth, double part = 1e-11) {
  EXPECT_NEAR(-found.lower, depth, part * depth + 1e-10);
  EXPECT_NEAR(-found.upper, depth, part * depth + 1e-10);
  EXPECT_LE(found.lower, found.upper);
}

TEST(LastContact, IsThatOfRationalArithmetic) {
  constexpr double error = 0x1p-43;
  int meeting = 0, found = 0, narrow = 0;
  for (int kind = 0; kind < static_cast<int>(PairKind::count); ++kind) {
    Rng rng(4010);
    for (int i = 0; i < 150; ++i) {
      auto [a, b] = random_pair(rng, static_cast<PairKind>(kind));
      const double most = largest_coordinate(a, b);
      if (!(most > 0x1p-1000)) continue;
      const double scale = std::ldexp(1.0, -std::ilogb(most) - 1);
      for (Vec3* corner : {&a.v0, &a.v1, &a.v2, &b.v0, &b.v1, &b.v2}) *corner *= scale;
      penetration::LastContact contact = penetration::bound_last_contact(a, b, error);
      RationalSweep sweep({0, 0, 1});
      sweep.compare(a, b);
      SCOPED_TRACE(std::to_string(kind) + ", pair " + std::to_string(i));
      if (sweep.last()) {
        ++meeting;
        // If a is a third of the error higher, and b lower, they meet for longer by both.
        ASSERT_GE(Rational(contact.upper), *sweep.last() + Rational(error / 1.5));
      }
      if (contact.upper == penetration::LastContact::never) continue;
      find_last_contact(a, b, 2 * error, contact);
      if (contact.lower == penetration::LastContact::never) continue;
      ++found;
      narrow += contact.upper - contact.lower < 0x1p-36 ? 1 : 0;
      const Vec3 by{0, 0, contact.lower};
      ASSERT_LE(closest_points(a, Triangle{b.v0 + by, b.v1 + by, b.v2 + by}).distance, 4 * error);
    }
  }
  EXPECT_GT(meeting, 500);
  EXPECT_GE(found, meeting);
  EXPECT_GT(narrow, 0.95 * found);
}

TEST(Penetration, OfBoxesIsWhatTheirSidesSay) {
  const SolidModel box(box_mesh({0, 0, 0}, {1, 1, 1})), large(box_mesh({-4, -4, -4}, {4, 4, 4}));
  expect_depth(signed_distance_of(box, box, placed_at({0.875, 0.25, 0.5})), 0.125);
  expect_depth(signed_distance_of(box, box, placed_at({0.5, 0.25, -0.75})), 0.25);
  expect_depth(signed_distance_of(box, box), 1);
  const SolidDistance flush = signed_distance_of(box, box, placed_at({1, 0.5, 0}));
  expect_depth(flush, 0);
  EXPECT_TRUE(flush.upper == 0 && !std::signbit(flush.upper));
  expect_depth(signed_distance_of(box, box, placed_at({1, 1, 1})), 0);  // a corner at a corner
  expect_depth(signed_distance_of(large, box), 4);                      // inside without meeting
  expect_depth(signed_distance_of(box, large), 4);
  expect_depth(signed_distance_of(large, box, placed_at({3, 0, 0})), 1);  // inside, touching
  const SolidDistance apart = signed_distance_of(box, box, placed_at({1.5, 0, 0}));
  EXPECT_TRUE(apart.are_apart());
  EXPECT_EQ(apart.lower, 0.5);
  EXPECT_EQ(apart.upper, 0.5);
  EXPECT_EQ(apart.translation, Vec3{});
  ASSERT_TRUE(apart.witness);
  const SolidDistance in = signed_distance_of(large, box, placed_at({3.25, 0, 0}), {.relative_error = 0});
  EXPECT_NEAR(length(in.translation - Vec3{0.75, 0, 0}), 0, 1e-10);
  EXPECT_NEAR(in.deepest.of_b->depth, 0.75, 0);
  EXPECT_EQ(in.deepest.of_b->direction, (Vec3{1, 0, 0}));
  EXPECT_FALSE(in.deepest.of_a);
}

TEST(Penetration, InACavityLeadsBackIntoIt) {
  for (const bool is_inside_out : {false, true}) {
    const Mesh room = hollow_box({-4, -4, -4}, {4, 4, 4}, 1);
    const SolidModel walls(is_inside_out ? turned_inside_out(room) : room), box(box_mesh({-1, -1, -1}, {1, 1, 1}));
    EXPECT_EQ(signed_distance_of(walls, box).upper, 2);
    expect_depth(signed_distance_of(walls, box, placed_at({2.125, 0.5, 0})), 0.125);
    expect_depth(signed_distance_of(walls, box, placed_at({-2.125, 2.0625, 0})), std::hypot(0.125, 0.0625), 0.2);
    expect_depth(signed_distance_of(box, walls, placed_at({-2.125, 0.5, 0})), 0.125);
  }
}

TEST(Penetration, NextToAWallDoesNotFollowIt) {
  // A box in the corner of an L, flush with its wall, and 1/64 deep in its floor.
  const SolidModel l_shape(scenes::lathe({{0, -1}, {4, -1}, {4, 4}, {3, 4}, {3, 0}, {0, 0}}, 4)),
      box(box_mesh({0, 0, 0}, {1, 1, 1}));
  const double wall = 3 * std::sqrt(0.5);  // how far the sides are from the axis, turned by 45 degrees
  const Mat3 turned{{std::sqrt(0.5), std::sqrt(0.5), 0}, {-std::sqrt(0.5), std::sqrt(0.5), 0}, {0, 0, 1}};
  const double depth = 0x1p-6;
  const Vec3 place = transpose(turned) * Vec3{wall - 1, -0.5, -depth};
  const SeparatingTranslation up =
      separating_translation({l_shape.surface}, {box.surface, {transpose(turned), place}}, {0, 0, 1});
  EXPECT_NEAR(up.upper, 4 + depth, 1e-10);  // it slides along the wall
  const SolidDistance found =
      signed_distance({l_shape.surface}, {box.surface, {transpose(turned), place}}, {.relative_error = 0});
  expect_depth(found, depth, 1e-5);
}

TEST(SeparatingTranslation, OfBoxes) {
  const SolidModel box(box_mesh({0, 0, 0}, {1, 1, 1})), large(box_mesh({-4, -4, -4}, {4, 4, 4}));
  const auto along = [](const SolidModel& a, const SolidModel& b, const Vec3& place, const Vec3& d) {
    const SeparatingTranslation found = separating_translation({a.surface}, {b.surface, placed_at(place)}, d);
    EXPECT_NEAR(length(found.direction), 1, 1e-15);
    EXPECT_NEAR(found.lower, found.upper, 1e-11);
    EXPECT_LE(found.lower, found.upper);
    return found.upper;
  };
  EXPECT_NEAR(along(box, box, {0.75, 0.5, 0.5}, {1, 0, 0}), 0.25, 1e-11);
  EXPECT_NEAR(along(box, box, {0.75, 0.5, 0.5}, {-7, 0, 0}), 1.75, 1e-11);
  EXPECT_NEAR(along(box, box, {0.75, 0.5, 0.5}, {1, 1, 0}), 0.25 * std::sqrt(2), 1e-11);
  EXPECT_NEAR(along(large, box, {0, 0, 0}, {0, 0, 1}), 4, 1e-11);    // from inside
  EXPECT_NEAR(along(large, box, {0, 0, -9}, {0, 0, 1}), 13, 1e-11);  // through it
  EXPECT_EQ(along(large, box, {0, 0, 9}, {0, 0, 1}), 0);             // away from it
  EXPECT_EQ(along(large, box, {5, 5, 0}, {0, 0, 1}), 0);             // beside it
  EXPECT_NEAR(along(large, box, {4, 0, 0}, {0, 0, 1}), 4, 1e-11);    // along its side
  for (const double size : {0x1p-1074, 1e-200, 1e300, std::numeric_limits<double>::max()}) {
    EXPECT_NEAR(along(box, box, {0.75, 0.5, 0.5}, {size, size, 0}), 0.25 * std::sqrt(2), 1e-11) << size;
  }
  const SeparatingTranslation found =
      separating_translation({box.surface}, {box.surface, placed_at({0.75, 0.5, 0.5})}, {1, 0, 0});
  ASSERT_TRUE(found.witness);
  EXPECT_EQ(found.witness->point_a.x, 1);
  EXPECT_EQ(found.witness->point_b.x, 0.75);
}

TEST(Penetration, ComesNearerToTheTruthAsMeshesAreRefined) {
  double last_of_balls = 1, last_of_rings = 1;
  for (const std::uint32_t n : {8, 16, 32, 64}) {
    const SolidModel ball(scenes::ball(n, n / 2)), ring(scenes::ring(n, n, 0.25));
    // Two balls 0.3 deep in each other, off their poles; a ball 0.1 deep in the tube of a ring.
    const SolidDistance balls = signed_distance_of(ball, ball, placed_at(1.7 * Vec3{0.48, 0.6, 0.64}));
    const SolidModel small(scaled(scenes::ball(n, n / 2), 0.5));
    const SolidDistance rings = signed_distance_of(ring, small, placed_at({0.8, 0.6, 0.65}));
    EXPECT_LE(-balls.lower, 0.3 + 1e-12);
    const double of_balls = std::abs(balls.lower + 0.3), of_rings = std::abs(rings.lower + 0.1);
    EXPECT_LT(of_balls, last_of_balls) << n;
    EXPECT_LT(of_rings, last_of_rings) << n;
    last_of_balls = of_balls, last_of_rings = of_rings;
    EXPECT_LE(rings.deepest.max_depth, -rings.lower);
  }
  EXPECT_LT(last_of_balls, 0.01 * 0.3);
  EXPECT_LT(last_of_rings, 0.02 * 0.1);
}

TEST(Penetration, OfSolidsAtAnyScaleAndPlace) {
  const Mesh ball = scenes::ball(12, 8);
  for (const double scale : {0x1p-900, 1e-60, 1.0, 1e20, 0x1p190, 0x1p198}) {
    const SolidModel solid(scaled(ball, scale));
    const Transform pose{{}, scale * Vec3{1.5, 0.25, 0.5}};
    const SolidDistance found = signed_distance_of(solid, solid, pose);
    EXPECT_NEAR(found.lower / scale, -0.34, 0.06) << scale;
    EXPECT_LE(found.lower, found.upper);
    EXPECT_GT(found.deepest.max_depth, 0) << scale;
  }
  const SolidModel solid(ball);
  const Vec3 offset{0x1p30, -0x1p31, 0};
  const SolidDistance far =
      signed_distance({solid.surface, placed_at(offset)}, {solid.surface, placed_at(offset + Vec3{1.5, 0.25, 0.5})});
  const SolidDistance near = signed_distance_of(solid, solid, placed_at({1.5, 0.25, 0.5}));
  EXPECT_NEAR(far.lower, near.lower, 0.01 * -near.lower);
  EXPECT_LE(far.lower, far.upper);
}

TEST(Penetration, OfPointsAndSegmentsIsANumber) {
  const SolidModel point(tetrahedron({1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {1, 1, 1})), origin(tetrahedron({}, {}, {}, {}));
  const SolidModel segment(tetrahedron({0, 0, 0}, {2, 2, 2}, {2, 2, 2}, {0, 0, 0})),
      box(box_mesh({0, 0, 0}, {4, 4, 4}));
  expect_depth(signed_distance_of(point, point), 0);
  expect_depth(signed_distance_of(origin, origin), 0);
  expect_depth(signed_distance_of(segment, point), 0);
  expect_depth(signed_distance_of(box, point), 1);
  EXPECT_NEAR(signed_distance_of(box, segment).lower, -2, 1e-10);
  EXPECT_NEAR(signed_distance_of(point, segment, placed_at({1, 0, 0})).lower, std::sqrt(2.0 / 3), 1e-12);
}

TEST(DeepestVertices, OfDeformingModelsWithAMotionMargin) {
  Rng rng(4011);
  for (int i = 0; i < 24; ++i) {
    Model moving(scenes::ball(12, 8), {.motion_margin = i % 3 == 0 ? 0.0 : 0.3});
    const ClosedSurface surface = ClosedSurface::create(moving).value();
    const SolidModel ring(scenes::ring(12, 8, 0.4));
    for (int step = 0; step < 3; ++step) {
      deform(moving, [&](const Vec3& p) { return p + 0.1 * uniform_point(rng); });
      const Transform pose = random_pose(rng, 1);
      const DeepestVertices found = deepest_vertices({surface, pose}, {ring.surface});
      const auto of_a = deepest_by_loop(moving.mesh(), pose, ring.surface, {});
      const auto of_b = deepest_by_loop(ring.model.mesh(), {}, surface, pose);
      ASSERT_EQ(found.of_a.has_value(), of_a.has_value());
      ASSERT_EQ(found.of_b.has_value(), of_b.has_value());
      ASSERT_EQ(found.of_a ? found.of_a->vertex : no_id, of_a ? of_a->vertex : no_id);
      ASSERT_EQ(found.of_b ? found.of_b->vertex : no_id, of_b ? of_b->vertex : no_id);
      const SolidDistance both = signed_distance({surface, pose}, {ring.surface});
      const Transform away = placed_at(both.translation);
      ASSERT_TRUE(both.are_apart() || collide({moving, pose}, {ring.model, away}).is_no());
    }
  }
}

TEST(DeepestVertices, MayHaveLeftTheirBoundsByTheMotionMargin) {
  Model spiked(scenes::ball(24, 13), {.motion_margin = 1});
  const ClosedSurface surface = ClosedSurface::create(spiked).value();
  const SolidModel plate(box_mesh({1.25, -4, -4}, {4, 4, 4}));
  for (VertexId v = 1; v < spiked.mesh().positions().size(); v += 7) {
    const Vec3 home = spiked.mesh().positions()[v];
    spiked.move_vertices(std::vector<VertexId>{v}, std::vector<Vec3>{{1.75, 0, 0}}).value();
    if (home.x < 0.75) spiked.rebuild();  // otherwise the margin absorbs the move
    spiked.commit();
    const DeepestVertices found = deepest_vertices({surface}, {plate.surface});
    ASSERT_TRUE(found.of_a);
    EXPECT_EQ(found.of_a->vertex, v);
    EXPECT_EQ(found.of_a->depth, 0.5);
    EXPECT_NEAR(separating_translation({surface}, {plate.surface}, {1, 0, 0}).upper, 0.5, 1e-11);
    EXPECT_NEAR(signed_distance({surface}, {plate.surface}).upper, -0.5, 1e-11);
    spiked.move_vertices(std::vector<VertexId>{v}, std::vector<Vec3>{home}).value();
    spiked.commit();
  }
}

TEST(DeepestVertices, AreNotThoseThatNoTriangleUses) {
  std::vector<Vec3> positions = box_corners({0, 0, 0}, {1, 1, 1});
  positions.insert(positions.begin(), Vec3{0.5, 0.5, 2});
  const SolidModel box(small_mesh(positions, box_triangles(1))), large(box_mesh({-4, -4, 0.75}, {4, 4, 4}));
  const DeepestVertices found = deepest_vertices({box.surface}, {large.surface});
  ASSERT_TRUE(found.of_a);
  EXPECT_EQ(found.of_a->vertex, 5U);  // the first of four that are equally deep
  EXPECT_EQ(found.of_a->depth, 0.25);
  EXPECT_FALSE(found.of_b);
}

TEST(Penetration, HoldsWhenItsBudgetIsSpent) {
  const SolidModel ball(scenes::ball(24, 16)), ring(scenes::ring(24, 12, 0.3));
  const Transform pose{{}, {0.5, 0.3, 0.4}};
  const SolidDistance all = signed_distance({ball.surface}, {ring.surface, pose});
  const DeepestVertices deepest = deepest_vertices({ball.surface}, {ring.surface, pose});
  const SeparatingTranslation translation = separating_translation({ball.surface}, {ring.surface, pose}, {1, 2, 3});
  EXPECT_EQ(all.stopped_by, StoppedBy::nothing);
  for (const std::uint64_t steps : {0, 1, 2, 5, 10, 20, 50, 100, 200, 400, 1000, 100'000}) {
    const QueryBudget budget{.max_steps = steps};
    const DeepestVertices some = deepest_vertices({ball.surface}, {ring.surface, pose}, budget);
    EXPECT_GE(some.max_depth * (1 + 1e-12), deepest.max_depth);
    EXPECT_LE(some.max_depth, 2);
    for (const auto& vertex : {some.of_a, some.of_b}) EXPECT_LE(vertex ? vertex->depth : 0, deepest.max_depth);
    const SeparatingTranslation part = separating_translation({ball.surface}, {ring.surface, pose}, {1, 2, 3}, budget);
    EXPECT_GE(part.upper, translation.upper);
    EXPECT_LE(part.lower, translation.upper);
    const SolidDistance cut = signed_distance({ball.surface}, {ring.surface, pose}, {.budget = budget});
    EXPECT_LE(cut.lower, all.upper) << steps;
    EXPECT_GE(cut.upper, all.lower) << steps;
    EXPECT_TRUE(collide({ball.model}, {ring.model, {{}, pose.translation + cut.translation}}).is_no()) << steps;
    EXPECT_EQ(cut.stopped_by, steps < 100'000 ? StoppedBy::max_steps : StoppedBy::nothing) << steps;
  }
  const std::atomic<bool> cancelled{true};
  const SolidDistance none = signed_distance({ball.surface}, {ring.surface, pose}, {.budget = {.cancel = &cancelled}});
  EXPECT_EQ(none.stopped_by, StoppedBy::cancel);
  EXPECT_LE(none.lower, all.upper);
  EXPECT_GE(none.upper, all.upper);
  const QueryBudget late{.deadline = std::chrono::steady_clock::now() - std::chrono::seconds(1)};
  EXPECT_EQ(signed_distance({ball.surface}, {ring.surface, pose}, {.budget = late}).stopped_by, StoppedBy::deadline);
}

TEST(PenetrationMeter, IsSpentOnceAQueryBelowItWasStopped) {
  const QueryBudget budget{.deadline = std::chrono::steady_clock::now() + std::chrono::hours(1), .max_steps = 9};
  pair::Meter meter(budget);
  EXPECT_EQ(meter.limits_of_time().deadline, budget.deadline);
  EXPECT_EQ(meter.limits_of_time().max_steps, QueryBudget{}.max_steps);  // steps below do not count
  meter.stop(StoppedBy::nothing);
  EXPECT_FALSE(meter.is_spent());
  meter.stop(StoppedBy::deadline);
  meter.stop(StoppedBy::cancel);
  EXPECT_TRUE(meter.is_spent());
  EXPECT_EQ(meter.stopped_by(), StoppedBy::deadline);
}

TEST(Penetration, KeepsToItsStepsFromTheFirstDistanceOn) {
  const Mesh ball = scenes::ball(40, 20);
  std::vector<Vec3> farther = ball.positions();
  for (Vec3& p : farther) p *= 1.0001;
  const SolidModel inner(ball), outer(Mesh::create(std::move(farther), ball.triangles()).value());
  const auto work = [&](std::uint64_t steps) {
    return signed_distance_of(outer, inner, {}, {.budget = {.max_steps = steps}}).stats.node_tests;
  };
  EXPECT_LT(work(0), 100U);
  EXPECT_GT(work(1'000'000), 10'000U);
}

TEST(Penetration, EndsAtTheAskedError) {
  const SolidModel ball(scenes::ball(24, 16)), ring(scenes::ring(24, 12, 0.3));
  const Transform pose{{}, {0.5, 0.3, 0.4}};
  const SolidDistance rough = signed_distance({ball.surface}, {ring.surface, pose}, {.relative_error = 100});
  const SolidDistance fine = signed_distance({ball.surface}, {ring.surface, pose}, {.relative_error = 0});
  EXPECT_LE(rough.stats.node_tests, fine.stats.node_tests);
  EXPECT_LE(rough.lower, fine.lower);
  EXPECT_EQ(rough.upper, fine.upper);
}

TEST(Penetration, MisuseIsRefused) {
  constexpr double quiet_nan = std::numeric_limits<double>::quiet_NaN();
  SolidModel ball(scenes::ball(6, 4));
  const SolidModel box(box_mesh({0, 0, 0}, {1, 1, 1}));
  const Transform stretched{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {}};
  const ClosedSurface &a = ball.surface, &b = box.surface;
  const auto expect_refusal = [&](const Transform& pose) {
    EXPECT_THROW(static_cast<void>(deepest_vertices({a, pose}, {b})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(separating_translation({a, pose}, {b}, {1, 0, 0})), std::invalid_argument);
    EXPECT_THROW(static_cast<void>(signed_distance({a, pose}, {b})), std::invalid_argument);
  };
  expect_refusal(stretched);
  for (const Vec3& d : {Vec3{}, Vec3{quiet_nan, 0, 0}, Vec3{0, HUGE_VAL, 0}}) {
    EXPECT_THROW(static_cast<void>(separating_translation({a}, {b}, d)), std::invalid_argument);
  }
  for (const double error : {-1.0, quiet_nan, HUGE_VAL}) {
    EXPECT_THROW(static_cast<void>(signed_distance({a}, {b}, {.relative_error = error})), std::invalid_argument);
  }
  ball.model.move_vertices(std::vector<VertexId>{0}, std::vector<Vec3>{{0, 0, 3}}).value();
  expect_refusal({});
  ball.model.commit();
  EXPECT_NO_THROW(static_cast<void>(signed_distance({a}, {b})));
  ball.model.reset(scenes::ball(8, 5));
  expect_refusal({});
}

}  // namespace
}  // namespace limber::testing

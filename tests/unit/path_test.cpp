// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Rigid motions, conservative advancement and least distances along paths: known answers, and distances at many times
// of random motions.
#include "limber/path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/refusals.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

/// A plate and a wall in the plane z = 0.
Mesh plate_mesh() { return scenes::grid(3, 3, -2, -2, 4.0 / 3, 4.0 / 3); }
Mesh wall_mesh() { return scenes::grid(1, 1, -9, -9, 18, 18); }

Transform stay(double) { return {}; }

void expect_near(const Vec3& found, const Vec3& expected, double error) {
  EXPECT_NEAR(found.x, expected.x, error);
  EXPECT_NEAR(found.y, expected.y, error);
  EXPECT_NEAR(found.z, expected.z, error);
}

TEST(RigidMotion, BeginsAndEndsExactly) {
  Rng rng(3240);
  for (int i = 0; i < 2000; ++i) {
    const Transform start = random_pose(rng, 5), end = random_pose(rng, 5);
    const RigidMotion motion =
        i % 2 == 0 ? RigidMotion(start, end, uniform_point(rng)) : RigidMotion::screw(start, end);
    EXPECT_EQ(motion.at(0), start);
    EXPECT_EQ(motion.at(1), end);
    expect_near(motion.at(0x1p-53)({1, 2, 3}), start({1, 2, 3}), 1e-14);
    expect_near(motion.at(1 - 0x1p-53)({1, 2, 3}), end({1, 2, 3}), 1e-14);
  }
}

TEST(RigidMotion, TurnsAtConstantRateTheShorterWay) {
  const RigidMotion quarter({about_z(0.5), {}}, {about_z(0.5 + std::numbers::pi / 2), {4, 0, 0}}, {1, 0, 0});
  expect_near(quarter.at(0.5).rotation.row0, about_z(0.5 + std::numbers::pi / 4).row0, 1e-15);
  const Vec3 start = quarter.start()({1, 0, 0}), end = quarter.end()({1, 0, 0});
  expect_near(quarter.at(0.25)({1, 0, 0}), 0.75 * start + 0.25 * end, 1e-15);
  const RigidMotion back({about_z(3), {}}, {about_z(-3), {}});  // by 2 pi - 6, not by -6
  expect_near(back.at(0.5).rotation.row0, about_z(std::numbers::pi).row0, 1e-15);
  const RigidMotion half({}, {{{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}, {}});
  expect_near(abs(half.at(0.5).rotation.row0), {0, 1, 0}, 1e-15);
}

TEST(RigidMotion, ScrewsKeepTheirAxis) {
  // A quarter turn about the vertical line through (2, 1), with a lift of 3.
  const Vec3 foot{2, 1, 0};
  const Transform start{about_z(0.3), {5, -4, 7}};
  const Mat3 quarter = about_z(std::numbers::pi / 2);
  const Transform end{quarter * start.rotation, quarter * (start.translation - foot) + foot + Vec3{0, 0, 3}};
  const RigidMotion screw = RigidMotion::screw(start, end);
  for (const double t : {0.25, 0.5, 0.75}) {
    const Vec3 p = screw.at(t).translation - foot, from = start.translation - foot;
    EXPECT_NEAR(std::hypot(p.x, p.y), std::hypot(from.x, from.y), 1e-13);
    EXPECT_NEAR(p.z, 7 + 3 * t, 1e-13);
  }
  expect_near(screw.at(0.5)(screw.center()), {2, 1, 8.5}, 1e-13);
}

TEST(RigidMotion, IsNeverFasterThanItSays) {
  Rng rng(3241);
  double greatest_part = 0;
  for (int i = 0; i < 3000; ++i) {
    const RigidMotion motion(random_pose(rng, 2), random_pose(rng, 2), uniform_point(rng));
    const Vec3 p = motion.center() + 2 * uniform_point(rng);
    const double radius = length(p - motion.center());
    const double from = rng.uniform(), to = std::min(1.0, from + std::ldexp(1.0, -static_cast<int>(rng.below(20))));
    const double way = length(motion.at(to)(p) - motion.at(from)(p));
    EXPECT_LE(way, motion.speed(radius) * (to - from) + 1e-15);
    if (to - from > 1e-4) greatest_part = std::max(greatest_part, way / (motion.speed(radius) * (to - from)));
  }
  EXPECT_GT(greatest_part, 0.95);
}

/// A pose whose rotation is off by nearly as much as is_rigid() allows.
Transform hardly_rigid(Rng& rng) {
  const Transform pose = random_pose(rng, 1);
  Mat3 skew;
  for (Vec3* const row : {&skew.row0, &skew.row1, &skew.row2}) *row = uniform_point(rng);
  for (double size = 2e-9;; size *= 0.95) {
    const auto& [x, y, z] = pose.rotation;
    const Transform off{{x + size * skew.row0, y + size * skew.row1, z + size * skew.row2}, pose.translation};
    if (is_rigid(off)) return off;
  }
}

TEST(RigidMotion, DoesNotJumpWherePosesAreHardlyRigid) {
  Rng rng(3243);
  for (int i = 0; i < 2000; ++i) {
    const RigidMotion motion(hardly_rigid(rng), hardly_rigid(rng));
    for (int k = 0; k <= 8; ++k) EXPECT_TRUE(is_rigid(motion.at(k / 8.0)));
    const Vec3 p = 1e5 * uniform_point(rng);
    Vec3 before = motion.at(0)(p);
    for (int k = 1; k <= 20; ++k) {
      const Vec3 now = motion.at(k * 0x1p-40)(p);
      EXPECT_LE(length(now - before), motion.speed(length(p)) * 0x1p-40 + 1e-9);  // 1e-14 of 1e5
      before = now;
    }
  }
}

TEST(RigidMotion, AboutACenterFarAwayIsAsExactAsAboutANearOne) {
  const RigidMotion straight({{}, {-1, 0, 0}}, {{}, {1.5, 0, 0}}, {1e9, 2e9, 0});
  expect_near(straight.at(0.4)({0, 0, 0}), {0, 0, 0}, 1e-15);
  EXPECT_NEAR(straight.speed(0), 2.5, 1e-11);
  const RigidMotion screw = RigidMotion::screw({{}, {-1, 0, 0}}, {about_z(1e-7), {1, 0, 0}});
  EXPECT_GT(length(screw.center()), 1e7);
  double before = -1;
  for (int k = 1; k <= 1000; ++k) {
    const double now = screw.at(k / 1000.0).translation.x;
    EXPECT_NEAR(now - before, 0.002, 1e-14);
    before = now;
  }
  const Model wall(wall_mesh()), flat(scenes::grid(1, 1, -1, -1, 2, 2));
  const Mat3 upright{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  const RigidMotion passes({upright, {-1, 0, 0}}, {upright, {1.5, 0, 0}}, {1e9, 2e9, 1e9});
  const PathImpact found = time_of_impact(flat, passes, wall, RigidMotion({upright, {}}), {.distance_error = 1e-9});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_NEAR(found.time, 0.4, 1e-9);
}

TEST(PathImpact, OfPointsEnds) {
  const auto point_at = [](const Vec3& p) { return Model(Mesh::create({p}, {{0, 0, 0}}).value()); };
  const Model a = point_at({0, 0, 0}), b = point_at({1, 2, 0.3});
  const RigidMotion flies({{}, {-1, 0.3, 0}}, {{}, {3, 0.7, 0.1}});
  const PathDistance nearest = min_distance(a, flies, b, {});
  EXPECT_LE(nearest.distance_count, 300U);
  EXPECT_LE(nearest.upper - nearest.lower, 0x1p-10 * nearest.upper);
  EXPECT_EQ(time_of_impact(a, flies, b, {}).status, ImpactStatus::clear);
  const RigidMotion hits({{}, {-1, 2, 0.3}}, {{}, {2, 2, 0.3}});
  EXPECT_EQ(time_of_impact(a, hits, b, {}).status, ImpactStatus::contact);
}

TEST(PathImpact, OfABallThatFallsOnAPlate) {
  const Model ball(scenes::ball(24, 16)), plate(plate_mesh());
  // The poles of the ball are on the z axis, at a distance of 1.
  const RigidMotion falls({{}, {0.1, 0.2, 5}}, {{}, {0.1, 0.2, -3}});
  const PathImpact found = time_of_impact(ball, falls, plate, {});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_LE(found.time, 0.5);
  EXPECT_NEAR(found.time, 0.5, 1e-5);
  ASSERT_TRUE(found.witness);
  EXPECT_NEAR(length(found.witness->point_b - Vec3{0.1, 0.2, 0}), 0, 1e-5);
  EXPECT_LE(found.distance_count, 18U);
  const PathImpact apart = time_of_impact(ball, falls, plate, {}, {.min_separation = 1});
  EXPECT_NEAR(apart.time, 0.375, 1e-5);
  EXPECT_LE(apart.time, 0.375);
  EXPECT_EQ(time_of_impact(ball, falls, plate, {}, {.max_time = 0.49}).status, ImpactStatus::clear);
  const PathDistance nearest = min_distance(ball, falls, plate, {}, {.max_time = 0.25});
  EXPECT_NEAR(nearest.upper, 2, 1e-12);
  EXPECT_EQ(nearest.time, 0.25);
  EXPECT_LE(nearest.lower, 2);
  EXPECT_EQ(min_distance(ball, falls, plate, {}).upper, 0);
}

TEST(PathImpact, UsesWhatADistanceSaysOfTheTimeBeforeIt) {
  // Low over a plate, whose end it passes: each distance frees twice the time for which it lasts.
  const Model ball(scenes::ball(24, 16)), plate(plate_mesh());
  const RigidMotion passes({{}, {-2, 0, 1.05}}, {{}, {2, 0, 1.05}});
  const PathImpact found = time_of_impact(ball, passes, plate, {});
  EXPECT_EQ(found.status, ImpactStatus::clear);
  EXPECT_LE(found.distance_count, 60U);  // plain advancement: 4 / 0.05
}

TEST(PathImpact, AtTheStartIsSaidSo) {
  const Model ball(scenes::ball(8, 6));
  const PathImpact found = time_of_impact(ball, {}, ball, RigidMotion({}, {{}, {9, 0, 0}}));
  EXPECT_EQ(found.status, ImpactStatus::initial_contact);
  EXPECT_EQ(found.time, 0);
  const PathImpact still = time_of_impact(ball, {}, ball, Transform{{}, {3, 0, 0}});
  EXPECT_EQ(still.status, ImpactStatus::clear);
  EXPECT_EQ(still.distance_count, 1U);
}

TEST(PathImpact, DoesNotTunnel) {
  const Model ball(scaled(scenes::ball(8, 6), 0x1p-10)), plate(plate_mesh());
  const PathImpact found = time_of_impact(ball, {{{}, {0.1, 0.2, 1}}, {{}, {0.1, 0.2, -1e4}}}, plate, {});
  EXPECT_EQ(found.status, ImpactStatus::contact);
  EXPECT_LE(found.time, 1 / (1e4 + 1));
}

TEST(PathImpact, StopsWhenItsBudgetIsSpent) {
  const Model ball(scenes::ball(8, 6));
  const RigidMotion flies({{}, {9, 0.5, 0}}, {{}, {-9, 0.5, 0}});
  const std::atomic<bool> cancelled{true};
  const PathImpact none = time_of_impact(ball, flies, ball, {}, {.budget = {.max_steps = 0}});
  EXPECT_EQ(none.status, ImpactStatus::undecided);
  EXPECT_EQ(none.stopped_by, StoppedBy::max_steps);
  EXPECT_EQ(none.time, 0);
  const PathImpact one = time_of_impact(ball, flies, ball, {}, {.budget = {.max_steps = 1}});
  EXPECT_EQ(one.status, ImpactStatus::undecided);
  EXPECT_GT(one.time, 0.3);
  EXPECT_LT(one.time, 0.4);
  EXPECT_EQ(time_of_impact(ball, flies, ball, {}, {.budget = {.cancel = &cancelled}}).stopped_by, StoppedBy::cancel);
  const RigidMotion passes({{}, {9, 3, 0}}, {{}, {-9, 3, 0}});
  const PathDistance few = min_distance(ball, passes, ball, {}, {.budget = {.max_steps = 3}});
  EXPECT_EQ(few.stopped_by, StoppedBy::max_steps);
  EXPECT_EQ(few.distance_count, 3U);
  EXPECT_GT(min_distance(ball, passes, ball, {}).lower, few.lower);
}

TEST(PathDistance, IsBoundedWhereTheSecondDistanceIsCutShort) {
  const Model ball(scenes::ball(8, 6));
  for (const double max_time : {0.0, 1.0}) {
    std::atomic<bool> cancelled{false};
    int asked = 0;
    const auto raises_the_flag = [&](double) {
      cancelled = ++asked == 2;
      return Transform{{}, {9, 0, 0}};
    };
    const PathDistance cut = min_distance(ball, RigidPath{raises_the_flag, 1}, ball, RigidPath{stay},
                                          {.max_time = max_time, .budget = {.cancel = &cancelled}});
    EXPECT_EQ(cut.stopped_by, StoppedBy::cancel);
    EXPECT_EQ(cut.distance_count, 2U);
    EXPECT_LE(cut.lower, 7);
    EXPECT_GE(cut.upper, 7 - 1e-12);
  }
}

TEST(PathImpact, KeepsToItsDeadlineWhereEachDistanceIsAStep) {
  const Model a(scenes::grid(1, 1, -1, -1, 1, 1)), b(scenes::grid(1, 1, -1, -1, 9, 9));
  const auto slide = [](double t) { return Transform{{}, {t, 0, 1e-6}}; };
  const RigidPath slides{slide, 1}, stays{stay, 0};
  const std::atomic<bool> stop = true;
  for (const QueryBudget& budget : {QueryBudget{.deadline = std::chrono::steady_clock::now()},
                                    QueryBudget{.cancel = &stop}, QueryBudget{.abandon = &stop}}) {
    const PathImpact impact = time_of_impact(a, slides, b, stays, {.distance_error = 0, .budget = budget});
    EXPECT_EQ(impact.status, ImpactStatus::undecided);
    EXPECT_LE(impact.distance_count, 4U);
    const PathDistance nearest = min_distance(a, slides, b, stays, {.distance_error = 1e-8, .budget = budget});
    EXPECT_NE(nearest.stopped_by, StoppedBy::nothing);
    EXPECT_LE(nearest.distance_count, 4U);
  }
}

/// The least distance at many times, and the time before which it is never below a separation.
struct Sampled {
  double least = std::numeric_limits<double>::infinity(), first = least;

  Sampled(const Model& a, const RigidMotion& of_a, const Model& b, const RigidMotion& of_b, double separation) {
    constexpr int samples = 400;
    for (int i = 0; i <= samples; ++i) {
      const double time = static_cast<double>(i) / samples;
      const double d = distance({a, of_a.at(time)}, {b, of_b.at(time)}).upper;
      least = std::min(least, d);
      if (d <= separation) first = std::min(first, time);
    }
  }
};

TEST(PathImpact, IsNotLaterThanSampledContacts) {
  Rng rng(3242);
  int contacts = 0, clear = 0;
  std::uint64_t most = 0;
  for (int i = 0; i < 120 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const Model a(i % 3 == 0 ? scenes::ring(24, 8, 0.2) : scenes::ball(10, 8)), b(scenes::ring(24, 8, 0.3));
    const RigidMotion of_a(random_pose(rng, 4), random_pose(rng, 4), uniform_point(rng));
    const RigidMotion of_b =
        i % 2 == 0 ? RigidMotion(random_pose(rng, 4)) : RigidMotion::screw(random_pose(rng, 4), random_pose(rng, 4));
    const double separation = i % 4 < 2 ? 0 : 0.3 * rng.uniform();
    QueryCache cache;
    const PathOptions options{.min_separation = separation, .distance_error = 1e-3, .cache = &cache};
    const PathImpact found = time_of_impact(a, of_a, b, of_b, options);
    const Sampled truth(a, of_a, b, of_b, separation);
    EXPECT_LE(found.time, truth.first);
    if (found.status == ImpactStatus::clear) {
      ++clear;
    } else {
      ++contacts;
      EXPECT_LE(distance({a, of_a.at(found.time)}, {b, of_b.at(found.time)}).upper, separation + 1e-3 + 1e-12);
    }
    const PathDistance nearest = min_distance(a, of_a, b, of_b, options);
    EXPECT_LE(nearest.lower, truth.least + 1e-12);
    EXPECT_LE(nearest.lower, nearest.upper);
    EXPECT_LE(nearest.upper - nearest.lower, 1e-3);
    EXPECT_NEAR(distance({a, of_a.at(nearest.time)}, {b, of_b.at(nearest.time)}).upper, nearest.upper, 1e-3);
    most = std::max(most, found.distance_count);
  }
  EXPECT_GT(contacts, 15);
  EXPECT_GT(clear, 20);
  EXPECT_LT(most, 300U);
}

TEST(PathImpact, IsAsExactAsItGetsWithAnErrorOfZero) {
  const Model ball(scenes::ball(8, 6)), wall(wall_mesh());
  const RigidMotion falls({{}, {0.3, 0.4, 5}}, {about_z(1), {0.3, 0.4, 0}}), stands;
  const auto gap = [&](const PathOptions& options) {
    const PathImpact found = time_of_impact(ball, falls, wall, stands, options);
    return distance({ball, falls.at(found.time)}, {wall}).upper;
  };
  EXPECT_GT(gap({}), 1e-8);
  EXPECT_LT(gap({.distance_error = 0}), 1e-11);
  const auto width = [&](const PathOptions& options) {
    const PathDistance found = min_distance(ball, falls, wall, stands, options);
    return found.upper - found.lower;
  };
  EXPECT_GT(width({.max_time = 0.7}), 1e-4);
  EXPECT_LT(width({.max_time = 0.7, .distance_error = 0}), 1e-11);
}

TEST(PathImpact, OfAnyPathNeedsItsSpeedAlone) {
  const Model ball(scenes::ball(8, 6)), wall(wall_mesh());
  const RigidPath still{stay, 0};
  // Falls like a stone: z = 9 - 10 t^2, at most 20 fast.
  const auto fall = [](double t) { return Transform{{}, {0.3, 0.4, 9 - 10 * t * t}}; };
  const PathImpact fallen = time_of_impact(ball, RigidPath{fall, 20}, wall, still);
  EXPECT_EQ(fallen.status, ImpactStatus::contact);
  EXPECT_NEAR(fallen.time, std::sqrt(0.8), 1e-5);
  EXPECT_EQ(min_distance(ball, RigidPath{fall, 20}, wall, still).upper, 0);
  // Stands still at a distance of 0.2 for half of the time, then touches the wall at 0.7 and goes back.
  const auto bounce = [](double t) { return Transform{{}, {0.3, 0.4, 1 + std::min(0.2, std::abs(t - 0.7))}}; };
  const PathImpact bounced = time_of_impact(ball, RigidPath{bounce, 1}, wall, still);
  EXPECT_EQ(bounced.status, ImpactStatus::contact);
  EXPECT_NEAR(bounced.time, 0.7, 2e-5);
}

TEST(PathMisuse, IsRefused) {
  const Model ball(scenes::ball(8, 6));
  const Transform bad{{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), endless = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(is_refused([&] { RigidMotion(bad, {}); }, {"limber::RigidMotion", "rigid"}));
  EXPECT_TRUE(is_refused([&] { static_cast<void>(RigidMotion::screw({}, bad)); }, {"limber::RigidMotion", "rigid"}));
  EXPECT_TRUE(is_refused([&] { RigidMotion({}, {}, {nan, 0, 0}); }, {"center"}));
  for (const double time : {-0x1p-60, 1 + 0x1p-52, nan}) {
    EXPECT_TRUE(is_refused([&] { static_cast<void>(RigidMotion().at(time)); }, {"limber::RigidMotion::at", "time"}));
  }
  const auto refused = [&](const auto& path, const PathOptions& wrong, const std::string& what) {
    EXPECT_TRUE(is_refused([&] { static_cast<void>(time_of_impact(ball, path, ball, path, wrong)); },
                           {"limber::time_of_impact", what}));
    EXPECT_TRUE(is_refused([&] { static_cast<void>(min_distance(ball, path, ball, path, wrong)); },
                           {"limber::min_distance", what}));
  };
  const std::pair<const char*, PathOptions> options[] = {{"max_time", {.max_time = -1}},
                                                         {"max_time", {.max_time = nan}},
                                                         {"min_separation", {.min_separation = -1}},
                                                         {"min_separation", {.min_separation = endless}},
                                                         {"distance_error", {.distance_error = -1}},
                                                         {"distance_error", {.distance_error = nan}}};
  for (const auto& [what, o] : options) {
    refused(RigidMotion(), o, what);
  }
  refused(RigidPath{stay, std::numeric_limits<double>::max()}, {}, "speeds");
  for (const double speed : {-1.0, nan, endless}) refused(RigidPath{stay, speed}, {}, "speed");
}

}  // namespace
}  // namespace limber::testing

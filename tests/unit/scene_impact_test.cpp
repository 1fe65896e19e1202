// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The first impact of a body that moves through a scene: known answers, and distances to all objects at many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "limber/scene.h"
#include "limber/shapes.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A ball around the origin.
Mesh ball_of(double radius) {
  return mapped(scenes::ball(6, 4), [&](const Vec3& p) { return radius * p; });
}

Transform shifted(double x, double y = 0, double z = 0) { return {{}, {x, y, z}}; }

/// Distances to all objects at 40 times before the impact and at it, next to what the result promises.
void expect_first_impact(const limber::Scene& scene, const Body& body, const RigidMotion& motion,
                         const ObjectImpactOptions& options, double error) {
  const ObjectImpactResult found = scene.time_of_impact(body, motion, options);
  const auto& [status, time, witness, normal, distances, stopped_by, stats] = found.result;
  ASSERT_NE(status, ImpactStatus::undecided);
  ASSERT_EQ(stopped_by, StoppedBy::nothing);
  ASSERT_EQ(witness.has_value(), status != ImpactStatus::clear);
  ASSERT_EQ(found.object == no_id, status == ImpactStatus::clear);
  ASSERT_EQ(time == 0, status == ImpactStatus::initial_contact);
  ASSERT_EQ(std::isinf(time), status == ImpactStatus::clear);
  const double end = std::min(time, options.path.max_time);
  for (int i = 0; i < 40; ++i) {
    const Placed there(body, motion.at(end * i / 40));
    for (ObjectId id = 0; id < scene.id_bound() && status != ImpactStatus::initial_contact; ++id) {
      if (!scene.contains(id) || (options.filter && !(*options.filter)(id))) continue;
      ASSERT_GT(distance(there, scene.object(id)).upper, options.path.min_separation) << "object " << id;
    }
  }
  if (!witness) return;
  ASSERT_TRUE(!options.filter || (*options.filter)(found.object));
  const Placed there(body, motion.at(time));
  const DistanceResult at_impact = distance(there, scene.object(found.object));
  ASSERT_LE(at_impact.upper, options.path.min_separation + error);
  ASSERT_NEAR(length(normal), 1, 1e-12);
  if (at_impact.upper > 1e-4) {
    const Vec3 apart = witness->point_b - witness->point_a;
    ASSERT_NEAR(dot(normal, apart), length(apart), 1e-9);
  }
}

TEST(SceneImpact, NothingIsTouchedBefore) {
  Rng rng(9401);
  std::vector<Model> models;
  models.emplace_back(scenes::ball(8, 5));
  models.emplace_back(scenes::grid(3, 3, -1, -1, 0.6, 0.6));
  models.emplace_back(scenes::random_soup(rng, 9, 0.5));
  const auto is_even = [](ObjectId id) { return id % 2 == 0; };
  std::size_t clear = 0, contacts = 0;
  for (int i = 0; i < 150; ++i) {
    limber::Scene scene;
    const std::size_t objects = rng.below(i % 5 == 0 ? 120 : 15);
    for (std::size_t k = 0; k < objects; ++k) static_cast<void>(scene.add({models[k % 3], random_pose(rng, 4)}));
    if (objects > 4) scene.remove(3);
    scene.commit();
    const double size = rng.below(3) == 0 ? 0.01 : 1;
    const Model small(ball_of(size));
    const RigidMotion motion{random_pose(rng, 8), random_pose(rng, 8), size * uniform_point(rng)};  // in this order
    ObjectImpactOptions options{.path = {.max_time = rng.below(2) == 0 ? 1 : rng.uniform(), .distance_error = 1e-4}};
    if (rng.below(3) == 0) options.path.min_separation = rng.uniform();
    if (rng.below(3) == 0) options.filter = is_even;
    const Body body{rng.below(4) == 0 ? models[rng.below(3)] : small, rng.below(4) == 0 ? 0.3 : 0};
    expect_first_impact(scene, body, motion, options, 1e-4 * (1 + 1e-9));
    const bool is_clear = scene.time_of_impact(body, motion, options).object == no_id;
    (is_clear ? clear : contacts) += 1;
  }
  EXPECT_GT(clear, 30U);
  EXPECT_GT(contacts, 30U);
}

/// Balls of radius 0.4 in a row along x, each 1 from the next, whose ids do not rise along it.
struct Row {
  Model ball{scenes::ball(16, 8)};
  Shape round = Shape::sphere(0.4);
  limber::Scene scene;
  std::vector<ObjectId> ids;

  explicit Row(std::size_t count) : ids(count) {
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t place = i * 37 % count;
      ids[place] = scene.add({round, shifted(static_cast<double>(place))});
    }
    scene.commit();
  }
};

TEST(SceneImpact, OfARowTheFirstOneThatCounts) {
  const Row row(101);
  const Shape point = Shape::sphere(0.1);
  const RigidMotion along(shifted(-10), shifted(110));
  for (const std::size_t first : {0, 1, 50, 100}) {
    std::multiset<ObjectId> asked;
    const auto from_first = [&](ObjectId id) {
      asked.insert(id);
      return std::find(row.ids.begin(), row.ids.end(), id) - row.ids.begin() >= static_cast<std::ptrdiff_t>(first);
    };
    const auto [object, result] = row.scene.time_of_impact(point, along, {.filter = from_first});
    EXPECT_EQ(object, row.ids[first]);
    EXPECT_EQ(result.status, ImpactStatus::contact);
    EXPECT_NEAR(result.time, (10 + static_cast<double>(first) - 0.5) / 120, 1e-6);
    EXPECT_NEAR(result.normal.x, 1, 1e-6);
    for (const ObjectId id : asked) EXPECT_EQ(asked.count(id), 1U);
    EXPECT_LE(asked.size(), first + 5) << "the way ends at the impact";
  }
}

TEST(SceneImpact, WaysThatPassAndWaysThatTurn) {
  const Row row(20);
  const Shape bar = Shape::capsule({-1, 0, 0}, {1, 0, 0}, 0.1);
  const RigidMotion above(shifted(-5, 0, 0.6), shifted(30, 0, 0.6));
  EXPECT_EQ(row.scene.time_of_impact(bar, above).result.status, ImpactStatus::clear);
  EXPECT_EQ(row.scene.time_of_impact(bar, above, {.path = {.min_separation = 0.2}}).object, row.ids[0]);
  // A bar that turns a quarter about y on its way dips into the row.
  const Transform end{{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}}, {30, 0, 0.6}};
  const auto turned = row.scene.time_of_impact(bar, RigidMotion(shifted(-5, 0, 0.6), end));
  EXPECT_EQ(turned.result.status, ImpactStatus::contact);
  // A circle about the fourth ball, which it meets nowhere, next to its neighbors.
  const auto circle = [](double time) {
    return shifted(3 + 0.8 * std::cos(6 * time + 2), 0.8 * std::sin(6 * time + 2), 0);
  };
  const Shape point = Shape::sphere(0.1);
  const auto met = row.scene.time_of_impact(point, RigidPath{circle, 4.8});
  ASSERT_EQ(met.result.status, ImpactStatus::contact);
  EXPECT_EQ(met.object, row.ids[2]);  // at the angle of pi, less what the two radii of 0.5 span
  EXPECT_NEAR(length(circle(met.result.time).translation - Vec3{2, 0, 0}), 0.5, 1e-5);
}

TEST(SceneImpact, BodiesThatStandAndScenesWithoutObjects) {
  const Row row(3);
  const Shape point = Shape::sphere(0.1);
  const auto touching = row.scene.time_of_impact(point, RigidMotion(shifted(1.45)));
  EXPECT_EQ(touching.result.status, ImpactStatus::initial_contact);
  EXPECT_EQ(touching.result.time, 0);
  EXPECT_TRUE(touching.object == row.ids[1] || touching.object == row.ids[2]);
  EXPECT_EQ(row.scene.time_of_impact(point, RigidMotion(shifted(7))).result.status, ImpactStatus::clear);
  const RigidMotion into(shifted(5), shifted(0));
  EXPECT_EQ(row.scene.time_of_impact(point, into, {.path = {.max_time = 0}}).result.status, ImpactStatus::clear);
  EXPECT_EQ(row.scene.time_of_impact(point, into).object, row.ids[2]);
  const Model dot(Mesh::create({{0, 0, 0}}, {{0, 0, 0}}).value());  // without any size
  EXPECT_EQ(row.scene.time_of_impact(dot, into).object, row.ids[2]);
  limber::Scene empty;
  empty.commit();
  const auto nothing = empty.time_of_impact(point, into);
  EXPECT_EQ(nothing.object, no_id);
  EXPECT_EQ(nothing.result.status, ImpactStatus::clear);
  EXPECT_EQ(nothing.result.time, infinite);
}

TEST(SceneImpact, BudgetsThatEndLeaveWhatIsFree) {
  const Row row(50);
  const Body ball(row.ball);
  const RigidMotion slant(shifted(-10, 3, 0), shifted(49, 0.7, 0.3));
  const ObjectImpactResult whole = row.scene.time_of_impact(ball, slant);
  ASSERT_EQ(whole.result.status, ImpactStatus::contact);
  for (std::uint64_t steps = 0; steps < 100; ++steps) {
    const ObjectImpactResult part = row.scene.time_of_impact(ball, slant, {.path = {.budget = {.max_steps = steps}}});
    ASSERT_LE(part.result.time, whole.result.time + 1e-6);
    if (part.result.status == ImpactStatus::undecided) {
      EXPECT_EQ(part.result.stopped_by, StoppedBy::max_steps);
      EXPECT_EQ(part.object, no_id);
    } else {
      EXPECT_EQ(part.object, whole.object);
    }
    EXPECT_TRUE(steps > 5 || part.result.status == ImpactStatus::undecided) << steps;
    EXPECT_TRUE(steps < 80 || part.result.status == ImpactStatus::contact) << steps;
  }
  const auto past = std::chrono::steady_clock::now() - std::chrono::seconds(1);
  const ObjectImpactResult late = row.scene.time_of_impact(ball, slant, {.path = {.budget = {.deadline = past}}});
  EXPECT_EQ(late.result.status, ImpactStatus::undecided);
  EXPECT_EQ(late.result.stopped_by, StoppedBy::deadline);
  EXPECT_LT(late.result.time, whole.result.time);
  EXPECT_GT(late.result.time, 0) << "objects that are not near a part of the way are not touched there";
  std::atomic<bool> cancel = true;
  const ObjectImpactResult cancelled = row.scene.time_of_impact(ball, slant, {.path = {.budget = {.cancel = &cancel}}});
  EXPECT_EQ(cancelled.result.stopped_by, StoppedBy::cancel);
}

TEST(SceneImpact, RefusesWhatItCannotAnswer) {
  Row row(3);
  const Shape point = Shape::sphere(0.1);
  const RigidMotion into(shifted(5), shifted(0));
  const char* const name = "limber::Scene::time_of_impact: ";
  const auto is_refused_with = [&](const PathOptions& options, const std::string& why) {
    return is_refused([&] { static_cast<void>(row.scene.time_of_impact(point, into, {options})); }, {name, why});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_refused_with({.max_time = 1.5}, "max_time is not in [0, 1]"));
  EXPECT_TRUE(is_refused_with({.max_time = nan}, "max_time is not in [0, 1]"));
  EXPECT_TRUE(is_refused_with({.min_separation = -1}, "min_separation must be finite and at least 0"));
  EXPECT_TRUE(is_refused_with({.distance_error = nan}, "distance_error must be finite and at least 0"));
  QueryCache cache;
  EXPECT_TRUE(is_refused_with({.cache = &cache}, "takes no cache"));
  const auto skewed = [](double time) { return Transform{{{1 + time, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}; };
  EXPECT_TRUE(is_refused(
      [&] {
        static_cast<void>(row.scene.time_of_impact(point, RigidPath{skewed, 1}));
      },
      {name, "the pose of the model is not rigid: it scales by"}));
  const auto still = [](double) { return Transform{}; };
  EXPECT_TRUE(is_refused(
      [&] {
        static_cast<void>(row.scene.time_of_impact(point, RigidPath{still, -1}));
      },
      {name, "the speed of a path must be finite and at least 0"}));
  row.scene.set_pose(row.ids[0], shifted(9));
  EXPECT_TRUE(is_refused_with({}, "objects or models have changed since the last commit"));
}

}  // namespace
}  // namespace limber::testing

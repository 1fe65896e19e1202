// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// One placed model or moving body next to all objects of a scene, and contacts of pairs of objects.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "limber/shapes.h"
#include "reference/reference.h"
#include "support/keys.h"
#include "support/random_scene.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

std::vector<ObjectId> candidates_of(const limber::Scene& scene, const Placed& model, double margin) {
  std::vector<ObjectId> ids;
  const PairCount count = scene.visit_candidates(model, margin, [&](ObjectId id) { return ids.push_back(id), true; });
  EXPECT_TRUE(count.is_complete && count.count == ids.size());
  return ids;
}

TEST(SceneNearTest, FindsWhatIsCloseToAPlacedModel) {
  Rng rng(8401);
  for (int i = 0; i < 80; ++i) {
    const Heap heap(rng, rng.below(i < 60 ? 12 : 200), rng.below(2) == 0 ? 4 : 12);
    const Model model(rng.below(2) == 0 ? scenes::random_soup(rng, 5, 1) : scenes::ball(6, 4));
    const Placed placed{model, random_pose(rng, 4)};
    std::vector<double> distances(heap.scene.id_bound(), INFINITY);
    for (ObjectId id = 0; id < heap.scene.id_bound(); ++id) {
      if (!heap.scene.contains(id)) continue;
      const Placed& object = heap.scene.object(id);
      distances[id] = reference::distance({model.mesh(), placed.pose}, {object.model().mesh(), object.pose}).upper;
    }
    for (const double margin : {0.0, 0.5, 2.0, 1e300}) {
      std::vector<ObjectId> ids = candidates_of(heap.scene, placed, margin);
      std::sort(ids.begin(), ids.end());
      ASSERT_TRUE(std::adjacent_find(ids.begin(), ids.end()) == ids.end());
      for (ObjectId id = 0; id < heap.scene.id_bound(); ++id) {
        const bool is_found = std::binary_search(ids.begin(), ids.end(), id);
        ASSERT_TRUE(is_found || distances[id] > margin);
        ASSERT_TRUE(!is_found || heap.scene.contains(id));
        // Far beyond the margin, bounds tell.
        ASSERT_TRUE(!is_found || distances[id] < margin + 8);
      }
    }
    const auto is_even = [](ObjectId id) { return id % 2 == 0; };
    double closest = INFINITY, closest_even = INFINITY;
    for (ObjectId id = 0; id < distances.size(); ++id) {
      closest = std::min(closest, distances[id]);
      if (id % 2 == 0) closest_even = std::min(closest_even, distances[id]);
    }
    for (const bool has_filter : {false, true}) {
      const double truth = has_filter ? closest_even : closest;
      ClosestObjectOptions options;
      if (has_filter) options.filter = is_even;
      const auto [object, result] = heap.scene.closest_object(placed, options);
      ASSERT_EQ(object == no_id, std::isinf(truth));
      if (object == no_id) {
        ASSERT_EQ(result.status, DistanceStatus::beyond_limit);
        continue;
      }
      ASSERT_NEAR(result.upper, truth, 1e-13);
      ASSERT_NEAR(distances[object], truth, 1e-13);
      ASSERT_EQ(result.status, truth == 0 ? DistanceStatus::collision : DistanceStatus::exact);
      // The first point is of the model.
      const Triangle t = mapped(model.mesh().triangle(result.witness->triangle_a), placed.pose);
      ASSERT_LE(closest_points(result.witness->point_a, t).distance, 1e-13);
      if (truth == 0) continue;
      options.distance.max_distance = truth * 0.99;
      ASSERT_EQ(heap.scene.closest_object(placed, options).result.status, DistanceStatus::beyond_limit);
      options.distance.max_distance = truth * 1.01;
      ASSERT_EQ(heap.scene.closest_object(placed, options).object, object);
    }
  }
}

TEST(SceneNearTest, StopsWhenTheVisitorSaysSoAndWhenTimeIsUp) {
  Rng rng(8403);
  const Heap heap(rng, 300, 3);
  const Placed& placed = heap.scene.object(0);
  std::size_t calls = 0;
  const PairCount count = heap.scene.visit_candidates(placed, 1, [&](ObjectId) { return ++calls < 5; });
  EXPECT_TRUE(calls == 5 && count.count == 5 && !count.is_complete);
  const auto is_other = [](ObjectId other) { return other > 0; };
  const std::vector<ObjectId> all = candidates_of(heap.scene, placed, 1);
  const PairCount others = heap.scene.visit_candidates(placed, 1, is_other, is_other);
  EXPECT_TRUE(others.is_complete && others.count + 1 == all.size() && std::count(all.begin(), all.end(), 0U) == 1);
  const double truth = heap.scene.closest_object(placed, {.filter = is_other}).result.upper;
  const std::atomic<bool> cancel = true;
  const ClosestObjectResult cut =
      heap.scene.closest_object(placed, {.distance = {.budget = {.cancel = &cancel}}, .filter = is_other});
  EXPECT_TRUE(cut.result.lower <= truth && truth <= cut.result.upper && cut.object != no_id);
  EXPECT_EQ(cut.result.stopped_by, cut.result.upper > 0 ? StoppedBy::cancel : StoppedBy::nothing);
}

// --- contacts ---

TEST(SceneContactsTest, AreThoseOfTwoModelsOnAnyNumberOfThreads) {
  Rng rng(8404);
  const Heap heap(rng, 50, 4);
  std::vector<ObjectPair> pairs(2000);
  pairs.resize(heap.scene.candidate_pairs(0.1, pairs).count);
  pairs.insert(pairs.begin(), {1, 0});  // any order, and repeated
  pairs.push_back(pairs[1]);
  ASSERT_GT(pairs.size(), 50U);
  ObjectContacts found;
  for (const auto oriented : {std::optional<OrientedFaces>{}, std::optional(OrientedFaces::of_b)}) {
    std::vector<Contact> expected;
    std::vector<std::size_t> offsets{0};
    for (const auto& [a, b] : pairs) {
      visit_contacts(heap.scene.object(a), heap.scene.object(b), 0.1,
                     [&](const Contact& contact) { return expected.push_back(contact), true; },
                     {.oriented_faces = oriented});
      offsets.push_back(expected.size());
    }
    ASSERT_GT(expected.size(), 100U);
    const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 5);
    for (const int threads : {1, 2, 5}) {
      oneapi::tbb::task_arena(threads).execute([&] {
        heap.scene.contacts(pairs, 0.1, found, {.oriented_faces = oriented});
        ASSERT_EQ(found.offsets, offsets);
        ASSERT_EQ(found.contacts.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) ASSERT_EQ(key_of(found.contacts[i]), key_of(expected[i]));
      });
    }
  }
  std::size_t whole = 0;  // pairs before the first that takes more steps
  const PairOptions few{.budget = {.max_steps = 40}};
  const auto any = [](const Contact&) { return true; };
  for (const auto& [a, b] : pairs) {
    if (!visit_contacts(heap.scene.object(a), heap.scene.object(b), 0.1, any, few).is_complete) break;
    ++whole;
  }
  ASSERT_TRUE(whole > 8 && whole < pairs.size()) << whole;
  std::vector<std::size_t> of_first = found.offsets;
  of_first.resize(whole + 1);
  for (const int threads : {1, 5}) {
    oneapi::tbb::task_arena(threads).execute([&] { heap.scene.contacts(pairs, 0.1, found, {.budget = few.budget}); });
    EXPECT_EQ(found.offsets, of_first);
    EXPECT_EQ(found.contacts.size(), of_first.back());
  }
  heap.scene.contacts({}, 0.1, found);
  EXPECT_EQ(found.offsets, std::vector<std::size_t>{0});
  EXPECT_TRUE(found.contacts.empty());
}

// --- the first impact of a body that moves through a scene ---

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
  const auto is_even = [](ObjectId id) { return id % 2 == 0; };
  std::size_t clear = 0, contacts = 0;
  for (int i = 0; i < 150; ++i) {
    const Heap heap(rng, rng.below(i % 5 == 0 ? 120 : 15), 4);
    const double size = rng.below(3) == 0 ? 0.01 : 1;
    const Model small(ball_of(size));
    const RigidMotion motion{random_pose(rng, 8), random_pose(rng, 8), size * uniform_point(rng)};  // in this order
    ObjectImpactOptions options{.path = {.max_time = rng.below(2) == 0 ? 1 : rng.uniform(), .distance_error = 1e-4}};
    if (rng.below(3) == 0) options.path.min_separation = rng.uniform();
    if (rng.below(3) == 0) options.filter = is_even;
    const Body body{rng.below(4) == 0 ? heap.models[rng.below(3)] : small, rng.below(4) == 0 ? 0.3 : 0};
    expect_first_impact(heap.scene, body, motion, options, 1e-4 * (1 + 1e-9));
    const bool is_clear = heap.scene.time_of_impact(body, motion, options).object == no_id;
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
  const auto path_is_refused = [&](const RigidPath& path, const std::string& why) {
    return is_refused([&] { static_cast<void>(row.scene.time_of_impact(point, path)); }, {name, why});
  };
  const auto skewed = [](double time) { return Transform{{{1 + time, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}; };
  EXPECT_TRUE(path_is_refused({skewed, 1}, "the pose of the model is not rigid: it scales by"));
  const auto still = [](double) { return Transform{}; };
  EXPECT_TRUE(path_is_refused({still, -1}, "the speed of a path must be finite and at least 0"));
  row.scene.set_pose(row.ids[0], shifted(9));
  EXPECT_TRUE(is_refused_with({}, "objects or models have changed since the last commit"));
}

}  // namespace
}  // namespace limber::testing

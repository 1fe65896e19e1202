// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// One placed model next to all objects of a scene, and contacts of pairs of objects.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <vector>

#include "limber/scene.h"
#include "reference/reference.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

/// Models of three kinds, one id of which is free.
struct Heap {
  std::vector<Model> models;
  limber::Scene scene;

  Heap(Rng& rng, std::size_t objects, double range) {
    models.emplace_back(scenes::ball(8, 5));
    models.emplace_back(scenes::grid(3, 3, -1, -1, 0.6, 0.6));
    models.emplace_back(scenes::random_soup(rng, 9, 0.5));
    for (std::size_t i = 0; i < objects; ++i) static_cast<void>(scene.add({models[i % 3], random_pose(rng, range)}));
    if (objects > 4) scene.remove(3);
    scene.commit();
  }
};

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
      const Triangle t = model.mesh().triangle(result.witness->triangle_a);
      const Transform& pose = placed.pose;
      ASSERT_LE(closest_points(result.witness->point_a, Triangle{pose(t.v0), pose(t.v1), pose(t.v2)}).distance, 1e-13);
      if (truth == 0) continue;
      options.distance.max_distance = truth * 0.99;
      ASSERT_EQ(heap.scene.closest_object(placed, options).result.status, DistanceStatus::beyond_limit);
      options.distance.max_distance = truth * 1.01;
      ASSERT_EQ(heap.scene.closest_object(placed, options).object, object);
    }
  }
}

TEST(SceneNearTest, ServesObjectsOfTheSceneToo) {
  Rng rng(8402);
  const Heap heap(rng, 60, 8);
  ClosestObjectsResult closest;
  closest.result.upper = INFINITY;
  for (ObjectId id = 0; id < heap.scene.id_bound(); ++id) {
    if (!heap.scene.contains(id)) continue;
    const auto is_other = [&](ObjectId other) { return other != id; };
    EXPECT_EQ(heap.scene.closest_object(heap.scene.object(id)).result.upper, 0);  // it meets itself
    const ClosestObjectResult found = heap.scene.closest_object(heap.scene.object(id), {.filter = is_other});
    if (found.result.upper < closest.result.upper) closest = {{id, found.object}, found.result};
  }
  EXPECT_NEAR(closest.result.upper, heap.scene.closest_objects().result.upper, 1e-13);
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
        for (std::size_t i = 0; i < expected.size(); ++i) {
          const Contact &s = found.contacts[i], &t = expected[i];
          ASSERT_TRUE(s.triangle_a == t.triangle_a && s.triangle_b == t.triangle_b && s.distance == t.distance);
          ASSERT_TRUE(s.normal == t.normal && s.normal_side == t.normal_side && s.point_a == t.point_a);
        }
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

}  // namespace
}  // namespace limber::testing

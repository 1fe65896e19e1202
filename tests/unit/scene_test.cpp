// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/scene.h"

#include <gtest/gtest.h>

#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <cfenv>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "base/access.h"
#include "reference/place.h"
#include "scene/scene_impl.h"
#include "support/keys.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

bool is_before(const ObjectPair& s, const ObjectPair& t) { return s.a != t.a ? s.a < t.a : s.b < t.b; }

/// The candidate pairs in the order in which they are found.
std::vector<ObjectPair> pairs_of(const limber::Scene& scene, double margin,
                                 std::optional<ObjectPairFilter> filter = std::nullopt) {
  std::vector<ObjectPair> pairs;
  const auto add = [&](const ObjectPair& pair) {
    pairs.push_back(pair);
    return true;
  };
  const PairCount count = scene.visit_candidate_pairs(margin, add, filter);
  EXPECT_EQ(count.count, pairs.size());
  EXPECT_TRUE(count.is_complete);
  return pairs;
}

std::vector<ObjectPair> sorted(std::vector<ObjectPair> pairs) {
  std::sort(pairs.begin(), pairs.end(), is_before);
  return pairs;
}

Transform at(double x, double y = 0, double z = 0) { return {{}, {x, y, z}}; }

/// Balls of radius 1 at these places along x.
limber::Scene row_of(const Model& ball, const std::vector<double>& places) {
  limber::Scene scene;
  for (const double x : places) static_cast<void>(scene.add({ball, at(x)}));
  scene.commit();
  return scene;
}

TEST(SceneTest, FindsNothingWhereThereIsNothing) {
  const Model ball(scenes::ball(8, 5));
  limber::Scene scene;
  EXPECT_TRUE(scene.is_committed());
  for (const std::size_t size : {0U, 1U}) {
    EXPECT_EQ(scene.size(), size);
    EXPECT_TRUE(pairs_of(scene, 1e9).empty());
    const ClosestObjectsResult closest = scene.closest_objects();
    EXPECT_EQ(closest.result.status, DistanceStatus::beyond_limit);
    EXPECT_EQ(closest.objects, ObjectPair{});
    EXPECT_TRUE(std::isinf(closest.result.upper) && std::isinf(closest.result.lower));
    EXPECT_FALSE(closest.result.witness);
    static_cast<void>(scene.add({ball}));
    EXPECT_FALSE(scene.is_committed());
    scene.commit();
  }
}

TEST(SceneTest, PrunesBySpheresWhatBoxesDoNot) {
  const Model ball(scenes::ball(16, 8));
  limber::Scene scene;
  static_cast<void>(scene.add({ball}));
  static_cast<void>(scene.add({ball, at(1.7, 1.7, 1.7)}));  // boxes overlap at a corner
  scene.commit();
  EXPECT_TRUE(pairs_of(scene, 0.6).empty());
  EXPECT_EQ(pairs_of(scene, 1).size(), 1U);
  const Box a = scene.bounding_box(0), b = scene.bounding_box(1);
  EXPECT_GT(a.high.x, b.low.x);
}

TEST(SceneTest, WritesAsManyPairsAsThereIsRoomFor) {
  const Model ball(scenes::ball(16, 8));
  const limber::Scene scene = row_of(ball, {0, 0, 0, 0});
  std::vector<ObjectPair> some(4);
  const ObjectPair untouched{77, 78};
  some[3] = untouched;
  EXPECT_EQ(scene.candidate_pairs(0, std::span(some).first(3)).count, 6U);
  EXPECT_EQ(some[3], untouched);
  const std::vector<ObjectPair> all = pairs_of(scene, 0);
  EXPECT_TRUE(std::equal(some.begin(), some.begin() + 3, all.begin()));
  EXPECT_EQ(scene.candidate_pairs(0, {}).count, 6U);
}

TEST(SceneTest, StopsWhenTheVisitorSaysSo) {
  const Model ball(scenes::ball(6, 4));
  const limber::Scene scene = row_of(ball, std::vector<double>(2000, 1.0));
  std::size_t calls = 0;
  const PairCount count = scene.visit_candidate_pairs(0, [&](const ObjectPair&) { return ++calls < 10; });
  EXPECT_EQ(calls, 10U);
  EXPECT_EQ(count.count, 10U);
  EXPECT_FALSE(count.is_complete);
  // All two million of them otherwise.
  EXPECT_EQ(scene.candidate_pairs(0, {}).count, 1999U * 1000U);
}

TEST(SceneTest, LeavesOutWhatTheFilterDoesNotLetThrough) {
  const Model ball(scenes::ball(16, 8));
  const limber::Scene scene = row_of(ball, {0, 1, 2, 3, 4, 5});
  const auto same_parity = [](ObjectId a, ObjectId b) {
    EXPECT_LT(a, b);
    return a % 2 == b % 2;
  };
  EXPECT_EQ(sorted(pairs_of(scene, 0.1, same_parity)), (std::vector<ObjectPair>{{0, 2}, {1, 3}, {2, 4}, {3, 5}}));
  const auto none = [](ObjectId, ObjectId) { return false; };
  EXPECT_TRUE(pairs_of(scene, 0.1, none).empty());
  EXPECT_EQ(scene.closest_objects({.filter = none}).result.status, DistanceStatus::beyond_limit);
  const auto ends = [](ObjectId a, ObjectId b) { return a == 0 && b == 5; };
  const ClosestObjectsResult closest = scene.closest_objects({.filter = ends});
  EXPECT_EQ(closest.objects, (ObjectPair{0, 5}));
  EXPECT_NEAR(closest.result.upper, 3, 0.1);
}

// --- changes ---

TEST(SceneTest, GivesIdsThatStayAndUsesThemAgain) {
  const Model ball(scenes::ball(8, 5)), sheet(scenes::grid(2, 2, 0, 0, 1, 1));
  limber::Scene scene;
  for (ObjectId id = 0; id < 5; ++id) EXPECT_EQ(scene.add({ball, at(10.0 * id)}), id);
  scene.remove(1);
  scene.remove(3);
  EXPECT_EQ(scene.size(), 3U);
  EXPECT_EQ(scene.id_bound(), 5U);
  EXPECT_FALSE(scene.contains(1));
  EXPECT_TRUE(scene.contains(4));
  scene.commit();
  EXPECT_EQ(pairs_of(scene, 1e9).size(), 3U);
  EXPECT_EQ(scene.object(4).pose, at(40));
  EXPECT_EQ(&scene.object(4).model(), &ball);
  EXPECT_EQ(scene.add({sheet}), 3U);
  EXPECT_EQ(scene.add({sheet, at(5)}), 1U);
  EXPECT_EQ(scene.add({sheet}), 5U);
  scene.commit();
  EXPECT_EQ(&scene.object(3).model(), &sheet);
  EXPECT_EQ(pairs_of(scene, 1e9).size(), 15U);
  for (const ObjectId id : {0U, 1U, 2U, 3U, 4U, 5U}) scene.remove(id);
  scene.commit();
  EXPECT_TRUE(pairs_of(scene, 1e9).empty());
}

// FCL #386, #40, Drake PR #10184: a pose is set, the box of the body is not, and the broad phase culls by the old one.
TEST(SceneTest, FollowsPoses) {
  const Model ball(scenes::ball(16, 8));
  limber::Scene scene = row_of(ball, {0, 10, 20});
  EXPECT_TRUE(pairs_of(scene, 0).empty());
  scene.set_pose(2, at(1));
  EXPECT_FALSE(scene.is_committed());
  scene.commit();
  EXPECT_TRUE(scene.is_committed());
  EXPECT_EQ(pairs_of(scene, 0), (std::vector<ObjectPair>{{0, 2}}));
  const std::vector<ObjectId> ids{1, 2, 1};
  scene.set_poses(ids, std::vector<Transform>{at(0), at(50), at(51)});  // the last one counts
  scene.commit();
  EXPECT_EQ(pairs_of(scene, 0), (std::vector<ObjectPair>{{1, 2}}));
  EXPECT_NEAR(scene.bounding_box(1).low.x, 50, 1e-4);
}

// FCL #577: a body stretches, and the broad phase keeps its old box. PhysX #530: a mesh that was modified must be set
// on its shape again.
TEST(SceneTest, FollowsModelsThatAreCommittedRebuiltAndReset) {
  const Model ball(scenes::ball(8, 5));
  Model other(scenes::ball(8, 5), {.motion_margin = 0.5});
  limber::Scene scene;
  static_cast<void>(scene.add({ball}));
  static_cast<void>(scene.add({other, at(10)}));
  scene.commit();
  EXPECT_TRUE(pairs_of(scene, 0).empty());
  SceneCache cache;
  const auto move = [&](const Vec3& to) {
    const std::vector<VertexId> ids{3};
    other.move_vertices(ids, std::vector<Vec3>{to}).value();
    other.commit();
  };
  // A vertex comes close; by a step so small that nothing but the state of the model shows it; then it is home again.
  for (int step = 0; step < 4; ++step) {
    if (step < 2) move({-9.5, 0, step * 0x1p-600});
    if (step == 2) other.rebuild();
    if (step == 3) other.reset(scenes::ball(8, 5));
    EXPECT_FALSE(scene.is_committed());
    EXPECT_THROW(pairs_of(scene, 0), std::invalid_argument);
    scene.commit();
    EXPECT_TRUE(scene.is_committed());
    EXPECT_EQ(pairs_of(scene, 0).size(), step < 3 ? 1U : 0U);
    EXPECT_EQ(scene.closest_objects({.cache = &cache}).result.upper, scene.closest_objects().result.upper);
  }
  // Another motion margin makes other bounds.
  other.set_motion_margin(2);
  move({-1.5, 0, 0});
  scene.commit();
  EXPECT_LE(scene.bounding_box(1).low.x, 8.5);
}

// --- queries of pairs ---

/// Models of several kinds in a box.
struct Crowd {
  std::vector<Model> models;
  limber::Scene scene;
  std::vector<ObjectPair> pairs;

  explicit Crowd(Rng& rng, std::size_t count = 120) {
    models.emplace_back(scenes::ball(12, 7));
    models.emplace_back(scenes::grid(6, 6, -1, -1, 0.3, 0.3));
    models.emplace_back(scenes::random_soup(rng, 60, 0.3));
    for (std::size_t i = 0; i < count; ++i) static_cast<void>(scene.add({models[i % 3], random_pose(rng, 5)}));
    scene.commit();
    pairs = pairs_of(scene, 0.2);
  }
};

TEST(SceneTest, AnswersAsTwoModelsDoOnAnyNumberOfThreads) {
  Rng rng(8201);
  const Crowd crowd(rng);
  ASSERT_GT(crowd.pairs.size(), 100U);
  const DistanceOptions options{.relative_error = 0.01, .max_distance = 0.2};
  ClosestObjectsResult first_closest;
  std::vector<double> cached;
  for (const int threads : {1, 2, 5}) {
    std::vector<CollideResult> collisions(crowd.pairs.size()), withins(crowd.pairs.size());
    std::vector<DistanceResult> distances(crowd.pairs.size());
    oneapi::tbb::task_arena(threads).execute([&] {
      SceneCache cache(20);
      std::vector<double> uppers;
      for (int frame = 0; frame < 3; ++frame) {
        crowd.scene.distance(crowd.pairs, distances, {.cache = &cache});
        for (const DistanceResult& r : distances) uppers.push_back(r.upper), uppers.push_back(r.lower);
      }
      const auto apart = [&](ObjectId a, ObjectId b) { return (a + b) % 3 == 0 && b - a > 40; };
      const ClosestObjectsResult closest =
          crowd.scene.closest_objects({.distance = {.relative_error = 0.1}, .filter = apart});
      if (threads == 1) first_closest = closest, cached = uppers;
      ASSERT_EQ(uppers, cached);
      ASSERT_EQ(key_of(closest), key_of(first_closest));
      crowd.scene.collide(crowd.pairs, collisions);
      crowd.scene.within(crowd.pairs, 0.1, withins);
      crowd.scene.distance(crowd.pairs, distances, {.distance = options});
    });
    for (std::size_t i = 0; i < crowd.pairs.size(); ++i) {
      const Placed &a = crowd.scene.object(crowd.pairs[i].a), &b = crowd.scene.object(crowd.pairs[i].b);
      ASSERT_EQ(key_of(collisions[i]), key_of(collide(a, b)));
      ASSERT_EQ(key_of(withins[i]), key_of(within(a, b, 0.1)));
      ASSERT_EQ(key_of(distances[i]), key_of(distance(a, b, options)));
    }
  }
}

TEST(SceneTest, SharesModelsAndItselfWithManyThreads) {
  // One pair at a time: without tasks, so that the thread sanitizer can follow.
  Rng rng(8206);
  const Crowd crowd(rng, 30);
  const std::vector<ObjectPair> expected = pairs_of(crowd.scene, 0.2);
  const std::size_t asked = std::min<std::size_t>(crowd.pairs.size(), 20);
  std::vector<double> alone;
  for (std::size_t i = 0; i < asked; ++i) {
    alone.push_back(distance(crowd.scene.object(crowd.pairs[i].a), crowd.scene.object(crowd.pairs[i].b)).upper);
  }
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&] {
      SceneCache cache;
      EXPECT_EQ(pairs_of(crowd.scene, 0.2), expected);
      for (std::size_t i = 0; i < asked; ++i) {
        DistanceResult result;
        crowd.scene.distance(std::span(crowd.pairs).subspan(i, 1), std::span(&result, 1), {.cache = &cache});
        EXPECT_EQ(result.upper, alone[i]);
      }
      EXPECT_TRUE(crowd.scene.is_committed());
    });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(SceneTest, DoesNotDependOnTheRoundingModeOfTheCaller) {
  Rng rng(8207);
  Crowd crowd(rng, 60);
  std::vector<Transform> poses;
  for (int i = 0; i < 60; ++i) poses.push_back(random_pose(rng, 5));
  const auto answers_in = [&](int mode) {
    std::vector<double> answers;
    std::fesetround(mode);
    for (ObjectId id = 0; id < 60; ++id) crowd.scene.set_pose(id, poses[id]);
    crowd.scene.commit();
    for (const ObjectPair& pair : pairs_of(crowd.scene, 0.123456789))
      answers.insert(answers.end(), {1.0 * pair.a, 1.0 * pair.b});
    const auto are_apart = [&](ObjectId a, ObjectId b) { return b > a + 30; };
    answers.push_back(crowd.scene.closest_objects({.filter = are_apart}).result.upper);
    for (ObjectId id = 0; id < 60; ++id) answers.push_back(crowd.scene.bounding_box(id).low.y);
    EXPECT_EQ(std::fegetround(), mode);
    std::fesetround(FE_TONEAREST);
    return answers;
  };
  const std::vector<double> expected = answers_in(FE_TONEAREST);
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) EXPECT_EQ(answers_in(mode), expected);
}

// --- caches ---

TEST(SceneCacheTest, ChangesNoAnswer) {
  Rng rng(8204);
  Crowd crowd(rng, 60);
  for (const std::size_t max_pairs : {0U, 1U, 50U, 100'000U}) {
    SceneCache cache(max_pairs);
    for (int frame = 0; frame < 6; ++frame) {
      for (ObjectId id = 0; id < 60; ++id) {
        Transform pose = crowd.scene.object(id).pose;
        pose.translation += 0.05 * uniform_point(rng);
        crowd.scene.set_pose(id, pose);
      }
      crowd.scene.commit();
      std::vector<ObjectPair> pairs = pairs_of(crowd.scene, 0.2);
      pairs.push_back(pairs[3]);  // twice
      std::vector<DistanceResult> distances(pairs.size());
      std::vector<CollideResult> collisions(pairs.size()), withins(pairs.size());
      crowd.scene.distance(pairs, distances, {.cache = &cache});
      crowd.scene.collide(pairs, collisions, {.cache = &cache});
      crowd.scene.within(pairs, 0.1, withins, {.cache = &cache});
      for (std::size_t i = 0; i < pairs.size(); ++i) {
        const Placed &a = crowd.scene.object(pairs[i].a), &b = crowd.scene.object(pairs[i].b);
        ASSERT_NEAR(distances[i].upper, distance(a, b).upper, 1e-13);
        ASSERT_EQ(collisions[i].is_yes(), distances[i].upper == 0);
        ASSERT_EQ(withins[i].is_yes(), within(a, b, 0.1).is_yes());
      }
      if (frame == 4) cache.clear();
    }
  }
}

TEST(SceneCacheTest, GivesEachPairACacheOfItsOwnAsLongAsThereAreAny) {
  using Pairs = std::vector<ObjectPair>;
  SceneCache cache(3);
  const auto caches_of = [&](const Pairs& pairs) {
    const auto caches = Access::impl(cache).caches_of(pairs);
    return std::vector<QueryCache*>(caches.begin(), caches.end());
  };
  EXPECT_TRUE(caches_of({}).empty());
  const auto first = caches_of({{0, 1}, {0, 2}, {0, 1}, {1, 2}, {2, 1}});
  EXPECT_TRUE(first[0] != nullptr && first[1] != nullptr && first[3] != nullptr);
  EXPECT_TRUE(first[0] != first[1] && first[1] != first[3] && first[3] != first[0]);
  EXPECT_EQ(first[2], nullptr);  // the first pair has it
  EXPECT_EQ(first[4], nullptr);  // all are taken
  // A pair keeps its cache, wherever it is in the list and whoever else comes.
  const auto second = caches_of({{5, 6}, {1, 2}, {1, 2}});
  EXPECT_EQ(second[2], nullptr);
  EXPECT_NE(second[0], nullptr);
  EXPECT_NE(second[0], second[1]);
  EXPECT_NE(second[1], nullptr);
  // Those that have not been asked about for longest lose theirs first.
  const auto third = caches_of({{7, 8}, {1, 2}, {5, 6}});
  EXPECT_EQ(third[1], second[1]);
  EXPECT_EQ(third[2], second[0]);
  EXPECT_TRUE(third[0] != nullptr && third[0] != third[1] && third[0] != third[2]);
  cache.clear();
  EXPECT_NE(caches_of({{1, 2}})[0], nullptr);
}

TEST(SceneCacheTest, SavesWorkForThePairsItHolds) {
  Rng rng(8205);
  const Crowd crowd(rng, 60);
  const auto tests_of = [&](SceneCache* cache) {
    std::vector<DistanceResult> results(crowd.pairs.size());
    crowd.scene.distance(crowd.pairs, results, {.cache = cache});
    std::uint64_t tests = 0;
    for (const DistanceResult& r : results) tests += r.stats.node_tests;
    return tests;
  };
  SceneCache all(crowd.pairs.size()), half(crowd.pairs.size() / 2), none(0);
  const std::uint64_t cold = tests_of(nullptr);
  for (SceneCache* cache : {&all, &half, &none}) EXPECT_EQ(tests_of(cache), cold);
  const std::uint64_t with_all = tests_of(&all), with_half = tests_of(&half);
  EXPECT_EQ(tests_of(&none), cold);
  EXPECT_LT(with_all, cold / 4);
  EXPECT_LT(with_half, cold - cold / 8);
  EXPECT_GT(with_half, with_all);
  SceneCache moved = std::move(all);
  EXPECT_LT(tests_of(&moved), cold / 4);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many configurations of a scene in one call, whether any two objects are within a distance, and which pairs count.
#include <gtest/gtest.h>

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "support/keys.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

using Clock = std::chrono::steady_clock;

/// Many configurations of some objects of a scene.
struct Plan : Heap {
  std::vector<ObjectId> ids;
  std::vector<Transform> poses;
  std::size_t count;

  Plan(Rng& rng, std::size_t objects, std::size_t moving, std::size_t configurations, double range)
      : Heap(rng, objects, range), count(configurations) {
    for (ObjectId id = 0; id < scene.id_bound() && ids.size() < moving; ++id) {
      if (scene.contains(id)) ids.push_back(id);
    }
    for (std::size_t i = 0; i < ids.size() * configurations; ++i) {
      // Many places are the same, and many poses tie.
      poses.push_back(rng.below(3) == 0 ? Transform{{}, 2 * lattice_point(rng, 3)} : random_pose(rng, range));
    }
  }
  std::span<const Transform> poses_of(std::size_t k) const {
    return std::span(poses).subspan(k * ids.size(), ids.size());
  }
};

// --- which pairs count ---

TEST(ObjectPairMatrixTest, HoldsABitForEachTwoIds) {
  Rng rng(8301);
  for (const std::size_t size : {0U, 1U, 2U, 3U, 12U, 65U, 130U}) {
    for (const bool counts : {false, true}) {
      ObjectPairMatrix matrix(size, counts);
      EXPECT_EQ(matrix.size(), size);
      std::vector<std::vector<bool>> expected(size, std::vector<bool>(size, counts));
      const auto set = [&](ObjectId a, ObjectId b, bool value) { expected[a][b] = expected[b][a] = value; };
      const auto some_ids = [&] {
        std::vector<ObjectId> ids(rng.below(5));
        for (ObjectId& id : ids) id = static_cast<ObjectId>(rng.below(size));
        return ids;
      };
      for (int i = 0; i < 40 && size > 1; ++i) {
        const auto a = static_cast<ObjectId>(rng.below(size)), b = static_cast<ObjectId>((a + 1) % size);
        const bool value = rng.below(2) == 0;
        const std::vector<ObjectId> ids_a = some_ids(), ids_b = some_ids();
        matrix.set(a, b, value), set(a, b, value);
        matrix.set_among(ids_a, !value);
        for (const ObjectId s : ids_a) {
          for (const ObjectId t : ids_a) set(s, t, !value);
        }
        matrix.set_between(ids_a, ids_b, value);
        for (const ObjectId s : ids_a) {
          for (const ObjectId t : ids_b) set(s, t, value);
        }
      }
      for (ObjectId a = 0; a < size; ++a) {
        for (ObjectId b = 0; b < size; ++b) {
          ASSERT_TRUE(a == b || matrix(a, b) == expected[a][b]) << a << ", " << b;
        }
      }
    }
  }
}

TEST(ObjectPairMatrixTest, KeepsWhatItKnowsWhereItsSizeChanges) {
  for (const std::size_t before : {0U, 1U, 2U, 11U, 12U, 13U, 40U}) {
    for (const std::size_t after : {0U, 1U, 3U, 11U, 12U, 14U, 50U}) {
      for (const bool counts : {false, true}) {
        ObjectPairMatrix matrix(before, !counts);
        if (before > 2) matrix.set(1, 2, counts);
        matrix.resize(after, counts);
        ASSERT_EQ(matrix.size(), after);
        for (ObjectId b = 1; b < after; ++b) {
          for (ObjectId a = 0; a < b; ++a) {
            const bool is_old = b < before && !(a == 1 && b == 2);
            EXPECT_EQ(matrix(a, b), is_old ? !counts : counts) << before << " to " << after << ": " << a << ", " << b;
          }
        }
        matrix.resize(after + 20, !counts);  // what lies behind a smaller size is forgotten
        if (after > 0) {
          EXPECT_EQ(matrix(0, static_cast<ObjectId>(after + 19)), !counts);
        }
      }
    }
  }
  EXPECT_THROW(ObjectPairMatrix(3).resize(std::size_t{1} << 33), std::invalid_argument);
}

TEST(ObjectPairMatrixTest, IsAFilter) {
  const Model ball(scenes::ball(8, 5));
  limber::Scene scene;
  for (const double x : {0.0, 1.0, 3.5, 7.0}) static_cast<void>(scene.add({ball, {{}, {x, 0, 0}}}));
  scene.commit();
  ObjectPairMatrix counts(scene.id_bound());
  counts.set(1, 0, false);
  EXPECT_EQ(scene.closest_objects({.filter = counts}).objects, (ObjectPair{1, 2}));
  EXPECT_FALSE(scene.any_within(0.1, {.filter = counts}).result.is_yes());
  EXPECT_TRUE(scene.any_within(0.1).result.is_yes());
  counts.set_among(std::vector<ObjectId>{0, 1, 2}, false);
  EXPECT_EQ(scene.closest_objects({.filter = counts}).objects, (ObjectPair{2, 3}));
  // A matrix for fewer objects says so instead of guessing.
  const ObjectPairMatrix small(3);
  EXPECT_THROW((void)scene.closest_objects({.filter = small}), std::invalid_argument);
}

// --- any pair within a distance ---

TEST(SceneConfigurationsTest, AskOnePairAfterTheOtherUntilOneIsWithinTheDistance) {
  Rng rng(8310);
  std::size_t late = 0;
  for (int i = 0; i < 40; ++i) {
    const Plan plan(rng, 60, 0, 0, 6);
    const auto filter = [&](ObjectId a, ObjectId b) { return (a * 7 + b * 3) % 5 == static_cast<ObjectId>(i % 5); };
    AnyWithinResult expected;
    expected.result.answer = Answer::no;
    std::size_t asked = 0;
    const auto ask = [&](const ObjectPair& pair) {
      const CollideResult r = within(plan.scene.object(pair.a), plan.scene.object(pair.b), 1e-3);
      expected.result.stats += r.stats;
      ++asked;
      if (!r.is_yes()) return true;
      expected.objects = pair, expected.result.answer = Answer::yes, expected.result.witness = r.witness;
      return false;
    };
    plan.scene.visit_candidate_pairs(1e-3, ask, filter);
    ASSERT_EQ(key_of(plan.scene.any_within(1e-3, {.filter = filter})), key_of(expected));
    late += expected.result.is_yes() && asked > 3 ? 1 : 0;
  }
  EXPECT_GT(late, 3U);
}

// --- many configurations ---

TEST(SceneConfigurationsTest, AnswerAsTheSceneWouldOnAnyNumberOfThreads) {
  Rng rng(8303);
  std::array<Plan, 9> plans{Plan(rng, 12, 12, 50, 4),  Plan(rng, 12, 5, 50, 4),    Plan(rng, 2, 2, 40, 3),
                            Plan(rng, 1, 1, 3, 3),     Plan(rng, 60, 20, 20, 9),   Plan(rng, 120, 7, 20, 5),
                            Plan(rng, 120, 7, 60, 12), Plan(rng, 300, 12, 30, 16), Plan(rng, 50, 1, 60, 12)};
  for (std::size_t i = 6; i < 8; ++i) {  // one is so far away that most others are in a few cells of the Hilbert order
    plans[i].scene.set_pose(plans[i].scene.id_bound() - 1, {{}, {2000, -2000, 2000}});
    plans[i].scene.commit();
  }
  for (const Plan& plan : plans) {
    const auto moves = [&](ObjectId id) { return std::find(plan.ids.begin(), plan.ids.end(), id) != plan.ids.end(); };
    enum class Filter { none, random, of_moving, of_moving_and_few };
    for (const Filter kind : {Filter::none, Filter::random, Filter::of_moving, Filter::of_moving_and_few}) {
      ObjectPairMatrix counts(plan.scene.id_bound(), false);
      for (ObjectId b = 0; b < counts.size(); ++b) {
        for (ObjectId a = 0; a < b; ++a) {
          const bool is_likely = kind == Filter::random || moves(a) || moves(b);
          const bool is_possible = is_likely || kind == Filter::of_moving_and_few;
          if (is_possible && rng.below(is_likely ? 2 : 100) == 0) counts.set(a, b, true);
        }
      }
      SceneDistanceOptions how;
      if (kind == Filter::random) how.distance = {.relative_error = 0.1, .max_distance = 1.5};
      SceneQueryOptions which;
      if (kind != Filter::none) how.filter = which.filter = counts;
      std::vector<ClosestObjectsResult> expected(plan.count), closest(plan.count);
      std::vector<AnyWithinResult> expected_any(plan.count), any(plan.count);
      Plan moved(rng, 0, 0, 0, 1);
      for (ObjectId id = 0; id < plan.scene.id_bound(); ++id) {
        static_cast<void>(moved.scene.add(plan.scene.contains(id) ? plan.scene.object(id) : Placed(plan.models[0])));
      }
      for (ObjectId id = 0; id < plan.scene.id_bound(); ++id) {
        if (!plan.scene.contains(id)) moved.scene.remove(id);
      }
      for (std::size_t k = 0; k < plan.count; ++k) {
        moved.scene.set_poses(plan.ids, plan.poses_of(k));
        moved.scene.commit();
        expected[k] = moved.scene.closest_objects(how);
        expected_any[k] = moved.scene.any_within(0.4, which);
      }
      const oneapi::tbb::global_control control(oneapi::tbb::global_control::max_allowed_parallelism, 5);
      for (const int threads : {1, 2, 5}) {
        oneapi::tbb::task_arena arena(threads);
        arena.execute([&] {
          plan.scene.closest_objects_many(plan.ids, plan.poses, closest, how);
          plan.scene.any_within_many(plan.ids, plan.poses, 0.4, any, which);
          for (std::size_t k = 0; k < plan.count; ++k) {
            ASSERT_EQ(key_of(closest[k]), key_of(expected[k])) << k;
            ASSERT_EQ(key_of(any[k]), key_of(expected_any[k])) << k;
          }
        });
      }
      EXPECT_TRUE(plan.scene.is_committed());
    }
  }
}

TEST(SceneConfigurationsTest, DoNotPayForPairsOfObjectsThatStay) {
  Rng rng(8311);
  const Plan plan(rng, 400, 2, 30, 12);
  for (const bool neighbors_count : {false, true}) {
    std::size_t calls = 0;
    const auto filter = [&](ObjectId a, ObjectId b) {
      ++calls;
      return a == plan.ids[0] || a == plan.ids[1] || b == plan.ids[1] || (neighbors_count && b == 399);
    };
    std::vector<ClosestObjectsResult> closest(plan.count);
    plan.scene.closest_objects_many(plan.ids, plan.poses, closest, {.filter = filter});
    // For those two with all others, and for few of the others; or for all 79 401, as the last object counts with each,
    // after at most all neighbors.
    EXPECT_LT(calls, neighbors_count ? 79'900U : 4'000U);
    EXPECT_GT(calls, neighbors_count ? 79'400U : 700U);
  }
}

TEST(SceneConfigurationsTest, MayHaveMorePairsThanCanWait) {
  Rng rng(8312);
  const Plan plan(rng, 4000, 1, 12, 50);
  limber::Scene scene;
  for (ObjectId id = 0; id < 4000; ++id) static_cast<void>(scene.add(plan.scene.object(id == 3 ? 4 : id)));
  scene.remove(3);  // as the other scene has
  const auto filter = [](ObjectId a, ObjectId b) { return a == 0 && b % 2 == 1; };
  std::vector<ClosestObjectsResult> closest(plan.count);
  plan.scene.closest_objects_many(plan.ids, plan.poses, closest, {.filter = filter});
  for (std::size_t k = 0; k < plan.count; ++k) {
    scene.set_poses(plan.ids, plan.poses_of(k));
    scene.commit();
    ASSERT_EQ(key_of(closest[k]), key_of(scene.closest_objects({.filter = filter}))) << k;
  }
}

TEST(SceneConfigurationsTest, MayBeNoneOrOfNoObject) {
  Rng rng(8304);
  const Plan plan(rng, 6, 3, 0, 4);
  plan.scene.closest_objects_many(plan.ids, {}, {});
  plan.scene.any_within_many(plan.ids, {}, 1, {});
  std::vector<ClosestObjectsResult> closest(3);
  plan.scene.closest_objects_many({}, {}, closest);  // the scene as it is
  for (const ClosestObjectsResult& c : closest) EXPECT_EQ(key_of(c), key_of(plan.scene.closest_objects()));
  const limber::Scene empty;
  std::vector<AnyWithinResult> any(3);
  empty.any_within_many({}, {}, 1, any);
  for (const AnyWithinResult& c : any) EXPECT_TRUE(c.result.is_no());
  empty.closest_objects_many({}, {}, closest);
  for (const ClosestObjectsResult& c : closest) EXPECT_EQ(c.result.status, DistanceStatus::beyond_limit);
}

TEST(SceneConfigurationsTest, LetTheLastPoseOfAnIdCount) {
  Rng rng(8305);
  const Plan plan(rng, 4, 0, 0, 50);
  const std::vector<ObjectId> ids{1, 0, 1};
  const std::vector<Transform> poses{{{}, {0, 0, 0}}, {{}, {0, 0, 0}}, {{}, {500, 0, 0}}};
  std::vector<ClosestObjectsResult> closest(1);
  ObjectPairMatrix counts(4, false);
  counts.set(0, 1, true);
  plan.scene.closest_objects_many(ids, poses, closest, {.filter = counts});
  EXPECT_GT(closest[0].result.upper, 400);
}

TEST(SceneConfigurationsTest, AskAFilterOnlyInTheCallingThread) {
  Rng rng(8306);
  const Plan plan(rng, 10, 10, 64, 3);
  const std::thread::id caller = std::this_thread::get_id();
  std::size_t calls = 0;
  const auto filter = [&](ObjectId a, ObjectId b) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    EXPECT_LT(a, b);
    EXPECT_TRUE(a != 3 && b != 3);  // which was removed
    return ++calls % 2 == 0;
  };
  std::vector<ClosestObjectsResult> closest(plan.count);
  plan.scene.closest_objects_many(plan.ids, plan.poses, closest, {.filter = filter});
  EXPECT_EQ(calls, 36U);
}

// --- budgets ---

TEST(SceneBudgets, LeaveConfigurationsOpenWhenTimeIsUp) {
  Rng rng(8307);
  const Plan plan(rng, 12, 12, 100, 30);
  std::vector<ClosestObjectsResult> closest(plan.count);
  std::vector<AnyWithinResult> any(plan.count);
  const std::atomic<bool> cancel = true;
  const std::pair<QueryBudget, StoppedBy> spent[] = {{{.deadline = Clock::now()}, StoppedBy::deadline},
                                                     {{.cancel = &cancel}, StoppedBy::cancel}};
  for (const auto& [budget, reason] : spent) {
    plan.scene.closest_objects_many(plan.ids, plan.poses, closest, {.distance = {.budget = budget}});
    plan.scene.any_within_many(plan.ids, plan.poses, 100, any, {.budget = budget});
    for (std::size_t k = 0; k < plan.count; ++k) {
      ASSERT_EQ(closest[k].result.status, DistanceStatus::interrupted);
      ASSERT_EQ(closest[k].result.stopped_by, reason);
      ASSERT_EQ(closest[k].result.lower, 0);
      ASSERT_EQ(closest[k].result.upper, INFINITY);
      ASSERT_TRUE(closest[k].objects == ObjectPair{} && !closest[k].result.witness);
      ASSERT_EQ(any[k].result.answer, Answer::undecided);
      ASSERT_EQ(any[k].result.stopped_by, reason);
    }
  }
  // Time enough changes no bit.
  std::vector<ClosestObjectsResult> all(plan.count);
  plan.scene.closest_objects_many(plan.ids, plan.poses, closest,
                                  {.distance = {.budget = {.deadline = Clock::now() + std::chrono::hours(1)}}});
  plan.scene.closest_objects_many(plan.ids, plan.poses, all);
  for (std::size_t k = 0; k < plan.count; ++k) ASSERT_NEAR(closest[k].result.upper, all[k].result.upper, 1e-13);
}

TEST(SceneBudgets, KeepIntervalsOfTheClosestObjectsTrue) {
  Rng rng(8308);
  std::size_t interrupted = 0;
  for (int i = 0; i < 40; ++i) {
    const Plan plan(rng, i % 2 == 0 ? 8 : 70, 1, 8, i % 2 == 0 ? 6 : 25);
    const double truth = plan.scene.closest_objects().result.upper;
    const std::atomic<bool> cancel = true;
    const QueryBudget budgets[] = {
        {.max_steps = 0}, {.max_steps = 1}, {.max_steps = 6}, {.deadline = Clock::now()}, {.cancel = &cancel}};
    for (const QueryBudget& budget : budgets) {
      const auto [objects, result] = plan.scene.closest_objects({.distance = {.budget = budget}});
      ASSERT_LE(result.lower, truth + 1e-13);
      ASSERT_GE(result.upper, truth - 1e-13);
      ASSERT_EQ(result.status == DistanceStatus::interrupted, result.stopped_by != StoppedBy::nothing);
      ASSERT_TRUE(result.status == DistanceStatus::interrupted || result.lower == result.upper);
      ASSERT_TRUE(result.witness.has_value() && objects.a != no_id);
      interrupted += result.status == DistanceStatus::interrupted ? 1 : 0;
      const AnyWithinResult any = plan.scene.any_within(truth * 1.01, {.budget = budget});
      ASSERT_FALSE(any.result.is_no());
      const AnyWithinResult none = plan.scene.any_within(truth * 0.99, {.budget = budget});
      ASSERT_TRUE(truth == 0 || !none.result.is_yes());
      ASSERT_EQ(none.result.answer == Answer::undecided, none.result.stopped_by != StoppedBy::nothing);
      // Steps are counted for each pair, so they give the same bits on any number of threads.
      if (budget.deadline || budget.cancel != nullptr) continue;
      std::vector<ClosestObjectsResult> closest(8), again(8);
      plan.scene.closest_objects_many(plan.ids, plan.poses, closest, {.distance = {.budget = budget}});
      oneapi::tbb::task_arena(5).execute(
          [&] { plan.scene.closest_objects_many(plan.ids, plan.poses, again, {.distance = {.budget = budget}}); });
      for (std::size_t k = 0; k < 8; ++k) ASSERT_EQ(key_of(closest[k]), key_of(again[k]));
    }
  }
  EXPECT_GT(interrupted, 80U);
}

TEST(SceneBudgets, EndSearchesWhereNoPairCounts) {
  Rng rng(8310);
  const Plan plan(rng, 200, 0, 0, 1);
  const std::atomic<bool> stop = true;
  for (const QueryBudget& budget :
       {QueryBudget{.deadline = Clock::now()}, QueryBudget{.cancel = &stop}, QueryBudget{.abandon = &stop}}) {
    std::size_t calls = 0;
    const auto none = [&](ObjectId, ObjectId) { return ++calls, false; };
    const auto [objects, result] = plan.scene.closest_objects({.distance = {.budget = budget}, .filter = none});
    EXPECT_EQ(result.status, DistanceStatus::interrupted);
    EXPECT_TRUE(objects == ObjectPair{} && !result.witness && result.lower == 0 && result.upper == INFINITY);
    const AnyWithinResult any = plan.scene.any_within(100, {.filter = none, .budget = budget});
    EXPECT_EQ(any.result.answer, Answer::undecided);
    EXPECT_LT(calls, 200U * 199 / 4);  // of both searches: of each there are as many as pairs
  }
}

TEST(SceneBudgets, EndQueriesOfPairs) {
  Rng rng(8309);
  const Plan plan(rng, 40, 0, 0, 4);
  std::vector<ObjectPair> pairs(1000);
  pairs.resize(plan.scene.candidate_pairs(0.2, pairs).count);
  ASSERT_GT(pairs.size(), 50U);
  std::vector<CollideResult> collisions(pairs.size()), withins(pairs.size());
  std::vector<DistanceResult> distances(pairs.size());
  const std::atomic<bool> cancel = true;
  plan.scene.collide(pairs, collisions, {.budget = {.cancel = &cancel}});
  plan.scene.within(pairs, 0.1, withins, {.budget = {.max_steps = 0}});
  plan.scene.distance(pairs, distances, {.distance = {.budget = {.max_steps = 0}}});
  std::size_t open = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Placed &a = plan.scene.object(pairs[i].a), &b = plan.scene.object(pairs[i].b);
    ASSERT_TRUE(collisions[i].answer == Answer::undecided || collisions[i].is_yes() == collide(a, b).is_yes());
    ASSERT_TRUE(withins[i].answer == Answer::undecided || withins[i].is_yes() == within(a, b, 0.1).is_yes());
    const double truth = distance(a, b).upper;
    ASSERT_TRUE(distances[i].lower <= truth + 1e-13 && truth <= distances[i].upper + 1e-13);
    open += distances[i].status == DistanceStatus::interrupted && withins[i].answer == Answer::undecided &&
            collisions[i].stopped_by == StoppedBy::cancel;
  }
  EXPECT_GT(open, pairs.size() / 2);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Mistakes in calls of scenes are refused with a text that names the function and the argument. They change nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "limber/scene.h"
#include "reference/reference.h"
#include "support/random_geometry.h"
#include "unit/refusals.h"

namespace limber::testing {
namespace {

/// Expects that a call is refused, naming the function and what is wrong.
template <typename Call>
void refused(const std::string& function, const std::string& what, const Call& call) {
  EXPECT_TRUE(is_refused(call, {"limber::" + function, what})) << function << ", " << what;
}

class SceneMisuse : public ::testing::Test {
 protected:
  SceneMisuse() {
    static_cast<void>(scene_.add({ball_}));
    static_cast<void>(scene_.add({ball_, {{}, {1, 0, 0}}}));
    static_cast<void>(scene_.add({ball_, {{}, {9, 0, 0}}}));
    scene_.remove(2);
    scene_.commit();
  }
  ~SceneMisuse() override {
    // Nothing has changed.
    EXPECT_TRUE(scene_.is_committed());
    EXPECT_EQ(scene_.size(), 2U);
    EXPECT_EQ(scene_.id_bound(), 3U);
    EXPECT_EQ(scene_.object(0).pose, Transform{});
    EXPECT_EQ(scene_.candidate_pairs(0, {}).count, 1U);
  }

  static constexpr double bad_numbers[] = {std::numeric_limits<double>::quiet_NaN(), -1, -0x1p-1074,
                                           -std::numeric_limits<double>::infinity()};
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  const Transform bad_pose_{{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  const std::vector<ObjectPair> pair_{{0, 1}};
  std::vector<CollideResult> answer_{1};
  std::vector<DistanceResult> distance_{1};
  Model ball_{scenes::ball(6, 4)};
  limber::Scene scene_;
};

TEST_F(SceneMisuse, OfIdsIsRefused) {
  for (const ObjectId bad : {ObjectId{2}, ObjectId{3}, no_id}) {
    refused("Scene::remove", "id", [&] { scene_.remove(bad); });
    refused("Scene::set_pose", "id", [&] { scene_.set_pose(bad, {}); });
    refused("Scene::object", "id", [&] { (void)scene_.object(bad); });
    refused("Scene::bounding_box", "id", [&] { (void)scene_.bounding_box(bad); });
    const std::vector<ObjectId> ids{0, bad};
    const std::vector<Transform> poses{{{}, {5, 5, 5}}, {}};
    refused("Scene::set_poses", "ids[1]", [&] { scene_.set_poses(ids, poses); });
    const std::vector<ObjectPair> pairs{{0, 1}, {0, bad}};
    std::vector<CollideResult> answers(2);
    std::vector<DistanceResult> distances(2);
    refused("Scene", "pairs[1]", [&] { scene_.collide(pairs, answers); });
    refused("Scene", "pairs[1]", [&] { scene_.within(pairs, 1, answers); });
    refused("Scene", "pairs[1]", [&] { scene_.distance(pairs, distances); });
    EXPECT_FALSE(answers[0].is_yes());
  }
}

TEST_F(SceneMisuse, OfPosesIsRefused) {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const Transform& pose : {bad_pose_, Transform{{}, {bad, 0, 0}}, Transform{{}, {0, 0x1p201, 0}}}) {
    refused("Scene::add", "pose", [&] { static_cast<void>(scene_.add({ball_, pose})); });
    refused("Scene::set_pose", "pose", [&] { scene_.set_pose(0, pose); });
    const std::vector<ObjectId> ids{0, 1};
    const std::vector<Transform> poses{{{}, {5, 5, 5}}, pose};
    refused("Scene::set_poses", "poses[1]", [&] { scene_.set_poses(ids, poses); });
    refused("Scene::set_poses", "as many poses", [&] { scene_.set_poses(ids, std::span(poses).first(1)); });
  }
}

TEST_F(SceneMisuse, OfModelsIsRefused) {
  Model moved(scenes::ball(6, 4));
  ASSERT_TRUE(static_cast<bool>(moved.move_all(moved.mesh().positions())));
  refused("Scene::add", "model", [&] { static_cast<void>(scene_.add({moved})); });
  Model gone(scenes::ball(6, 4));
  const Model other(std::move(gone));
  refused("Scene::add", "model", [&] { static_cast<void>(scene_.add({gone})); });
  // Models that are in the scene.
  ASSERT_TRUE(static_cast<bool>(ball_.move_all(ball_.mesh().positions())));
  EXPECT_FALSE(scene_.is_committed());
  refused("Scene::commit", "model", [&] { scene_.commit(); });
  refused("Scene::candidate_pairs", "commit", [&] { scene_.candidate_pairs(0, {}); });
  refused("Scene::closest_objects", "commit", [&] { (void)scene_.closest_objects(); });
  ball_.commit();
  scene_.commit();
  Model taken(std::move(ball_));
  EXPECT_FALSE(scene_.is_committed());
  refused("Scene::commit", "model", [&] { scene_.commit(); });
  refused("Scene::candidate_pairs", "commit", [&] { scene_.candidate_pairs(0, {}); });
  ball_ = std::move(taken);
  EXPECT_TRUE(scene_.is_committed());
}

TEST_F(SceneMisuse, OfNumbersIsRefused) {
  const auto visit = [](const ObjectPair&) { return true; };
  for (const double bad : bad_numbers) {
    refused("Scene::candidate_pairs", "margin", [&] { scene_.candidate_pairs(bad, {}); });
    refused("Scene::candidate_pairs", "margin", [&] { scene_.visit_candidate_pairs(bad, visit); });
    refused("within", "max_distance", [&] { scene_.within(pair_, bad, answer_); });
    refused("Scene::distance", "relative_error",
            [&] { scene_.distance(pair_, distance_, {.distance = {.relative_error = bad}}); });
    refused("Scene::closest_objects", "max_distance",
            [&] { (void)scene_.closest_objects({.distance = {.max_distance = bad}}); });
    EXPECT_THROW(reference::pairs_within({}, bad), std::invalid_argument);
  }
  refused("Scene::candidate_pairs", "margin", [&] { scene_.candidate_pairs(infinite, {}); });
}

TEST_F(SceneMisuse, OfConfigurationsIsRefused) {
  const std::vector<ObjectId> ids{0, 1};
  std::vector<Transform> poses(4);
  std::vector<ClosestObjectsResult> closest(2);
  std::vector<AnyWithinResult> any(2);
  const auto both_refuse = [&](const std::string& what) {
    refused("Scene::closest_objects_many", what, [&] { scene_.closest_objects_many(ids, poses, closest); });
    refused("Scene::any_within_many", what, [&] { scene_.any_within_many(ids, poses, 1, any); });
  };
  for (const std::size_t count : {0U, 3U, 5U, 6U}) {
    poses.assign(count, {});
    both_refuse("poses");
  }
  poses.assign(4, {});
  refused("Scene::any_within_many", "poses", [&] { scene_.any_within_many({}, poses, 1, any); });
  poses[3] = bad_pose_;
  both_refuse("poses[1][1]");
  poses[3] = {};
  for (const ObjectId bad : {ObjectId{2}, ObjectId{3}, no_id}) {
    const std::vector<ObjectId> bad_ids{0, bad};
    refused("Scene::any_within_many", "ids[1]", [&] { scene_.any_within_many(bad_ids, poses, 1, any); });
  }
  for (const double bad : bad_numbers) {
    refused("Scene::any_within", "max_distance", [&] { (void)scene_.any_within(bad); });
    refused("Scene::any_within_many", "max_distance", [&] { scene_.any_within_many(ids, poses, bad, any); });
    refused("Scene::closest_objects_many", "absolute_error",
            [&] { scene_.closest_objects_many(ids, poses, closest, {.distance = {.absolute_error = bad}}); });
  }
  refused("Scene::any_within", "max_distance", [&] { (void)scene_.any_within(infinite); });
  SceneCache cache;
  refused("Scene::closest_objects_many", "cache",
          [&] { scene_.closest_objects_many(ids, poses, closest, {.cache = &cache}); });
  refused("Scene::any_within_many", "cache", [&] { scene_.any_within_many(ids, poses, 1, any, {.cache = &cache}); });
  refused("Scene::any_within", "cache", [&] { (void)scene_.any_within(1, {.cache = &cache}); });
  QueryCache of_two;
  const DistanceOptions with_cache{.cache = &of_two};
  refused("Scene::closest_objects", "cache", [&] { (void)scene_.closest_objects({with_cache}); });
  refused("Scene::closest_object", "cache", [&] { (void)scene_.closest_object({ball_}, {with_cache}); });
  refused("Scene::distance", "cache", [&] { scene_.distance(pair_, distance_, {with_cache}); });
  const auto throws = [](ObjectId, ObjectId) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(scene_.any_within_many(ids, poses, 1, any, {.filter = throws}), std::runtime_error);
  const ObjectPairMatrix small(1);
  refused("ObjectPairMatrix", "id", [&] { scene_.any_within_many(ids, poses, 1, any, {.filter = small}); });
}

TEST_F(SceneMisuse, OfModelsNextToTheSceneIsRefused) {
  const auto visit = [](ObjectId) { return true; };
  refused("Scene::visit_candidates", "pose", [&] { scene_.visit_candidates({ball_, bad_pose_}, 0, visit); });
  refused("Scene::closest_object", "pose", [&] { (void)scene_.closest_object({ball_, bad_pose_}); });
  Model moved(scenes::ball(6, 4));
  ASSERT_TRUE(static_cast<bool>(moved.move_all(moved.mesh().positions())));
  refused("Scene::visit_candidates", "commit", [&] { scene_.visit_candidates({moved}, 0, visit); });
  refused("Scene::closest_object", "commit", [&] { (void)scene_.closest_object({moved}); });
  ObjectContacts found;
  for (const double bad : bad_numbers) {
    refused("Scene::visit_candidates", "margin", [&] { scene_.visit_candidates({ball_}, bad, visit); });
    refused("Scene::closest_object", "relative_error",
            [&] { (void)scene_.closest_object({ball_}, {.distance = {.relative_error = bad}}); });
    refused("Scene::contacts", "margin", [&] { scene_.contacts(pair_, bad, found); });
  }
  const std::vector<ObjectPair> bad_pair{{0, 2}};
  refused("Scene", "pairs[0]", [&] { scene_.contacts(bad_pair, 0, found); });
}

TEST_F(SceneMisuse, OfMatricesIsRefused) {
  ObjectPairMatrix counts(3);
  const std::vector<ObjectId> good{0, 1}, bad{0, 3};
  refused("ObjectPairMatrix::set", "same", [&] { counts.set(1, 1, false); });
  refused("ObjectPairMatrix::set", "size", [&] { counts.set(0, 3, false); });
  refused("ObjectPairMatrix::set_among", "size", [&] { counts.set_among(bad, false); });
  refused("ObjectPairMatrix::set_between", "size", [&] { counts.set_between(good, bad, false); });
  refused("ObjectPairMatrix", "size", [&] { (void)counts(3, 0); });
  EXPECT_TRUE(counts(0, 1) && counts(0, 2) && counts(1, 2));
  EXPECT_FALSE(counts(1, 1));
  ObjectPairMatrix taken(std::move(counts));
  refused("ObjectPairMatrix", "size", [&] { (void)counts(0, 1); });
  EXPECT_TRUE(taken(0, 1));
}

TEST_F(SceneMisuse, OfResultsIsRefused) {
  const std::vector<ObjectPair> pairs{{0, 1}, {1, 0}};
  refused("Scene", "results", [&] { scene_.collide(pairs, answer_); });
  refused("Scene", "results", [&] { scene_.within(pairs, 1, answer_); });
  refused("Scene", "results", [&] { scene_.distance(pairs, distance_); });
  const auto all = [](ObjectId, ObjectId) { return true; };
  refused("Scene", "filter", [&] { scene_.collide(pair_, answer_, {.filter = all}); });
  refused("Scene", "filter", [&] { scene_.distance(pair_, distance_, {.filter = all}); });
}

TEST_F(SceneMisuse, OfChangesThatAreNotCommittedIsRefused) {
  scene_.set_pose(0, {{}, {0.5, 0, 0}});
  refused("Scene::candidate_pairs", "commit", [&] { scene_.candidate_pairs(0, {}); });
  refused("Scene", "committed", [&] { scene_.collide(pair_, answer_); });
  refused("Scene::closest_objects", "commit", [&] { (void)scene_.closest_objects(); });
  refused("Scene::closest_object", "commit", [&] { (void)scene_.closest_object({ball_}); });
  refused("Scene::visit_candidates", "commit",
          [&] { scene_.visit_candidates({ball_}, 0, [](ObjectId) { return true; }); });
  refused("Scene::any_within", "commit", [&] { (void)scene_.any_within(1); });
  refused("Scene::any_within_many", "commit", [&] { scene_.any_within_many({}, {}, 1, {}); });
  ObjectContacts found;
  refused("Scene", "committed", [&] { scene_.contacts(pair_, 0, found); });
  refused("Scene::bounding_box", "commit", [&] { (void)scene_.bounding_box(0); });
  scene_.set_pose(0, {});
  scene_.commit();
}

TEST_F(SceneMisuse, OfASceneThatWasMovedFromIsRefused) {
  limber::Scene gone;
  const limber::Scene other = std::move(gone);
  refused("Scene::add", "moved from", [&] { static_cast<void>(gone.add({ball_})); });
  refused("Scene::commit", "moved from", [&] { gone.commit(); });
  refused("Scene::size", "moved from", [&] { (void)gone.size(); });
  refused("Scene::is_committed", "moved from", [&] { (void)gone.is_committed(); });
  refused("Scene::", "moved from", [&] { gone.candidate_pairs(0, {}); });
  gone = limber::Scene();
  EXPECT_EQ(gone.size(), 0U);
}

TEST_F(SceneMisuse, ByVisitorsAndFiltersThatThrowChangesNothing) {
  const auto throws = [](const ObjectPair&) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(scene_.visit_candidate_pairs(0, throws), std::runtime_error);
  const auto filter = [](ObjectId, ObjectId) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(scene_.candidate_pairs(0, {}, filter), std::runtime_error);
  EXPECT_THROW((void)scene_.closest_objects({.filter = filter}), std::runtime_error);
}

}  // namespace
}  // namespace limber::testing

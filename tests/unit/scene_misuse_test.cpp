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

namespace limber::testing {
namespace {

/// Whether a call throws std::invalid_argument, with a text that has both parts.
template <typename Call>
::testing::AssertionResult scene_refuses(const Call& call, const std::string& function, const std::string& argument) {
  try {
    call();
  } catch (const std::invalid_argument& error) {
    const std::string text = error.what();
    const bool is_named = text.find("limber::" + function) != std::string::npos;
    if (is_named && text.find(argument) != std::string::npos) return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "the text is: " << text;
  }
  return ::testing::AssertionFailure() << "nothing was thrown";
}

class SceneMisuse : public ::testing::Test {
 protected:
  SceneMisuse() {
    scene_.add({ball_});
    scene_.add({ball_, {{}, {1, 0, 0}}});
    scene_.add({ball_, {{}, {9, 0, 0}}});
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
  Model ball_{scenes::ball(6, 4)};
  limber::Scene scene_;
};

TEST_F(SceneMisuse, OfIdsIsRefused) {
  for (const ObjectId bad : {ObjectId{2}, ObjectId{3}, no_id}) {
    EXPECT_TRUE(scene_refuses([&] { scene_.remove(bad); }, "Scene::remove", "id"));
    EXPECT_TRUE(scene_refuses([&] { scene_.set_pose(bad, {}); }, "Scene::set_pose", "id"));
    EXPECT_TRUE(scene_refuses([&] { (void)scene_.object(bad); }, "Scene::object", "id"));
    EXPECT_TRUE(scene_refuses([&] { (void)scene_.bounding_box(bad); }, "Scene::bounding_box", "id"));
    const std::vector<ObjectId> ids{0, bad};
    const std::vector<Transform> poses{{{}, {5, 5, 5}}, {}};
    EXPECT_TRUE(scene_refuses([&] { scene_.set_poses(ids, poses); }, "Scene::set_poses", "ids"));
    const std::vector<ObjectPair> pairs{{0, 1}, {0, bad}};
    std::vector<CollideResult> collisions(2);
    std::vector<CollideResult> withins(2);
    std::vector<DistanceResult> distances(2);
    EXPECT_TRUE(scene_refuses([&] { scene_.collide(pairs, collisions); }, "Scene", "pairs"));
    EXPECT_TRUE(scene_refuses([&] { scene_.within(pairs, 1, withins); }, "Scene", "pairs"));
    EXPECT_TRUE(scene_refuses([&] { scene_.distance(pairs, distances); }, "Scene", "pairs"));
    EXPECT_FALSE(collisions[0].is_yes());
  }
}

TEST_F(SceneMisuse, OfPosesIsRefused) {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const Transform& pose : {bad_pose_, Transform{{}, {bad, 0, 0}}, Transform{{}, {0, 0x1p201, 0}}}) {
    EXPECT_TRUE(scene_refuses([&] { scene_.add({ball_, pose}); }, "Scene::add", "pose"));
    EXPECT_TRUE(scene_refuses([&] { scene_.set_pose(0, pose); }, "Scene::set_pose", "pose"));
    const std::vector<ObjectId> ids{0, 1};
    const std::vector<Transform> poses{{{}, {5, 5, 5}}, pose};
    EXPECT_TRUE(scene_refuses([&] { scene_.set_poses(ids, poses); }, "Scene::set_poses", "poses"));
    EXPECT_TRUE(
        scene_refuses([&] { scene_.set_poses(ids, std::span(poses).first(1)); }, "Scene::set_poses", "as many poses"));
  }
}

TEST_F(SceneMisuse, OfModelsIsRefused) {
  Model moved(scenes::ball(6, 4));
  ASSERT_TRUE(static_cast<bool>(moved.move_all(moved.mesh().positions())));
  EXPECT_TRUE(scene_refuses([&] { scene_.add({moved}); }, "Scene::add", "model"));
  Model gone(scenes::ball(6, 4));
  const Model other(std::move(gone));
  EXPECT_TRUE(scene_refuses([&] { scene_.add({gone}); }, "Scene::add", "model"));
  // Models that are in the scene.
  ASSERT_TRUE(static_cast<bool>(ball_.move_all(ball_.mesh().positions())));
  EXPECT_FALSE(scene_.is_committed());
  EXPECT_TRUE(scene_refuses([&] { scene_.commit(); }, "Scene::commit", "model"));
  EXPECT_TRUE(scene_refuses([&] { scene_.candidate_pairs(0, {}); }, "Scene::candidate_pairs", "commit"));
  EXPECT_TRUE(scene_refuses([&] { (void)scene_.closest_objects(); }, "Scene::closest_objects", "commit"));
  ball_.commit();
  scene_.commit();
  Model taken(std::move(ball_));
  EXPECT_FALSE(scene_.is_committed());
  EXPECT_TRUE(scene_refuses([&] { scene_.commit(); }, "Scene::commit", "model"));
  EXPECT_TRUE(scene_refuses([&] { scene_.candidate_pairs(0, {}); }, "Scene::candidate_pairs", "commit"));
  ball_ = std::move(taken);
  EXPECT_TRUE(scene_.is_committed());
}

TEST_F(SceneMisuse, OfNumbersIsRefused) {
  const std::vector<ObjectPair> pairs{{0, 1}};
  std::vector<CollideResult> withins(1);
  std::vector<DistanceResult> distances(1);
  const auto visit = [](const ObjectPair&) { return true; };
  for (const double bad : bad_numbers) {
    EXPECT_TRUE(scene_refuses([&] { scene_.candidate_pairs(bad, {}); }, "Scene::candidate_pairs", "margin"));
    EXPECT_TRUE(scene_refuses([&] { scene_.visit_candidate_pairs(bad, visit); }, "Scene::candidate_pairs", "margin"));
    EXPECT_TRUE(scene_refuses([&] { scene_.within(pairs, bad, withins); }, "within", "max_distance"));
    EXPECT_TRUE(scene_refuses([&] { scene_.distance(pairs, distances, {.relative_error = bad}); }, "Scene::distance",
                              "relative_error"));
    EXPECT_TRUE(scene_refuses([&] { (void)scene_.closest_objects({.max_distance = bad}); }, "Scene::closest_objects",
                              "max_distance"));
    EXPECT_THROW(reference::pairs_within({}, bad), std::invalid_argument);
  }
  EXPECT_TRUE(scene_refuses([&] { scene_.candidate_pairs(infinite, {}); }, "Scene::candidate_pairs", "margin"));
}

TEST_F(SceneMisuse, OfResultsIsRefused) {
  const std::vector<ObjectPair> pairs{{0, 1}, {1, 0}};
  std::vector<CollideResult> collisions(1);
  std::vector<CollideResult> withins(3);
  std::vector<DistanceResult> distances;
  EXPECT_TRUE(scene_refuses([&] { scene_.collide(pairs, collisions); }, "Scene", "results"));
  EXPECT_TRUE(scene_refuses([&] { scene_.within(pairs, 1, withins); }, "Scene", "results"));
  EXPECT_TRUE(scene_refuses([&] { scene_.distance(pairs, distances); }, "Scene", "results"));
}

TEST_F(SceneMisuse, OfChangesThatAreNotCommittedIsRefused) {
  scene_.set_pose(0, {{}, {0.5, 0, 0}});
  std::vector<CollideResult> collisions(1);
  const std::vector<ObjectPair> pairs{{0, 1}};
  EXPECT_TRUE(scene_refuses([&] { scene_.candidate_pairs(0, {}); }, "Scene::candidate_pairs", "commit"));
  EXPECT_TRUE(scene_refuses([&] { scene_.collide(pairs, collisions); }, "Scene", "committed"));
  EXPECT_TRUE(scene_refuses([&] { (void)scene_.closest_objects(); }, "Scene::closest_objects", "commit"));
  EXPECT_TRUE(scene_refuses([&] { (void)scene_.bounding_box(0); }, "Scene::bounding_box", "commit"));
  scene_.set_pose(0, {});
  scene_.commit();
}

TEST_F(SceneMisuse, OfASceneThatWasMovedFromIsRefused) {
  limber::Scene gone;
  const limber::Scene other = std::move(gone);
  EXPECT_TRUE(scene_refuses([&] { gone.add({ball_}); }, "Scene::add", "moved from"));
  EXPECT_TRUE(scene_refuses([&] { gone.commit(); }, "Scene::commit", "moved from"));
  EXPECT_TRUE(scene_refuses([&] { (void)gone.size(); }, "Scene::size", "moved from"));
  EXPECT_TRUE(scene_refuses([&] { (void)gone.is_committed(); }, "Scene::is_committed", "moved from"));
  EXPECT_TRUE(scene_refuses([&] { gone.candidate_pairs(0, {}); }, "Scene::", "moved from"));
  gone = limber::Scene();
  EXPECT_EQ(gone.size(), 0U);
}

TEST_F(SceneMisuse, ByVisitorsAndFiltersThatThrowChangesNothing) {
  const auto throws = [](const ObjectPair&) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(scene_.visit_candidate_pairs(0, throws), std::runtime_error);
  const auto filter = [](ObjectId, ObjectId) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(scene_.candidate_pairs(0, {}, {.filter = filter}), std::runtime_error);
  EXPECT_THROW((void)scene_.closest_objects({.filter = filter}), std::runtime_error);
}

}  // namespace
}  // namespace limber::testing

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
    refused("Scene::set_poses", "ids", [&] { scene_.set_poses(ids, poses); });
    const std::vector<ObjectPair> pairs{{0, 1}, {0, bad}};
    std::vector<CollideResult> answers(2);
    std::vector<DistanceResult> distances(2);
    refused("Scene", "pairs", [&] { scene_.collide(pairs, answers); });
    refused("Scene", "pairs", [&] { scene_.within(pairs, 1, answers); });
    refused("Scene", "pairs", [&] { scene_.distance(pairs, distances); });
    EXPECT_FALSE(answers[0].is_yes());
  }
}

TEST_F(SceneMisuse, OfPosesIsRefused) {
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const Transform& pose : {bad_pose_, Transform{{}, {bad, 0, 0}}, Transform{{}, {0, 0x1p201, 0}}}) {
    refused("Scene::add", "pose", [&] { scene_.add({ball_, pose}); });
    refused("Scene::set_pose", "pose", [&] { scene_.set_pose(0, pose); });
    const std::vector<ObjectId> ids{0, 1};
    const std::vector<Transform> poses{{{}, {5, 5, 5}}, pose};
    refused("Scene::set_poses", "poses", [&] { scene_.set_poses(ids, poses); });
    refused("Scene::set_poses", "as many poses", [&] { scene_.set_poses(ids, std::span(poses).first(1)); });
  }
}

TEST_F(SceneMisuse, OfModelsIsRefused) {
  Model moved(scenes::ball(6, 4));
  ASSERT_TRUE(static_cast<bool>(moved.move_all(moved.mesh().positions())));
  refused("Scene::add", "model", [&] { scene_.add({moved}); });
  Model gone(scenes::ball(6, 4));
  const Model other(std::move(gone));
  refused("Scene::add", "model", [&] { scene_.add({gone}); });
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
    refused("Scene::distance", "relative_error", [&] { scene_.distance(pair_, distance_, {.relative_error = bad}); });
    refused("Scene::closest_objects", "max_distance", [&] { (void)scene_.closest_objects({.max_distance = bad}); });
    EXPECT_THROW(reference::pairs_within({}, bad), std::invalid_argument);
  }
  refused("Scene::candidate_pairs", "margin", [&] { scene_.candidate_pairs(infinite, {}); });
}

TEST_F(SceneMisuse, OfResultsIsRefused) {
  const std::vector<ObjectPair> pairs{{0, 1}, {1, 0}};
  refused("Scene", "results", [&] { scene_.collide(pairs, answer_); });
  refused("Scene", "results", [&] { scene_.within(pairs, 1, answer_); });
  refused("Scene", "results", [&] { scene_.distance(pairs, distance_); });
}

TEST_F(SceneMisuse, OfChangesThatAreNotCommittedIsRefused) {
  scene_.set_pose(0, {{}, {0.5, 0, 0}});
  refused("Scene::candidate_pairs", "commit", [&] { scene_.candidate_pairs(0, {}); });
  refused("Scene", "committed", [&] { scene_.collide(pair_, answer_); });
  refused("Scene::closest_objects", "commit", [&] { (void)scene_.closest_objects(); });
  refused("Scene::bounding_box", "commit", [&] { (void)scene_.bounding_box(0); });
  scene_.set_pose(0, {});
  scene_.commit();
}

TEST_F(SceneMisuse, OfASceneThatWasMovedFromIsRefused) {
  limber::Scene gone;
  const limber::Scene other = std::move(gone);
  refused("Scene::add", "moved from", [&] { gone.add({ball_}); });
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
  EXPECT_THROW(scene_.candidate_pairs(0, {}, {.filter = filter}), std::runtime_error);
  EXPECT_THROW((void)scene_.closest_objects({.filter = filter}), std::runtime_error);
}

}  // namespace
}  // namespace limber::testing

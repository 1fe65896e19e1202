// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Broad phases that did not notice that a body had moved or deformed.
#include <stdexcept>

#include "limber/scene.h"
#include "peers.h"

namespace limber::testing {
namespace {

/// The distance of the only two objects of a scene, if the broad phase has them within a margin at all.
double distance_in(const limber::Scene& scene, double margin) {
  std::vector<ObjectPair> pairs(1);
  if (scene.candidate_pairs(margin, pairs).count == 0) return HUGE_VAL;
  std::vector<DistanceResult> results(1);
  scene.distance(pairs, results);
  EXPECT_EQ(scene.closest_objects().result.upper, results.front().upper);
  return results.front().upper;
}

// FCL #577: a box stretches into another one; the narrow phase finds the collision, the broad phase keeps the old box
// and does not.
TEST(MovingScene, FindsABodyThatHasStretchedIntoAnother) {
  const Mesh rest = box({0.5, 0.5, 0.5});
  Model stretching(rest);
  const Model fixed(box({0.5, 0.5, 0.5}));
  limber::Scene scene;
  const ObjectId id = scene.add({stretching});
  static_cast<void>(scene.add({fixed, at(4)}));
  scene.commit();
  EXPECT_EQ(distance_in(scene, 1), HUGE_VAL);
  for (const double length : {1.0, 2.0, 3.0, 3.5, 4.0, 0.5}) {
    stretching.move_all(stretched(rest, {2 * length, 1, 1}).positions()).value();
    EXPECT_THROW(scene.commit(), std::invalid_argument);  // the model is not committed
    stretching.commit();
    EXPECT_FALSE(scene.is_committed());
    EXPECT_THROW(distance_in(scene, 9), std::invalid_argument);
    scene.commit();
    EXPECT_EQ(distance_in(scene, 9), std::max(0.0, 3.5 - length));
    EXPECT_GE(scene.bounding_box(id).high.x, length);
    EXPECT_LE(scene.bounding_box(id).high.x, length + 1e-3);
  }
}

// FCL #386, #40, Drake PR #10184: a pose is set, the box of the body is not, and the broad phase culls by the old one.
TEST(MovingScene, KnowsAPoseAsSoonAsItIsCommittedAndIsSilentBefore) {
  const Model cube(box({0.5, 0.5, 0.5}));
  limber::Scene scene;
  static_cast<void>(scene.add({cube}));
  const ObjectId moving = scene.add({cube, at(50)});
  scene.commit();
  for (int i = 0; i < 100; ++i) {
    const double x = 10 - 0.11 * i;
    scene.set_pose(moving, at(x));
    EXPECT_FALSE(scene.is_committed());
    EXPECT_THROW(scene.candidate_pairs(1, {}), std::invalid_argument);
    scene.commit();
    const double truth = std::max(0.0, std::abs(x) - 1);
    const double found = distance_in(scene, 1);
    if (truth <= 1) {
      EXPECT_NEAR(found, truth, 1e-14) << i;
    }
    EXPECT_NEAR(scene.closest_objects().result.upper, truth, 1e-14) << i;
  }
}

// PhysX #530: a mesh that was modified must be set on its shape again, and one with other triangles needs a new shape.
TEST(MovingScene, TakesOverABodyThatHasBecomeAnother) {
  Model changing(box({0.5, 0.5, 0.5}));
  const Model fixed(scenes::ball(16, 8));
  limber::Scene scene;
  SceneCache cache;
  static_cast<void>(scene.add({changing})), static_cast<void>(scene.add({fixed, at(5)}));
  scene.commit();
  EXPECT_NEAR(scene.closest_objects({.cache = &cache}).result.upper, 3.5, 1e-14);
  changing.reset(scenes::grid(30, 3, 0, -0.5, 0.1, 0.5));
  EXPECT_FALSE(scene.is_committed());
  scene.commit();
  EXPECT_NEAR(scene.closest_objects({.cache = &cache}).result.upper, 1, 1e-14);
  changing.reset(triangles_of({{{-1, 0, 0}, {-1, 1, 0}, {-1, 0, 1}}}));
  scene.commit();
  EXPECT_NEAR(scene.closest_objects({.cache = &cache}).result.upper, 5, 1e-14);
  EXPECT_NEAR(distance_in(scene, 9), 5, 1e-14);
}

}  // namespace
}  // namespace limber::testing

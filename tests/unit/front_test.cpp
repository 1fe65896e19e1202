// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "query/front.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "limber/model.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using query::Front;
using query::PlacedPair;
using query::Side;

TEST(Front, BoundsWhatAnyMotionChanges) {
  Rng rng(300);
  const Model a(scenes::thesis_square()), b(scenes::thesis_ball());
  double tightest = 0;
  for (int i = 0; i < 2000; ++i) {
    const double step = std::pow(10.0, rng.uniform(-6, 0));
    const Transform pose_a = random_pose(rng, 3), before = random_pose(rng, 3);
    const Vec3 axis = step * uniform_point(rng);
    const Transform turn = transform_from_quaternion({}, 1, axis.x, axis.y, axis.z).value();
    const Transform after{turn.rotation * before.rotation, before.translation + step * uniform_point(rng)};
    PlacedPair first({a, pose_a}, {b, before}), second({a, pose_a}, {b, after});
    const double bound = second.most_moved(first.a_from_b(), first.error(), second.a_from_b());
    for (int k = 0; k < 20; ++k) {
      const Vec3& on_a = a.mesh().positions()[rng.below(a.mesh().positions().size())];
      const Vec3& on_b = b.mesh().positions()[rng.below(b.mesh().positions().size())];
      const double changed = std::abs(length(after(on_b) - pose_a(on_a)) - length(before(on_b) - pose_a(on_a)));
      ASSERT_LE(changed, bound) << i;
      tightest = std::max(tightest, changed / bound);
    }
  }
  EXPECT_GT(tightest, 0.5);
}

TEST(Front, IsGoneThroughToItsEndHoweverManyPairsWait) {
  // Slack larger than the triangles keeps so many pairs that the queue has once been full.
  const scenes::Motion waves = scenes::waving_sheet(158, 158);
  Model sheet(waves.mesh, {.slack = 0.07});
  std::vector<Vec3> positions = scenes::thesis_ball().positions();
  for (Vec3& p : positions) p *= 0.25;
  const Model ball(Mesh::create(positions, scenes::thesis_ball().triangles()).value());
  Pair pair;
  for (int frame = 1; frame <= 30; ++frame) {
    ASSERT_TRUE(static_cast<bool>(sheet.move_all(waves.positions(frame))));
    sheet.commit();
    const double angle = 0.01 * frame;
    const Placed placed{ball, {{}, {2 + 1.2 * scenes::cosine(angle), 2 + 1.2 * scenes::sine(angle), 0.5}}};
    ASSERT_NEAR(distance({sheet}, placed, {}, pair).upper, distance({sheet}, placed).upper, 1e-14) << frame;
  }
}

TEST(Front, SurvivesJumpsFromFarAwayToNextToEachOther) {
  // The way is so long that its rounding is larger than what is left.
  Rng rng(301);
  for (int i = 0; i < 300; ++i) {
    const double scale = std::ldexp(1.0, -20 - static_cast<int>(rng.below(60)));
    std::vector<Vec3> positions = scenes::ball(8, 5).positions();
    for (Vec3& p : positions) p *= scale;
    const Model a(Mesh::create(positions, scenes::ball(8, 5).triangles()).value());
    const Model b(Mesh::create(positions, scenes::ball(8, 5).triangles()).value());
    Pair pair;
    const Transform far = random_pose(rng, 1), offset = random_pose(rng, 1e6);
    distance({a}, {b, far}, {}, pair);
    distance({a, offset}, {b, offset * far}, {}, pair);
    const Transform near{random_pose(rng, 1).rotation, 4 * scale * uniform_point(rng)};
    ASSERT_NEAR(distance({a}, {b, near}, {}, pair).upper, distance({a}, {b, near}).upper, 1e-13 * scale) << i;
  }
}

TEST(Front, RulesOutUntilTheMotionIsUsedUp) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball());
  PlacedPair here({square}, {ball, {{}, {0, 0, 5}}}), there({square}, {ball, {{}, {0, 0, 4.9}}});
  Front front;
  EXPECT_FALSE(front.is_about(here));
  front.start(here);
  const std::uint16_t record = front.add({1, 2}, Side::b);
  front.rule_out(record, 0b101, 3.0);
  front.rule_out(record, 0b010, 2.0);
  EXPECT_EQ(front.records()[record].lanes, 0b111);
  EXPECT_EQ(front.records()[record].lasts, 2.0);
  EXPECT_FALSE(front.is_about(here));  // not all is recorded yet, and never will be if an exception breaks it off
  front.finish(true);
  EXPECT_TRUE(front.is_about(here));
  front.move(there);
  EXPECT_FALSE(front.is_about(there));
  EXPECT_NEAR(front.moved(), 0.1, 1e-6);
  EXPECT_GE(front.moved(), 0.1);
  EXPECT_EQ(front.reopen(record), 0b111U);
  EXPECT_EQ(front.records()[record].lanes, 0);
  front.rule_out(record, 0b001, 1.0);
  EXPECT_DOUBLE_EQ(front.records()[record].lasts, 1 + front.moved());
}

TEST(Front, IsForgottenWhenIncompleteOrOfOtherModels) {
  const Model square(scenes::thesis_square()), ball(scenes::thesis_ball()), twin(scenes::thesis_ball());
  PlacedPair placed({square}, {ball}), other({square}, {twin}), turned({ball}, {square});
  Front front;
  front.start(placed);
  front.add({0, 0}, Side::a);
  front.finish(true);
  EXPECT_TRUE(front.is_about(placed));
  EXPECT_FALSE(front.is_about(other));
  EXPECT_FALSE(front.is_about(turned));
  front.finish(false);
  EXPECT_FALSE(front.is_about(placed));
  front.start(placed);
  for (int i = 0; i < 1024; ++i) ASSERT_NE(front.add({0, 0}, Side::a), Front::none);
  EXPECT_EQ(front.add({0, 0}, Side::a), Front::none);
}

TEST(Front, SavesTestsAlongASlowMotion) {
  const Model sheet(scenes::wave_sheet(100, 100, 0)), ball(scenes::thesis_ball());
  Pair pair;
  std::uint64_t cold = 0, warm = 0;
  for (int frame = 0; frame < 200; ++frame) {
    const double t = 1e-3 * frame;
    const Transform pose = transform_from_quaternion({2 + t, 2 - t, 1.5 - t}, 1, t, 0, t).value();
    const DistanceResult fresh = distance({sheet}, {ball, pose}), kept = distance({sheet}, {ball, pose}, {}, pair);
    ASSERT_NEAR(kept.upper, fresh.upper, 1e-14) << frame;
    cold += fresh.stats.node_tests, warm += kept.stats.node_tests;
  }
  EXPECT_LT(2 * warm, cold);
}

TEST(Front, DoesWithoutWhenThereIsNotEnoughRoom) {
  // Two sheets one on the other, nowhere far from each other: thousands of openings.
  const Model lower(scenes::wave_sheet(150, 150, 0)), upper(scenes::wave_sheet(150, 150, 0));
  Pair pair;
  std::uint64_t most = 0;
  for (int frame = 0; frame < 10; ++frame) {
    const Transform pose{{}, {0, 0, 1e-3 - 1e-5 * frame}};
    const DistanceResult fresh = distance({lower}, {upper, pose}), kept = distance({lower}, {upper, pose}, {}, pair);
    ASSERT_NEAR(kept.upper, fresh.upper, 1e-14) << frame;
    most = std::max(most, kept.stats.node_tests);
  }
  EXPECT_GT(most, 8U * 1024);
}

}  // namespace
}  // namespace limber::testing

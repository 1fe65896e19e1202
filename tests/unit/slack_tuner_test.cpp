// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/slack_tuner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "limber/model.h"
#include "scenes/motions.h"

namespace limber::testing {
namespace {

/// Vertices that all go one way by `step` a commit: a full repair whenever they have used up their slack, and queries
/// that pay `price` for each unit of what they have gone.
double mean_cost(SlackTuner& tuner, int commits, double step, double repair, double price) {
  double away = 0, sum = 0;
  for (int i = 0; i < commits; ++i) {
    const double queries = price * away;
    away += step;
    const bool repairs = away > tuner.slack();
    if (repairs) away = 0;
    sum += queries + (repairs ? repair : 0);
    tuner.add({repairs ? repair : 0, repair, queries, step, !repairs});
  }
  return sum / commits;
}

double mean_cost_of_fixed(double slack, double step, double repair, double price) {
  const double commits = std::floor(slack / step) + 1;
  return (repair + price * step * (commits - 1) * commits / 2) / commits;
}

TEST(SlackTuner, FindsTheBestOfSteadyMotion) {
  for (const double price : {1e-3, 0.1, 1.0, 10.0, 300.0, 1e4}) {
    const double step = 0.01, repair = 50;
    double best = repair;
    for (double slack = step; slack < 64 * step; slack *= 1.1) {
      best = std::min(best, mean_cost_of_fixed(slack, step, repair, price));
    }
    SlackTuner tuner(1e6);
    mean_cost(tuner, 300, step, repair, price);
    EXPECT_LE(mean_cost(tuner, 1000, step, repair, price), 1.15 * best) << price;
  }
}

TEST(SlackTuner, FollowsMotionThatChanges) {
  SlackTuner tuner(1e6);
  mean_cost(tuner, 500, 0.01, 50, 10);
  const double slow = tuner.slack();
  mean_cost(tuner, 500, 1, 50, 10);
  const double fast = mean_cost(tuner, 500, 1, 50, 10);
  EXPECT_LE(fast, 1.15 * std::min(50.0, mean_cost_of_fixed(2, 1, 50, 10)));
  mean_cost(tuner, 2000, 0.01, 50, 10);
  EXPECT_LT(tuner.slack(), 8 * slow + 0.1);
}

TEST(SlackTuner, NeverTriesMoreThanTheMost) {
  SlackTuner tuner(0.5);
  EXPECT_EQ(tuner.slack(), 0.5);
  for (const double step : {0.01, 1.0, 0.02, 0.4}) {
    for (int i = 0; i < 500; ++i) {
      mean_cost(tuner, 1, step, 50, 1e-3);
      EXPECT_LE(tuner.slack(), 0.5);
    }
    EXPECT_EQ(tuner.slack() > 0, step < 0.5);
  }
}

TEST(SlackTuner, TriesSlackOnceAModelMovesSlowly) {
  SlackTuner tuner(0.5);
  mean_cost(tuner, 1, 10, 50, 1e-3);
  EXPECT_EQ(tuner.slack(), 0);
  mean_cost(tuner, 100, 0.2, 50, 1e-3);
  EXPECT_GT(tuner.slack(), 0);
}

TEST(SlackTuner, GivesUpWhatHasBecomeTooMuch) {
  SlackTuner tuner(64);
  mean_cost(tuner, 1000, 1, 50, 1e-3);
  ASSERT_GE(tuner.slack(), 8);
  tuner.set_most(4);
  EXPECT_LE(tuner.slack(), 4);
  mean_cost(tuner, 300, 1, 50, 1e-3);
  EXPECT_EQ(tuner.slack(), 4);
}

TEST(SlackTuner, GrowsWithTheModel) {
  // A point that becomes a sheet, which then drifts.
  const Mesh sheet = scenes::waving_sheet(20, 20).mesh;
  const std::vector<Vec3> nowhere(sheet.positions().size());
  for (const Restructuring restructuring : {Restructuring::off, Restructuring::in_commits}) {
    Model model(Mesh::create(nowhere, sheet.triangles()).value(),
                {.slack = ModelOptions::automatic, .restructuring = restructuring});
    for (int frame = 1; frame <= 40; ++frame) {
      std::vector<Vec3> positions = sheet.positions();
      for (Vec3& p : positions) p.x += 1e-4 * frame;
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      ASSERT_TRUE(static_cast<bool>(model.validate()));
    }
    EXPECT_GT(model.maintenance_stats().slack, 0);
  }
}

TEST(SlackTuner, LeavesAModelTightThatMovesFast) {
  const scenes::Motion sheet = scenes::waving_sheet(40, 40);
  Model tuned(sheet.mesh, {.slack = ModelOptions::automatic});
  for (int frame = 1; frame <= 20; ++frame) {
    std::vector<Vec3> positions = sheet.mesh.positions();
    for (Vec3& p : positions) p.x += 0.2 * frame;
    ASSERT_TRUE(static_cast<bool>(tuned.move_all(positions)));
    tuned.commit();
  }
  EXPECT_EQ(tuned.maintenance_stats().absorbed, 0);
}

TEST(SlackTuner, LeavesAModelTightWhereSlackIsDear) {
  const scenes::Motion cloth = scenes::crumpling_cloth(40);
  Model tuned(cloth.mesh, {.slack = ModelOptions::automatic});
  const Model ball(scenes::ball(16, 9));
  for (int frame = 1; frame <= 100; ++frame) {
    ASSERT_TRUE(static_cast<bool>(tuned.move_all(cloth.positions(5 * frame))));
    tuned.commit();
    for (int i = 0; i < 20; ++i) distance({tuned}, {ball, {{}, {0, 0.1 * i, 1.6}}});
  }
  const MaintenanceStats stats = tuned.maintenance_stats();
  EXPECT_GT(stats.extra_steps, 0);
  EXPECT_LT(stats.absorbed, stats.moved_vertices / 4);
}

}  // namespace
}  // namespace limber::testing

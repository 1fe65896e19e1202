// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/margin_tuner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "scenes/motions.h"

namespace limber::testing {
namespace {

using model::MarginTuner;

/// The mean cost of a commit while all vertices move in one direction, by `step` in each commit. A refit of the whole
/// tree costs `refit_cost` whenever the vertices have used up the margin. Queries cost `price` for each unit of their
/// displacement since then.
double mean_cost(MarginTuner& tuner, int commits, double step, double refit_cost, double price) {
  double displacement = 0, sum = 0;
  for (int i = 0; i < commits; ++i) {
    const double queries = price * displacement;
    displacement += step;
    const bool refits = displacement > tuner.margin();
    if (refits) displacement = 0;
    sum += queries + (refits ? refit_cost : 0);
    tuner.add({refits ? refit_cost : 0, refit_cost, queries, step, !refits});
  }
  return sum / commits;
}

double mean_cost_of_fixed(double motion_margin, double step, double refit_cost, double price) {
  const double commits = std::floor(motion_margin / step) + 1;
  return (refit_cost + price * step * (commits - 1) * commits / 2) / commits;
}

TEST(MarginTuner, FindsTheBestOfSteadyMotion) {
  for (const double price : {1e-3, 0.1, 1.0, 10.0, 300.0, 1e4}) {
    const double step = 0.01, refit_cost = 50;
    double best = refit_cost;
    for (double motion_margin = step; motion_margin < 64 * step; motion_margin *= 1.1) {
      best = std::min(best, mean_cost_of_fixed(motion_margin, step, refit_cost, price));
    }
    MarginTuner tuner(1e6);
    mean_cost(tuner, 300, step, refit_cost, price);
    EXPECT_LE(mean_cost(tuner, 1000, step, refit_cost, price), 1.15 * best) << price;
  }
}

TEST(MarginTuner, FollowsMotionThatChanges) {
  MarginTuner tuner(1e6);
  mean_cost(tuner, 500, 0.01, 50, 10);
  const double slow = tuner.margin();
  mean_cost(tuner, 500, 1, 50, 10);
  const double fast = mean_cost(tuner, 500, 1, 50, 10);
  EXPECT_LE(fast, 1.15 * std::min(50.0, mean_cost_of_fixed(2, 1, 50, 10)));
  mean_cost(tuner, 2000, 0.01, 50, 10);
  EXPECT_LT(tuner.margin(), 8 * slow + 0.1);
}

TEST(MarginTuner, NeverTriesMoreThanTheLargest) {
  MarginTuner tuner(0.5);
  EXPECT_EQ(tuner.margin(), 0.5);
  for (const double step : {0.01, 1.0, 0.02, 0.4}) {
    for (int i = 0; i < 500; ++i) {
      mean_cost(tuner, 1, step, 50, 1e-3);
      EXPECT_LE(tuner.margin(), 0.5);
    }
    EXPECT_EQ(tuner.margin() > 0, step < 0.5);
  }
}

TEST(MarginTuner, TriesAMarginOnceAModelMovesSlowly) {
  MarginTuner tuner(0.5);
  mean_cost(tuner, 1, 10, 50, 1e-3);
  EXPECT_EQ(tuner.margin(), 0);
  mean_cost(tuner, 100, 0.2, 50, 1e-3);
  EXPECT_GT(tuner.margin(), 0);
}

TEST(MarginTuner, GivesUpAMarginThatHasBecomeTooLarge) {
  MarginTuner tuner(64);
  mean_cost(tuner, 1000, 1, 50, 1e-3);
  ASSERT_GE(tuner.margin(), 8);
  tuner.set_largest(4);
  EXPECT_LE(tuner.margin(), 4);
  mean_cost(tuner, 300, 1, 50, 1e-3);
  EXPECT_EQ(tuner.margin(), 4);
}

TEST(MarginTuner, GrowsWithTheModel) {
  // A point that becomes a sheet, which then drifts.
  const Mesh sheet = scenes::waving_sheet(20, 20).mesh;
  const std::vector<Vec3> nowhere(sheet.positions().size());
  for (const RebuildPolicy rebuild_policy : {RebuildPolicy::off, RebuildPolicy::in_commit}) {
    Model model(Mesh::create(nowhere, sheet.triangles()).value(),
                {.motion_margin = ModelOptions::automatic, .rebuild_policy = rebuild_policy});
    for (int frame = 1; frame <= 40; ++frame) {
      std::vector<Vec3> positions = sheet.positions();
      for (Vec3& p : positions) p.x += 1e-4 * frame;
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      ASSERT_TRUE(static_cast<bool>(model.validate()));
    }
    EXPECT_GT(model.maintenance_stats().motion_margin, 0);
  }
}

TEST(MarginTuner, LeavesAModelTightThatMovesFast) {
  const scenes::Motion sheet = scenes::waving_sheet(40, 40);
  Model tuned(sheet.mesh, {.motion_margin = ModelOptions::automatic});
  for (int frame = 1; frame <= 20; ++frame) {
    std::vector<Vec3> positions = sheet.mesh.positions();
    for (Vec3& p : positions) p.x += 0.2 * frame;
    ASSERT_TRUE(static_cast<bool>(tuned.move_all(positions)));
    tuned.commit();
  }
  EXPECT_EQ(tuned.maintenance_stats().absorbed, 0);
}

TEST(MarginTuner, RemembersTheMarginWhileAnAnimationStandsStill) {
  const scenes::Motion sheet = scenes::waving_sheet(40, 40);
  Model tuned(sheet.mesh, {.motion_margin = ModelOptions::automatic});
  std::vector<Vec3> positions = sheet.mesh.positions();
  const auto show = [&](double by) {
    for (Vec3& p : positions) p.z += by;
    ASSERT_TRUE(static_cast<bool>(tuned.move_all(positions)));
    tuned.commit();
  };
  for (int frame = 0; frame < 400; ++frame) show(1e-3);
  const double found = tuned.maintenance_stats().motion_margin;
  ASSERT_GT(found, 0);
  for (int frame = 0; frame < 100; ++frame) show(0);
  EXPECT_EQ(tuned.maintenance_stats().motion_margin, found);
  show(1e-3);
  EXPECT_EQ(tuned.maintenance_stats().motion_margin, found);
}

TEST(MarginTuner, LeavesAModelTightWhereAMarginIsExpensive) {
  const scenes::Motion cloth = scenes::crumpling_cloth(40);
  Model tuned(cloth.mesh, {.motion_margin = ModelOptions::automatic});
  const Model ball(scenes::ball(16, 9));
  for (int frame = 1; frame <= 100; ++frame) {
    ASSERT_TRUE(static_cast<bool>(tuned.move_all(cloth.positions(5 * frame))));
    tuned.commit();
    for (int i = 0; i < 20; ++i) distance({tuned}, {ball, {{}, {0, 0.1 * i, 1.6}}});
  }
  const MaintenanceStats stats = tuned.maintenance_stats();
  EXPECT_GT(stats.margin_steps, 0);
  EXPECT_LT(stats.absorbed, stats.moved_vertices / 4);
}

}  // namespace
}  // namespace limber::testing

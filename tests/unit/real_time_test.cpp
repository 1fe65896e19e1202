// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What ModelOptions::real_time() promises about moves and commits, by counts.
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "limber/model.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

constexpr std::uint32_t grid_side = 36;
constexpr double commit_budget_us = 5, longest_step_us = 10, us_per_refit = 0.6;

/// Moves some vertices near one, or anywhere, a little.
void move_some(Model& model, Rng& rng, bool anywhere) {
  constexpr VertexId count = 12;
  const VertexId vertices = static_cast<VertexId>(model.mesh().positions().size());
  const auto first = static_cast<VertexId>(rng.below(vertices - count));
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
  for (VertexId i = 0; i < count; ++i) {
    const VertexId id = anywhere ? static_cast<VertexId>(rng.below(vertices)) : first + i;
    ids.push_back(id);
    positions.push_back(model.mesh().positions()[id] + 0.3 * uniform_point(rng));
  }
  ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, positions)));
}

TEST(RealTime, NoMoveAndNoCommitGoesOverTheWholeTreeWhileItIsRebuilt) {
  for (const bool anywhere : {false, true}) {
    SCOPED_TRACE(anywhere);
    Model model(scenes::grid(grid_side, grid_side, 0, 0, 1, 1), ModelOptions::real_time(commit_budget_us));
    Model never_rebuilt(scenes::grid(grid_side, grid_side, 0, 0, 1, 1), {.rebuild_policy = RebuildPolicy::off});
    Rng rng(81), same_rng(81);
    std::uint64_t most_own = 0;
    for (int frame = 0; frame < 1000; ++frame) {
      const MaintenanceStats before = model.maintenance_stats();
      const std::uint64_t own_before = never_rebuilt.maintenance_stats().refits;
      move_some(model, rng, anywhere);
      model.commit();
      move_some(never_rebuilt, same_rng, anywhere);
      never_rebuilt.commit();
      const MaintenanceStats after = model.maintenance_stats();
      most_own = std::max(most_own, never_rebuilt.maintenance_stats().refits - own_before);
      ASSERT_EQ(after.whole_passes, 0U) << frame;
      // The trees differ, so their refits do too.
      const double most_refits = 1.5 * static_cast<double>(most_own) + commit_budget_us / us_per_refit + 6;
      ASSERT_LE(static_cast<double>(after.refits - before.refits), most_refits) << frame;
      ASSERT_LE(after.rebuild_us - before.rebuild_us, commit_budget_us + longest_step_us + us_per_refit * most_refits)
          << frame;
    }
    EXPECT_GE(model.maintenance_stats().rebuilt_triangles, 2 * grid_side * grid_side);  // often enough
    EXPECT_EQ(never_rebuilt.maintenance_stats().whole_passes, 1U);                      // the first move
  }
}

TEST(RealTime, CountsWholePasses) {
  const Mesh mesh = scenes::grid(grid_side, grid_side, 0, 0, 1, 1);
  std::vector<Vec3> positions = mesh.positions();
  Model model(mesh, {.motion_margin = 0.5, .rebuild_policy = RebuildPolicy::off});
  EXPECT_EQ(model.maintenance_stats().whole_passes, 0U);
  std::uint64_t last = 0;
  const auto passes = [&] {
    model.commit();
    const std::uint64_t now = model.maintenance_stats().whole_passes;
    return now - std::exchange(last, now);
  };
  const auto move = [&](VertexId v, double z) {
    const std::vector<VertexId> ids{v};
    const std::vector<Vec3> to{{positions[v].x, positions[v].y, z}};
    ASSERT_TRUE(static_cast<bool>(model.move_vertices(ids, to)));
  };
  move(5, 1);
  EXPECT_EQ(passes(), 2U);  // positions at the last refit, and the index of vertices
  move(6, 1);
  EXPECT_EQ(passes(), 0U);
  for (Vec3& p : positions) p.z = 0.25;
  ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
  EXPECT_EQ(passes(), 1U);  // looks at all vertices
  for (Vec3& p : positions) p.z = 9;
  ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
  EXPECT_EQ(passes(), 2U);  // fits the tree too
  model.set_motion_margin(0.125);
  move(7, 9);
  EXPECT_EQ(passes(), 1U);
}

TEST(RealTime, WritesTheTreeInAnotherUnitInSmallSteps) {
  // One vertex flies away, so that the model is 4000 times as large, and comes back.
  constexpr double size = 51;
  Model model(scenes::grid(grid_side, grid_side, 0, 0, 1, 1), ModelOptions::real_time(commit_budget_us));
  const double unit = tree_of(model).unit;
  Rng rng(85);
  const std::vector<VertexId> flier{7};
  int frame = 0;
  const auto moves_until = [&](double height, double wanted_unit) {
    for (const int end = frame + 1000; frame < end && tree_of(model).unit != wanted_unit; ++frame) {
      move_some(model, rng, false);
      const std::vector<Vec3> to{{0, 0, height}};
      ASSERT_TRUE(static_cast<bool>(model.move_vertices(flier, to)));
      model.commit();
      ASSERT_EQ(model.maintenance_stats().whole_passes, 0U) << frame;
    }
    EXPECT_EQ(tree_of(model).unit, wanted_unit);
    EXPECT_TRUE(static_cast<bool>(model.validate()));
  };
  moves_until(4000 * size, 0x1p18);
  moves_until(0, unit);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "update/rebuild_scheduler.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

#include "scenes/motions.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using update::RebuildScheduler;

/// A tree whose triangles have changed places since it was built.
struct Degraded {
  explicit Degraded(std::uint32_t triangles = 2000) : mesh(scenes::shuffled_soup(triangles).mesh) {
    Rng rng(510);
    std::vector<Vec3> positions = mesh.positions();
    for (std::size_t v = 0; v < positions.size(); v += 3) {
      const Vec3 by = 20 * uniform_point(rng);
      for (std::size_t k = v; k < v + 3; ++k) positions[k] = positions[k] + by;
    }
    mesh.set_positions(positions).value();
    bvh::fit(tree, mesh);
  }
  /// Puts the refitted bounds where the scheduler has changed the assignment.
  void finish(RebuildScheduler& rebuilds) {
    bvh::fit(tree, mesh);
    rebuilds.judge(tree, stats);
  }
  bool is_sound() const { return static_cast<bool>(validate(tree, mesh)); }

  Mesh mesh;
  bvh::Tree tree = bvh::build(mesh);
  bvh::Tree built = tree;
  MaintenanceStats stats;
};

constexpr double long_ns = 1e12;

TEST(RebuildScheduler, DoesNothingToATreeAsBuilt) {
  const Mesh mesh = scenes::shuffled_soup(2000).mesh;
  bvh::Tree tree = bvh::build(mesh);
  RebuildScheduler rebuilds(tree, RebuildPolicy::in_commit, {});
  rebuilds.schedule(tree, mesh);
  EXPECT_FALSE(rebuilds.advance(tree, mesh, long_ns).has_value());
}

TEST(RebuildScheduler, RebuildsWhatHasDegraded) {
  Degraded model;
  RebuildScheduler rebuilds(model.built, RebuildPolicy::in_commit, {});
  const bvh::Subtree all = bvh::subtree_of(model.tree, bvh::root);
  const double cost_before = bvh::TreeCost::of(model.tree, all);
  const std::uint64_t id_before = model.tree.assignment_id;
  EXPECT_FALSE(rebuilds.advance(model.tree, model.mesh, long_ns).has_value());  // idle
  rebuilds.schedule(model.tree, model.mesh);
  ASSERT_TRUE(rebuilds.advance(model.tree, model.mesh, long_ns).has_value());
  EXPECT_NE(model.tree.assignment_id, id_before);
  model.finish(rebuilds);
  EXPECT_TRUE(model.is_sound());
  EXPECT_LT(bvh::TreeCost::of(model.tree, all), cost_before / 2);
  EXPECT_GT(model.stats.rebuilt_triangles, 0U);
  EXPECT_FALSE(rebuilds.advance(model.tree, model.mesh, long_ns).has_value());  // idle again
}

TEST(RebuildScheduler, SpreadsTheWorkOverAsManyCommitsAsTheBudgetNeeds) {
  int previous = 0;
  for (const double budget_us : {1e9, 1000.0, 10.0}) {
    Degraded model(40'000);  // so many that they are not partitioned at once
    RebuildScheduler rebuilds(model.built, RebuildPolicy::in_commit, budget_us);
    rebuilds.schedule(model.tree, model.mesh);
    int commits = 1;
    while (!rebuilds.advance(model.tree, model.mesh, 0) && commits < 100'000) ++commits;
    EXPECT_GT(commits, previous) << budget_us;
    previous = commits;
    model.finish(rebuilds);
    EXPECT_TRUE(model.is_sound());
  }
}

TEST(RebuildScheduler, DoesNothingWithoutPolicyOrBudget) {
  for (const bool has_policy : {false, true}) {
    Degraded model;
    RebuildScheduler rebuilds(model.built, has_policy ? RebuildPolicy::in_commit : RebuildPolicy::off,
                              has_policy ? std::optional<double>(0) : std::nullopt);
    rebuilds.schedule(model.tree, model.mesh);
    EXPECT_FALSE(rebuilds.advance(model.tree, model.mesh, long_ns).has_value());
  }
}

TEST(RebuildScheduler, RebuildsAllWhateverThePolicy) {
  for (const RebuildPolicy policy : {RebuildPolicy::off, RebuildPolicy::in_commit, RebuildPolicy::on_worker}) {
    Degraded model;
    RebuildScheduler rebuilds(model.built, policy, 0);
    rebuilds.rebuild_all(model.tree, model.mesh);
    const std::optional<bvh::Subtree> rebuilt = rebuilds.advance(model.tree, model.mesh, 0);
    ASSERT_TRUE(rebuilt.has_value());
    EXPECT_EQ(rebuilt->slot, bvh::root);
    EXPECT_EQ(rebuilt->end_leaf, model.tree.leaves.size());
    model.finish(rebuilds);
    EXPECT_TRUE(model.is_sound());
    EXPECT_EQ(model.stats.rebuilt_triangles, 8 * model.tree.leaves.size());
  }
}

TEST(RebuildScheduler, LetsAWorkerRebuild) {
  Degraded model;
  RebuildScheduler rebuilds(model.built, RebuildPolicy::on_worker, {});
  rebuilds.schedule(model.tree, model.mesh);
  std::optional<bvh::Subtree> rebuilt;
  for (int i = 0; i < 60'000 && !rebuilt; ++i) {
    rebuilt = rebuilds.advance(model.tree, model.mesh, 0);
    if (!rebuilt) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_TRUE(rebuilt.has_value());
  model.finish(rebuilds);
  EXPECT_TRUE(model.is_sound());
}

TEST(RebuildScheduler, CountsPassesInRefits) {
  Degraded model;
  RebuildScheduler rebuilds(model.built, RebuildPolicy::in_commit, {});
  const std::uint64_t nodes = model.tree.nodes.size();
  EXPECT_TRUE(rebuilds.count_refits(model.tree, 1));  // the first look comes at once
  EXPECT_FALSE(rebuilds.count_refits(model.tree, nodes - 1));
  EXPECT_TRUE(rebuilds.count_refits(model.tree, 1));
}

TEST(RebuildScheduler, RebuildsTheWholeTreeAfterManyPassesWhateverItsCost) {
  const Mesh mesh = scenes::shuffled_soup(2000).mesh;
  bvh::Tree tree = bvh::build(mesh);
  RebuildScheduler rebuilds(tree, RebuildPolicy::in_commit, {});
  int passes = 0;
  std::optional<bvh::Subtree> rebuilt;
  for (; passes < 1000 && !rebuilt; ++passes) {
    rebuilds.count_refits(tree, tree.nodes.size());
    rebuilds.schedule(tree, mesh);
    rebuilt = rebuilds.advance(tree, mesh, long_ns);
  }
  ASSERT_TRUE(rebuilt.has_value());
  EXPECT_EQ(rebuilt->slot, bvh::root);
  EXPECT_EQ(passes, 32);
}

}  // namespace
}  // namespace limber::testing

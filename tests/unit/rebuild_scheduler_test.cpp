// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "model/rebuild_scheduler.h"

#include <gtest/gtest.h>

#include <chrono>
#include <optional>
#include <thread>
#include <vector>

#include "bvh/refit.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using model::RebuildScheduler;

/// A tree whose triangles have changed places since it was built, and what rebuilds it.
struct Degraded {
  explicit Degraded(RebuildPolicy policy, std::optional<double> budget_us, std::uint32_t triangles = 2000)
      : mesh(scenes::shuffled_soup(triangles).mesh), tree(bvh::build(mesh)), rebuilds(tree, policy, budget_us) {
    Rng rng(510);
    std::vector<Vec3> positions = mesh.positions();
    for (std::size_t v = 0; v < positions.size(); v += 3) {
      const Vec3 by = 20 * uniform_point(rng);
      for (std::size_t k = v; k < v + 3; ++k) positions[k] = positions[k] + by;
    }
    mesh.set_positions(positions).value();
    bvh::fit(tree, mesh);
  }

  /// As much of a survey as that many refits are worth; starts a rebuild if that is due.
  bool survey(std::uint64_t refits) { return rebuilds.count_refits(tree, mesh, refits); }
  bool survey() { return survey(tree.nodes.size()); }
  /// A commit at rest. Returns whether the tree was rebuilt.
  bool commit(double own_ns = long_ns) {
    const bool is_rebuilt = rebuilds.advance(tree, mesh, mesh, dirty, own_ns, stats);
    bvh::refit(tree, mesh, dirty);
    return is_rebuilt;
  }
  bool is_sound() const { return static_cast<bool>(validate(tree, mesh)); }
  double cost() const { return bvh::TreeCost::of(tree, bvh::subtree_of(tree, bvh::root)); }

  static constexpr double long_ns = 1e12;
  Mesh mesh;
  bvh::Tree tree;
  bvh::DirtySet dirty{tree};
  RebuildScheduler rebuilds;
  MaintenanceStats stats;
};

TEST(RebuildScheduler, RebuildsWhatHasDegraded) {
  Degraded model(RebuildPolicy::in_commit, {});
  const double cost_before = model.cost();
  const std::uint64_t id_before = model.tree.build_id;
  EXPECT_FALSE(model.commit());  // idle
  EXPECT_TRUE(model.survey());
  ASSERT_TRUE(model.commit());
  EXPECT_NE(model.tree.build_id, id_before);
  EXPECT_TRUE(model.is_sound());
  EXPECT_LT(model.cost(), cost_before / 2);
  EXPECT_GT(model.stats.rebuilt_triangles, 0U);
  EXPECT_GT(model.stats.rebuild_us, 0);
  const MaintenanceStats before = model.stats;
  EXPECT_FALSE(model.commit());  // compares what it has gained
  EXPECT_GT(model.stats.rebuild_us, before.rebuild_us);
  EXPECT_TRUE(model.survey());
  EXPECT_FALSE(model.commit());  // idle again: the cost is as expected now
}

TEST(RebuildScheduler, SpreadsTheWorkOverAsManyCommitsAsTheBudgetNeeds) {
  constexpr double step_us = 6;
  int previous = 0;
  for (const double budget_us : {1e9, 1000.0, 10.0, 0.1}) {
    Degraded model(RebuildPolicy::in_commit, budget_us, 10'000);
    model.survey();
    int commits = 0;
    double before = 0;
    for (bool is_rebuilt = false; !is_rebuilt; before = model.stats.rebuild_us) {
      is_rebuilt = model.commit(0);
      ASSERT_LE(model.stats.rebuild_us - before, budget_us + step_us);
      ASSERT_LT(++commits, 1'000'000);
    }
    EXPECT_GT(commits, previous) << budget_us;
    previous = commits;
    EXPECT_TRUE(model.is_sound());
  }
}

TEST(RebuildScheduler, DoesNothingWithoutPolicyOrBudget) {
  for (const RebuildPolicy policy : {RebuildPolicy::off, RebuildPolicy::in_commit, RebuildPolicy::on_worker}) {
    Degraded model(policy, policy == RebuildPolicy::off ? std::nullopt : std::optional<double>(0));
    EXPECT_TRUE(model.survey());
    EXPECT_FALSE(model.commit());
    EXPECT_EQ(model.stats.rebuild_us, 0);
  }
}

TEST(RebuildScheduler, SurveysOnceAPassInProportionToRefits) {
  Degraded model(RebuildPolicy::off, {}, 40'000);
  const std::uint64_t nodes = model.tree.nodes.size();
  std::uint64_t refits = 0;
  while (!model.survey(8)) refits += 8;  // the first survey begins at once
  EXPECT_GT(refits, nodes / 6);
  EXPECT_LT(refits, nodes / 3);
  while (!model.survey(8)) refits += 8;
  EXPECT_GT(refits, nodes);
  EXPECT_LT(refits, nodes + nodes / 3);
  EXPECT_TRUE(model.survey(nodes));  // at once where the whole tree is refitted
}

TEST(RebuildScheduler, DoesNotGoOnWithASurveyOfTheTreeThatWas) {
  Degraded model(RebuildPolicy::in_commit, {}, 20'000);
  const std::uint64_t nodes = model.tree.nodes.size();
  ASSERT_TRUE(model.survey());  // starts a rebuild
  for (std::uint64_t refits = 0; refits < nodes + nodes / 8; refits += 8) ASSERT_FALSE(model.survey(8));
  ASSERT_TRUE(model.commit());  // takes over in the midst of the next survey
  const std::uint64_t rebuilt = model.stats.rebuilt_triangles;
  for (int i = 0; i < 10; ++i) {
    model.survey();
    EXPECT_FALSE(model.commit());
  }
  EXPECT_EQ(model.stats.rebuilt_triangles, rebuilt);
}

TEST(RebuildScheduler, RebuildsTheWholeTreeAfterManyPassesWhateverItsCost) {
  const Mesh mesh = scenes::shuffled_soup(2000).mesh;
  bvh::Tree tree = bvh::build(mesh);
  bvh::DirtySet dirty(tree);
  MaintenanceStats stats;
  RebuildScheduler rebuilds(tree, RebuildPolicy::in_commit, {});
  int passes = 0;
  for (bool is_rebuilt = false; passes < 1000 && !is_rebuilt; ++passes) {
    rebuilds.count_refits(tree, mesh, tree.nodes.size());
    is_rebuilt = rebuilds.advance(tree, mesh, mesh, dirty, Degraded::long_ns, stats);
    bvh::refit(tree, mesh, dirty);
  }
  EXPECT_EQ(stats.rebuilt_triangles, 8 * tree.leaves.size());
  EXPECT_EQ(passes, 32);
}

}  // namespace
}  // namespace limber::testing

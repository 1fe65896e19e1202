// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/rebuild.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "bvh/refit.h"
#include "model/rebuild_scheduler.h"
#include "scenes/motions.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using base::WorkBudget;
using bvh::Rebuild;
using Stage = Rebuild::Stage;

/// A tree over vertices that move between the steps of a rebuild.
class Moving {
 public:
  explicit Moving(const Mesh& mesh) : positions_(mesh.positions()), triangles_(mesh.triangles()) {
    dirty_.try_index_vertices(tree_, positions_.size());
  }

  MeshView mesh() const { return {positions_, triangles_}; }
  bvh::Tree& tree() { return tree_; }
  bvh::DirtySet& dirty() { return dirty_; }

  /// The position of a vertex, to be changed.
  Vec3& moved(VertexId v) {
    dirty_.add(v);
    return positions_[v];
  }
  void move(VertexId first, VertexId count) {
    for (VertexId v = first; v < first + count; ++v) moved(v) += 0.02 * uniform_point(rng_);
  }
  /// Gives every piece of confetti the place of another one.
  void mix() {
    for (std::size_t piece = triangles_.size() - 1; piece > 0; --piece) {
      const std::size_t other = rng_.below(piece + 1);
      for (std::size_t k = 0; k < 3; ++k) std::swap(positions_[3 * piece + k], positions_[3 * other + k]);
    }
    dirty_.add_all();
    refit();
  }
  void refit() { bvh::refit(tree_, mesh(), dirty_); }
  bool is_sound() const { return static_cast<bool>(validate(tree_, mesh())); }

  /// One commit: moves some vertices, goes on with the rebuild, refits. Returns whether the tree has been taken over.
  bool commit(Rebuild& rebuild, VertexId first, VertexId count, double ns) {
    move(first, count);
    WorkBudget budget(ns);
    const double beside_ns = rebuild.ns_beyond_budget();
    budget.add(beside_ns);
    bool has_taken_over = false;
    while (!budget.is_spent() && rebuild.stage() != Stage::idle && !has_taken_over) {
      has_taken_over = rebuild.can_take_over(tree_, dirty_, std::max(0.0, budget.left_ns() - beside_ns));
      if (has_taken_over) {
        rebuild.take_over(tree_, dirty_);
      } else {
        rebuild.work(tree_, mesh(), budget);
        if (rebuild.stage() == Stage::fitting) dirty_.set_follower(&rebuild.dirty());
      }
    }
    if (rebuild.stage() == Stage::fitting) rebuild.dirty().start_interval();
    refit();
    return has_taken_over;
  }

 private:
  std::vector<Vec3> positions_;
  std::vector<Corners> triangles_;
  bvh::Tree tree_{bvh::build(mesh())};
  bvh::DirtySet dirty_{tree_};
  Rng rng_{17};
};

Moving moving_soup(std::uint32_t triangles) { return Moving(scenes::shuffled_soup(triangles).mesh); }

/// The leaves' triangles, each leaf's in order.
std::vector<std::vector<TriangleId>> assignment(const bvh::Tree& tree) {
  std::vector<std::vector<TriangleId>> leaves;
  for (const bvh::Leaf& leaf : tree.leaves) {
    leaves.emplace_back(leaf.triangle, leaf.triangle + bvh::width);
    std::sort(leaves.back().begin(), leaves.back().end());
  }
  return leaves;
}

TEST(Refit, FitsTheSphereOfTheRootToTheLevelsBelowItsChildren) {
  // Small triangles that fill a square. Those at its corners decide how large the root's sphere is, and not always
  // change the volumes of its children.
  Rng rng(901);
  std::vector<Triangle> triangles;
  for (int i = 0; i < 2000; ++i) {
    const auto at = [&](double x, double y) {
      return Vec3{x + rng.uniform(-0.05, 0.05), y + rng.uniform(-0.05, 0.05), 0};
    };
    const double x = rng.uniform(-1, 1), y = rng.uniform(-1, 1);
    triangles.push_back({at(x, y), at(x, y), at(x, y)});
  }
  Moving moving(soup(triangles));
  for (int i = 0; i < 300; ++i) {
    VertexId farthest = 0;
    const std::span<const Vec3> positions = moving.mesh().positions;
    for (VertexId v = 0; v < positions.size(); ++v) {
      if (length(positions[v]) > length(positions[farthest])) farthest = v;
    }
    Vec3& p = moving.moved(farthest);
    p = p * rng.uniform(0.7, 1);
    ASSERT_FALSE(moving.dirty().covers_most_of(moving.tree()));
    moving.refit();
    const auto valid = bvh::validate(moving.tree(), moving.mesh());
    ASSERT_TRUE(static_cast<bool>(valid)) << i << ": " << valid.error().text;
    bvh::Tree fitted = moving.tree();
    bvh::fit(fitted, moving.mesh());
    const float radius = fitted.nodes[0].bounds.radius[0];
    ASSERT_NEAR(moving.tree().nodes[0].bounds.radius[0], radius, 1e-5F * radius) << i;
  }
}

TEST(Refit, KeepsOriginsOfNodesAmongTheirTriangles) {
  // Float32 numbers relative to an origin lose precision in proportion to its distance.
  Moving moving(scenes::grid(40, 40, 0, 0, 1, 1));
  const auto count = static_cast<VertexId>(moving.mesh().positions.size());
  for (VertexId begin = 0; begin < count; begin += 100) {
    for (VertexId v = begin; v < std::min(begin + 100, count); ++v) moving.moved(v).x += 2e4;
    ASSERT_FALSE(moving.dirty().covers_most_of(moving.tree()));
    moving.refit();
  }
  for (std::uint32_t n = 0; n < moving.tree().first_lowest_node(); ++n) {
    const bvh::Node& node = moving.tree().nodes[n];
    const float largest = *std::max_element(node.bounds.radius, node.bounds.radius + node.child_count);
    const Vec3 from_origin = moving.tree().nodes[node.first_child].origin - node.origin;
    EXPECT_LE(max_abs(from_origin), 65 * moving.tree().unit * static_cast<double>(largest)) << n;
  }
}

TEST(Rebuild, OfEverythingAtRestGivesTheTreeThatIsBuilt) {
  const scenes::Motion soup = scenes::shuffled_soup(5000);
  const std::vector<Vec3> positions = soup.positions(300);
  Mesh mesh = soup.mesh;
  bvh::Tree tree = bvh::build(mesh);
  mesh.set_positions(positions).value();
  bvh::fit(tree, mesh);
  bvh::DirtySet dirty(tree);
  Rebuild rebuild;
  rebuild.start(tree, mesh, bvh::subtree_of(tree, bvh::root_slot));
  EXPECT_EQ(rebuild.stage(), Stage::gathering);
  WorkBudget unlimited = WorkBudget::unlimited();
  rebuild.work(tree, mesh, unlimited);
  EXPECT_EQ(rebuild.stage(), Stage::assigning);
  rebuild.work(tree, mesh, unlimited);
  EXPECT_EQ(rebuild.stage(), Stage::fitting);
  EXPECT_FALSE(rebuild.can_take_over(tree, dirty, 1e9));
  rebuild.work(tree, mesh, unlimited);
  ASSERT_TRUE(rebuild.can_take_over(tree, dirty, 0));
  const std::uint64_t id = tree.build_id;
  rebuild.take_over(tree, dirty);
  EXPECT_EQ(rebuild.stage(), Stage::idle);
  EXPECT_NE(tree.build_id, id);
  EXPECT_TRUE(dirty.empty());
  EXPECT_TRUE(dirty.has_vertex_index());
  EXPECT_TRUE(static_cast<bool>(validate(tree, mesh)));
  EXPECT_EQ(assignment(tree), assignment(bvh::build(mesh)));
}

TEST(Rebuild, KeepsUpWithMovesBetweenItsSteps) {
  for (const double ns : {300.0, 3000.0, 1e5}) {
    SCOPED_TRACE(ns);
    Moving model = moving_soup(4000);
    const VertexId vertices = static_cast<VertexId>(model.mesh().positions.size());
    Rebuild rebuild;
    VertexId first = 0;
    for (int round = 0; round < 3; ++round) {  // in the memory of the first
      rebuild.start(model.tree(), model.mesh(), bvh::subtree_of(model.tree(), bvh::root_slot));
      int commits = 0;
      // Some vertices move in every commit, others once.
      while (!model.commit(rebuild, first, 20, ns)) {
        first = (first + 7) % (vertices - 20);
        ASSERT_LT(++commits, 100'000);
      }
      ASSERT_TRUE(model.is_sound());
      EXPECT_TRUE(model.dirty().has_vertex_index());
      for (int i = 0; i < 30; ++i) {
        model.commit(rebuild, first, 20, ns);
        first = (first + 7) % (vertices - 20);
        ASSERT_TRUE(model.is_sound()) << i;  // by the index that came with the tree
      }
    }
  }
}

TEST(Rebuild, CatchesUpThoughWhatMovesTogetherIsScatteredInTheNewTree) {
  // In the old tree the pieces that move in one commit are neighbours, in the new one they are everywhere.
  constexpr VertexId pieces = 6000, moved = 60;
  std::vector<Triangle> confetti;
  for (VertexId i = 0; i < pieces; ++i) {
    const double x = 0.05 * i;
    confetti.push_back({{x, 0, 0}, {x + 0.01, 0, 0}, {x, 0.01, 0}});
  }
  Moving model(soup(confetti));
  model.mix();
  Rebuild rebuild;
  rebuild.start(model.tree(), model.mesh(), bvh::subtree_of(model.tree(), bvh::root_slot));
  VertexId first = 0;
  int commits = 0;
  for (; !model.commit(rebuild, first, 3 * moved, 1000); first = (first + 3 * moved) % (3 * pieces)) {
    ASSERT_LT(++commits, 10'000);
  }
  EXPECT_GT(commits, 300);
  EXPECT_TRUE(model.is_sound());
}

TEST(Rebuild, OfASubtreeLeavesTheOthersAsTheyAre) {
  Moving model = moving_soup(9000);
  const bvh::Subtree subtree = bvh::subtree_of(model.tree(), bvh::width + 1);
  ASSERT_GT(subtree.first_leaf, 0U);
  ASSERT_LT(subtree.end_leaf, model.tree().leaves.size());
  const auto before = assignment(model.tree());
  for (int i = 0; i < 5; ++i) {
    model.move(0, static_cast<VertexId>(model.mesh().positions.size()));
    model.refit();
  }
  Rebuild rebuild;
  rebuild.start(model.tree(), model.mesh(), subtree);
  while (!model.commit(rebuild, 5, 3, 2000)) {
  }
  EXPECT_TRUE(model.is_sound());
  const auto after = assignment(model.tree());
  std::vector<TriangleId> mine_before, mine_after;
  for (std::uint32_t leaf = 0; leaf < after.size(); ++leaf) {
    if (leaf < subtree.first_leaf || leaf >= subtree.end_leaf) {
      ASSERT_EQ(after[leaf], before[leaf]);
    } else {
      mine_before.insert(mine_before.end(), before[leaf].begin(), before[leaf].end());
      mine_after.insert(mine_after.end(), after[leaf].begin(), after[leaf].end());
    }
  }
  EXPECT_NE(mine_after, mine_before);
  std::sort(mine_before.begin(), mine_before.end());
  std::sort(mine_after.begin(), mine_after.end());
  EXPECT_EQ(mine_after, mine_before);
}

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
  double cost() const { return bvh::TreeCost::of(tree, bvh::subtree_of(tree, bvh::root_slot)); }

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/rebuild.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "bvh/refit.h"
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

  void move(VertexId first, VertexId count) {
    for (VertexId v = first; v < first + count; ++v) {
      positions_[v] = positions_[v] + 0.02 * uniform_point(rng_);
      dirty_.add(v);
    }
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
    const double beside_ns = rebuild.ns_beside_budget();
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

Moving moving_soup(std::uint32_t triangles) {
  scenes::Motion soup = scenes::shuffled_soup(triangles);
  return Moving(soup.mesh);
}

/// The leaves' triangles, each leaf's in order.
std::vector<std::vector<TriangleId>> assignment(const bvh::Tree& tree) {
  std::vector<std::vector<TriangleId>> leaves;
  for (const bvh::Leaf& leaf : tree.leaves) {
    leaves.emplace_back(leaf.triangle, leaf.triangle + bvh::width);
    std::sort(leaves.back().begin(), leaves.back().end());
  }
  return leaves;
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
  rebuild.start(tree, mesh, bvh::subtree_of(tree, bvh::root));
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
      rebuild.start(model.tree(), model.mesh(), bvh::subtree_of(model.tree(), bvh::root));
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
  rebuild.start(model.tree(), model.mesh(), bvh::subtree_of(model.tree(), bvh::root));
  VertexId first = 0;
  int commits = 0;
  for (; !model.commit(rebuild, first, 3 * moved, 1000); first = (first + 3 * moved) % (3 * pieces)) {
    ASSERT_LT(++commits, 10'000);
  }
  EXPECT_GT(commits, 300);
  EXPECT_TRUE(model.is_sound());
}

TEST(Rebuild, TakesOverWhenACommitFitsTheWholeTreeAnyway) {
  Moving model = moving_soup(4000);
  Rebuild rebuild;
  rebuild.start(model.tree(), model.mesh(), bvh::subtree_of(model.tree(), bvh::root));
  WorkBudget unlimited = WorkBudget::unlimited();
  while (rebuild.stage() != Stage::fitting) rebuild.work(model.tree(), model.mesh(), unlimited);
  model.dirty().set_follower(&rebuild.dirty());
  model.move(0, static_cast<VertexId>(model.mesh().positions.size()));
  ASSERT_TRUE(rebuild.can_take_over(model.tree(), model.dirty(), 0));  // before anything was fitted
  rebuild.take_over(model.tree(), model.dirty());
  model.refit();
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

TEST(Rebuild, StopsAndStartsAnew) {
  Moving model = moving_soup(2000);
  const bvh::Subtree all = bvh::subtree_of(model.tree(), bvh::root);
  Rebuild rebuild;
  for (int steps = 1; steps < 400; steps += 13) {
    rebuild.start(model.tree(), model.mesh(), all);
    for (int i = 0; i < steps && rebuild.stage() != Stage::idle; ++i) model.commit(rebuild, 5, 3, 500);
    rebuild.stop();
    model.dirty().set_follower(nullptr);
    ASSERT_TRUE(model.is_sound());
  }
  rebuild.start(model.tree(), model.mesh(), all);
  while (!model.commit(rebuild, 5, 3, 1e6)) {
  }
  EXPECT_TRUE(model.is_sound());
}

}  // namespace
}  // namespace limber::testing

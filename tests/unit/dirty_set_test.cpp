// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
// The nodes that a commit refits, and the motion that needs no refit.
#include "bvh/refit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "model/tree_updater.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using bvh::DirtySet;
using model::MotionMargin;
using Nodes = std::vector<std::uint32_t>;

/// The lowest nodes that have a triangle at a vertex, found by going through all of them.
Nodes nodes_at(const bvh::Tree& tree, VertexId vertex) {
  std::set<std::uint32_t> nodes;
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    const bvh::Node& node = tree.nodes[n];
    for (std::uint32_t leaf = node.first_child; leaf < node.first_child + node.child_count; ++leaf) {
      for (const auto& corners : tree.leaves[leaf].vertices) {
        if (std::find(corners.begin(), corners.end(), vertex) != corners.end()) nodes.insert(n);
      }
    }
  }
  return {nodes.begin(), nodes.end()};
}

struct Sheet {
  Mesh mesh = scenes::grid(40, 40, 0, 0, 1, 1);
  bvh::Tree tree = bvh::build(mesh);
  std::size_t vertex_count = mesh.positions().size();
  std::size_t lowest = tree.level_begin.size() - 2;  // level

  DirtySet dirty_set() const {
    DirtySet dirty(tree);
    EXPECT_TRUE(dirty.try_index_vertices(tree, vertex_count));
    return dirty;
  }
  Vec3 position(VertexId v) const { return mesh.positions()[v]; }
  void move(VertexId v, const Vec3& by) { mesh.set_position(v, position(v) + by).value(); }
  void move_all(const Vec3& by) {
    for (VertexId v = 0; v < vertex_count; ++v) move(v, by);
  }
};

TEST(DirtySet, MarksTheLowestNodesAtAVertexOnce) {
  const Sheet sheet;
  DirtySet dirty(sheet.tree);
  EXPECT_TRUE(dirty.empty());
  EXPECT_FALSE(dirty.has_vertex_index());
  ASSERT_TRUE(dirty.try_index_vertices(sheet.tree, sheet.vertex_count));
  std::size_t most = 0;
  for (VertexId v = 0; v < sheet.vertex_count; ++v) {
    dirty.add(v);
    dirty.add(v);
    dirty.sort_lowest();
    EXPECT_EQ(dirty.nodes(sheet.lowest), nodes_at(sheet.tree, v)) << v;
    most = std::max(most, dirty.nodes(sheet.lowest).size());
    EXPECT_FALSE(dirty.empty());
    dirty.clear();
    EXPECT_TRUE(dirty.empty());
  }
  EXPECT_GE(most, 2U);  // otherwise no vertex was at the border of two nodes
}

TEST(DirtySet, LetsAnotherSetFollow) {
  const Sheet sheet;
  DirtySet dirty = sheet.dirty_set(), follower = sheet.dirty_set();
  dirty.set_follower(&follower);
  dirty.add(7);
  EXPECT_EQ(follower.nodes(sheet.lowest), dirty.nodes(sheet.lowest));
  EXPECT_FALSE(follower.empty());
  const std::size_t marked = follower.marked_count();
  EXPECT_EQ(marked, dirty.nodes(sheet.lowest).size());
  dirty.add(7);
  EXPECT_EQ(follower.marked_count(), marked);
  follower.start_interval();
  EXPECT_EQ(follower.marked_count(), 0U);
  dirty.add(7);
  EXPECT_EQ(follower.marked_count(), marked);  // though they were dirty before
  dirty.clear();
  EXPECT_FALSE(follower.empty());  // it is refitted on its own
  follower.clear();
  dirty.add_all();
  EXPECT_TRUE(follower.covers_most_of(sheet.tree));
  follower.clear();
  dirty.set_follower(nullptr);
  dirty.add(7);
  dirty.add_all();
  EXPECT_TRUE(follower.empty());
}

TEST(DirtySet, GivesNodesAwayAsCleanOnes) {
  const Sheet sheet;
  DirtySet dirty = sheet.dirty_set();
  const Nodes expected = nodes_at(sheet.tree, 41);
  Nodes taken;
  taken.reserve(sheet.tree.nodes.size());
  dirty.add(41);
  dirty.take_lowest(taken);
  EXPECT_EQ(taken, expected);
  EXPECT_TRUE(dirty.empty());
  dirty.add(41);  // they can become dirty again
  EXPECT_EQ(dirty.nodes(sheet.lowest), expected);
  while (!dirty.empty()) dirty.take_node(sheet.lowest);
  dirty.add_node(0, 0);
  EXPECT_EQ(dirty.take_node(0), 0U);
  EXPECT_TRUE(dirty.nodes(0).empty());
  dirty.add(41);
  EXPECT_EQ(dirty.nodes(sheet.lowest), expected);
}

TEST(DirtySet, CoversMostOfTheTreeOnceThreeQuartersAreDirty) {
  const Sheet sheet;
  DirtySet dirty(sheet.tree);
  const std::size_t count = sheet.tree.nodes.size() - sheet.tree.first_lowest_node();
  for (std::size_t i = 0; i < count; ++i) {
    EXPECT_EQ(dirty.covers_most_of(sheet.tree), 4 * i > 3 * count) << i;
    dirty.add_node(sheet.lowest, sheet.tree.first_lowest_node() + static_cast<std::uint32_t>(i));
  }
  dirty.clear();
  EXPECT_FALSE(dirty.covers_most_of(sheet.tree));
  dirty.add_all();
  EXPECT_TRUE(dirty.covers_most_of(sheet.tree));
  EXPECT_FALSE(dirty.empty());
  dirty.clear();
  EXPECT_TRUE(dirty.empty());
}

// --- what a motion margin absorbs ---

struct StartedMargin : ::testing::Test {
  Sheet sheet;
  DirtySet dirty = sheet.dirty_set();
  MotionMargin margin;

  StartedMargin() { margin.start(sheet.mesh.positions()); }
  const Vec3& fitted(VertexId v) const { return margin.fitted_mesh(sheet.mesh).positions[v]; }
};

TEST_F(StartedMargin, KeepsThePositionsUntilItIsStopped) {
  EXPECT_FALSE(MotionMargin().is_on());
  EXPECT_TRUE(margin.is_on());
  EXPECT_EQ(margin.slack(), 0);
  sheet.move(7, {0, 0, 1});
  EXPECT_EQ(fitted(7).z, 0);
  margin.stop();
  EXPECT_FALSE(margin.is_on());
  EXPECT_EQ(margin.fitted_mesh(sheet.mesh).positions.data(), sheet.mesh.positions().data());
}

TEST_F(StartedMargin, AbsorbsUpToTheMarginAndRefitsBeyond) {
  const VertexId near = 3, far = 900;
  sheet.move(near, {0, 0, 0.25});
  sheet.move(far, {0, 0, std::nextafter(0.25, 1)});
  const std::vector<VertexId> ids{near, far};
  margin.mark_beyond(sheet.mesh, ids, 0.25, dirty);
  EXPECT_EQ(margin.absorbed_count(), 1U);
  EXPECT_EQ(fitted(near).z, 0);
  EXPECT_EQ(fitted(far), sheet.position(far));
  EXPECT_GE(margin.slack(), 0.25);
  EXPECT_LT(margin.slack(), 0.25 * (1 + 1e-9));
  EXPECT_EQ(dirty.nodes(sheet.lowest), nodes_at(sheet.tree, far));
  // The bounds of the positions at the last refit, and the largest displacement, hold the mesh.
  refit(sheet.tree, margin.fitted_mesh(sheet.mesh), dirty);
  EXPECT_TRUE(static_cast<bool>(validate(sheet.tree, margin.fitted_mesh(sheet.mesh))));
  margin.clear_counts();
  EXPECT_EQ(margin.absorbed_count(), 0U);
}

TEST_F(StartedMargin, MeasuresDisplacementsAnewWhenAllHaveMoved) {
  sheet.move(5, {0, 0, 0.5});
  const std::vector<VertexId> ids(sheet.mesh.positions().size() + 1, 5);
  margin.mark_beyond(sheet.mesh, ids, 1, dirty);
  EXPECT_TRUE(margin.is_stale());
  sheet.move(5, {0, 0, -0.5});
  EXPECT_GE(margin.slack(), 0.5);
  sheet.move_all({0, 0, 0.125});
  EXPECT_EQ(margin.mark_all_beyond(sheet.mesh, 1, sheet.tree, dirty), 0U);
  EXPECT_FALSE(margin.is_stale());
  EXPECT_GE(margin.slack(), 0.125);
  EXPECT_LT(margin.slack(), 0.126);
  EXPECT_TRUE(dirty.empty());
}

TEST_F(StartedMargin, RefitsSomeOrAllOfWhatHasMovedTooFar) {
  sheet.move_all({0, 0, 0.125});
  sheet.move(8, {0, 0, 3});
  EXPECT_EQ(margin.mark_all_beyond(sheet.mesh, 0.25, sheet.tree, dirty), 1U);
  EXPECT_EQ(fitted(8), sheet.position(8));
  EXPECT_EQ(fitted(9).z, 0);
  EXPECT_FALSE(dirty.covers_most_of(sheet.tree));

  sheet.move_all({0, 0, 2});
  EXPECT_EQ(margin.mark_all_beyond(sheet.mesh, 0.25, sheet.tree, dirty), sheet.mesh.positions().size());
  EXPECT_TRUE(dirty.covers_most_of(sheet.tree));
  EXPECT_EQ(margin.slack(), 0);
  EXPECT_EQ(fitted(9), sheet.position(9));
}

}  // namespace
}  // namespace limber::testing

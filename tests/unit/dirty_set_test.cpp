// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/dirty_set.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using bvh::DirtySet;
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

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/vertex_index.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <vector>

#include "scenes/motions.h"
#include "scenes/scenes.h"

namespace limber::testing {
namespace {

using base::WorkBudget;
using bvh::VertexIndex;

/// The nodes at each vertex, found without an index.
std::vector<std::set<std::uint32_t>> nodes_at_vertices(const bvh::Tree& tree, std::size_t vertex_count) {
  std::vector<std::set<std::uint32_t>> nodes(vertex_count);
  for (std::uint32_t n = tree.first_lowest_node(); n < tree.nodes.size(); ++n) {
    for (std::uint32_t k = 0; k < tree.nodes[n].child_count; ++k) {
      for (const auto& corners : tree.leaves[tree.nodes[n].first_child + k].vertices) {
        for (const VertexId v : corners) nodes[v].insert(n);
      }
    }
  }
  return nodes;
}

void expect_complete(const VertexIndex& index, const bvh::Tree& tree, std::size_t vertex_count) {
  ASSERT_TRUE(index.is_complete());
  const std::vector<std::set<std::uint32_t>> expected = nodes_at_vertices(tree, vertex_count);
  for (VertexId v = 0; v < vertex_count; ++v) {
    const auto found = index.nodes_at(v);
    ASSERT_EQ(found.size(), expected[v].size()) << v;
    ASSERT_TRUE(std::is_permutation(found.begin(), found.end(), expected[v].begin())) << v;
  }
}

TEST(VertexIndex, ListsTheLowestNodesAtEachVertexOnce) {
  for (const Mesh& mesh : {scenes::grid(1, 1, 0, 0, 1, 1), scenes::grid(40, 40, 0, 0, 1, 1), scenes::ball(32, 17),
                           scenes::shuffled_soup(3000).mesh}) {
    const bvh::Tree tree = bvh::build(mesh);
    VertexIndex index;
    EXPECT_FALSE(index.is_complete());
    index.start(mesh.positions().size());
    WorkBudget unlimited = WorkBudget::unlimited();
    EXPECT_TRUE(index.build(tree, unlimited));
    expect_complete(index, tree, mesh.positions().size());
    index.drop();
    EXPECT_FALSE(index.is_complete());
  }
}

TEST(VertexIndex, IsTheSameHoweverSmallTheSteps) {
  const Mesh mesh = scenes::grid(60, 50, 0, 0, 1, 1);
  const bvh::Tree tree = bvh::build(mesh);
  VertexIndex index;
  for (const bool reserves : {false, true}) {
    if (reserves) index.reserve(mesh.positions().size(), mesh.triangles().size());
    index.start(mesh.positions().size());
    int calls = 0;
    for (;; ++calls) {
      WorkBudget least(1e-3);
      if (index.build(tree, least)) break;
      ASSERT_FALSE(index.is_complete());
      ASSERT_LT(least.spent_ns(), 5000);  // one step
      ASSERT_LT(calls, 10'000);
    }
    EXPECT_GT(calls, 50);
    expect_complete(index, tree, mesh.positions().size());
    WorkBudget spent(0);
    index.start(mesh.positions().size());
    EXPECT_FALSE(index.build(tree, spent));
    EXPECT_EQ(spent.spent_ns(), 0);
  }
}

}  // namespace
}  // namespace limber::testing

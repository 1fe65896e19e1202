// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "bvh/refit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "bvh/tree.h"
#include "scenes/motions.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

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

TEST(VertexIndex, ListsTheLowestNodesAtEachVertexOnceHoweverSmallTheSteps) {
  for (const Mesh& mesh : {scenes::grid(1, 1, 0, 0, 1, 1), scenes::grid(60, 50, 0, 0, 1, 1), scenes::ball(32, 17),
                           scenes::shuffled_soup(3000).mesh}) {
    const bvh::Tree tree = bvh::build(mesh);
    const std::size_t vertices = mesh.positions().size();
    VertexIndex index;
    index.start(vertices);
    WorkBudget unlimited = WorkBudget::unlimited(), none(0);
    EXPECT_TRUE(index.build(tree, unlimited));
    expect_complete(index, tree, vertices);
    index.drop();
    EXPECT_FALSE(index.is_complete());
    index.reserve(vertices, mesh.triangles().size());
    index.start(vertices);
    EXPECT_FALSE(index.build(tree, none));
    EXPECT_EQ(none.spent_ns(), 0);
    std::size_t calls = 0;
    for (bool is_done = false; !is_done; ++calls) {
      ASSERT_FALSE(index.is_complete());
      WorkBudget least(1e-3);
      is_done = index.build(tree, least);
      ASSERT_LT(least.spent_ns(), 5000);  // one step
    }
    EXPECT_GT(calls, mesh.triangles().size() / 120);
    expect_complete(index, tree, vertices);
  }
}

/// A tree over vertices that move a few at a time.
struct MovingTree {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  bvh::Tree tree{bvh::build(mesh())};
  bvh::DirtySet dirty{tree};

  explicit MovingTree(const Mesh& mesh) : positions(mesh.positions()), triangles(mesh.triangles()) {
    dirty.try_index_vertices(tree, positions.size());
  }
  MeshView mesh() const { return {positions, triangles}; }
  /// The position of a vertex, to be changed.
  Vec3& moved(VertexId v) {
    dirty.add(v);
    return positions[v];
  }
  void refit() {
    ASSERT_FALSE(dirty.covers_most_of(tree));
    bvh::refit(tree, mesh(), dirty);
  }
};

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
  MovingTree moving(soup(triangles));
  for (int i = 0; i < 300; ++i) {
    VertexId farthest = 0;
    const std::vector<Vec3>& positions = moving.positions;
    for (VertexId v = 0; v < positions.size(); ++v) {
      if (length(positions[v]) > length(positions[farthest])) farthest = v;
    }
    Vec3& p = moving.moved(farthest);
    p = p * rng.uniform(0.7, 1);
    moving.refit();
    const auto valid = bvh::validate(moving.tree, moving.mesh());
    ASSERT_TRUE(static_cast<bool>(valid)) << i << ": " << valid.error().text;
    bvh::Tree fitted = moving.tree;
    bvh::fit(fitted, moving.mesh());
    const float radius = fitted.nodes[0].bounds.radius[0];
    ASSERT_NEAR(moving.tree.nodes[0].bounds.radius[0], radius, 1e-5F * radius) << i;
  }
}

TEST(Refit, KeepsOriginsOfNodesAmongTheirTriangles) {
  // Float32 numbers relative to an origin lose precision in proportion to its distance.
  MovingTree moving(scenes::grid(40, 40, 0, 0, 1, 1));
  const auto count = static_cast<VertexId>(moving.positions.size());
  for (VertexId begin = 0; begin < count; begin += 100) {
    for (VertexId v = begin; v < std::min(begin + 100, count); ++v) moving.moved(v).x += 2e4;
    moving.refit();
  }
  for (std::uint32_t n = 0; n < moving.tree.first_lowest_node(); ++n) {
    const bvh::Node& node = moving.tree.nodes[n];
    const float largest = *std::max_element(node.bounds.radius, node.bounds.radius + node.child_count);
    const Vec3 from_origin = moving.tree.nodes[node.first_child].origin - node.origin;
    EXPECT_LE(max_abs(from_origin), 65 * moving.tree.unit * static_cast<double>(largest)) << n;
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Edges of meshes, and pairs of elements: known answers, visitors, spans and mistakes of callers. Random scenes are in
// tests/property.
#include "limber/elements.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <thread>
#include <utility>
#include <vector>

#include "base/access.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

using Ends = std::array<VertexId, 2>;
using EdgeIds = std::array<EdgeId, 3>;

/// A square of two triangles in the plane z = 0.
Mesh flat_square() { return scenes::grid(1, 1, -1, -1, 2, 2); }

template <typename T>
std::vector<T> as_list(std::span<const T> span) {
  return {span.begin(), span.end()};
}

TEST(MeshEdges, OfTwoTrianglesAreFive) {
  const Model model(small_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {9, 9, 9}}, {{3, 2, 1}, {0, 1, 2}}));
  const MeshEdges& edges = model.edges();
  EXPECT_EQ(as_list(edges.vertices()), (std::vector<Ends>{{0, 1}, {0, 2}, {1, 2}, {1, 3}, {2, 3}}));
  EXPECT_EQ(as_list(edges.of_triangles()), (std::vector<EdgeIds>{{4, 2, 3}, {0, 2, 1}}));
  EXPECT_EQ(as_list(edges.representatives()), (std::vector<TriangleId>{1, 1, 0, 0, 0}));
  EXPECT_EQ(as_list(edges.vertex_representatives()), (std::vector<TriangleId>{1, 0, 0, 0, no_id}));
  EXPECT_EQ(Access::represented_by(edges, 0), 0b111'111);
  EXPECT_EQ(Access::represented_by(edges, 1), 0b101'001);
  EXPECT_EQ(edges.size(), 5U);
  EXPECT_EQ(edges.vertex_count(), 5U);
  EXPECT_EQ(edges.triangle_count(), 2U);
}

TEST(MeshEdges, OfOneVertexAreNone) {
  const Model model(small_mesh({{0, 0, 0}, {1, 0, 0}}, {{1, 1, 0}, {0, 0, 0}}));
  const MeshEdges& edges = model.edges();
  EXPECT_EQ(as_list(edges.vertices()), (std::vector<Ends>{{0, 1}}));
  EXPECT_EQ(as_list(edges.of_triangles()), (std::vector<EdgeIds>{{no_id, 0, 0}, {no_id, no_id, no_id}}));
  EXPECT_EQ(Access::represented_by(edges, 0), 0b010'101);
  EXPECT_EQ(Access::represented_by(edges, 1), 0);
}

TEST(MeshEdges, OfAClosedSurfaceAreThreeForTwoTriangles) {
  const Mesh ball = scenes::ball(12, 7);
  const Model model(ball);
  const MeshEdges& edges = model.edges();
  EXPECT_EQ(2 * edges.size(), 3 * ball.triangles().size());
  EXPECT_TRUE(std::is_sorted(edges.vertices().begin(), edges.vertices().end()));
  for (TriangleId t = 0; t < ball.triangles().size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const VertexId v = ball.triangles()[t][k], w = ball.triangles()[t][(k + 1) % 3];
      const EdgeId e = edges.of_triangles()[t][k];
      EXPECT_EQ(edges.vertices()[e], (Ends{std::min(v, w), std::max(v, w)}));
      EXPECT_LE(edges.representatives()[e], t);
      EXPECT_EQ(edges.representatives()[e] == t, (Access::represented_by(edges, t) >> (3 + k) & 1) != 0);
      EXPECT_EQ(edges.vertex_representatives()[v] == t, (Access::represented_by(edges, t) >> k & 1) != 0);
    }
  }
}

TEST(MeshEdges, AreKeptUntilAModelIsReset) {
  Model model(scenes::ball(12, 7));
  std::vector<const MeshEdges*> seen(4);
  std::vector<std::thread> threads;
  for (const MeshEdges*& own : seen) threads.emplace_back([&] { own = &model.edges(); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(seen, std::vector<const MeshEdges*>(4, &model.edges()));
  model.move_all(model.mesh().positions()).value();
  model.commit();
  Model other = std::move(model);
  EXPECT_EQ(&other.edges(), seen[0]);
  EXPECT_THROW(model.edges(), std::invalid_argument);  // NOLINT(bugprone-use-after-move)
  other.reset(flat_square());
  EXPECT_EQ(other.edges().size(), 5U);
}

TEST(Elements, OfParallelSquares) {
  const Mesh mesh = flat_square();
  const Model low(mesh), high(mesh);
  std::vector<VertexFacePair> vertex_face(100);
  std::vector<EdgeEdgePair> edge_edge(100);
  const Placed a{low}, b{high, {{}, {0, 0, 0.25}}};
  const ElementPairCount found = element_pairs(a, b, 0.25, vertex_face, edge_edge);
  // A corner of the diagonal is over both triangles, the two others over one. Of the 25 pairs of edges two pairs of
  // opposite sides are apart, in either order.
  EXPECT_EQ(found.vertex_face, 12U);
  EXPECT_EQ(found.edge_edge, 21U);
  EXPECT_TRUE(found.is_complete);
  EXPECT_GE(found.stats.primitive_tests, 33U);
  std::size_t of_b = 0;
  for (std::size_t i = 0; i < found.vertex_face; ++i) {
    EXPECT_EQ(vertex_face[i].distance, 0.25);
    const Vec3& w = vertex_face[i].weights;
    EXPECT_EQ(w.x + w.y + w.z, 1);
    of_b += vertex_face[i].is_vertex_of_b ? 1 : 0;
  }
  EXPECT_EQ(of_b, 6U);
  for (std::size_t i = 0; i < found.edge_edge; ++i) EXPECT_EQ(edge_edge[i].distance, 0.25);
  const ElementPairCount none = element_pairs(a, b, 0.2499, {}, {});
  EXPECT_EQ(none.vertex_face + none.edge_edge, 0U);
}

TEST(SelfElements, OfTinyTrianglesBesideLargeOnesHaveTheirOwnDistances) {
  std::vector<Vec3> positions;
  for (const double size : {1.0, 0x1p-600}) {
    for (const double height : {0.0, 0.25}) {
      for (const Vec3& corner : {Vec3{1, 1, 0}, Vec3{2, 1, 0}, Vec3{1, 2, 0}}) {
        positions.push_back(size * (corner + Vec3{0, 0, height}));
      }
    }
  }
  const Mesh mesh = small_mesh(positions, {{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {9, 10, 11}});
  const Model model(mesh);
  std::vector<EdgeEdgePair> found(100);
  const ElementPairCount count = self_element_pairs(model, 0.25, {}, found);
  ASSERT_EQ(count.edge_edge, 18U);  // of each size all of one triangle with all of the other
  for (std::size_t i = 0; i < count.edge_edge; ++i) {
    const bool is_tiny = model.edges().vertices()[found[i].a][0] >= 6;
    EXPECT_EQ(found[i].distance, is_tiny ? 0x1p-602 : 0.25);
  }
}

TEST(Elements, ThatCrossHaveNoDistance) {
  const Mesh one = small_mesh({{-1, 0, 0}, {1, 0, 0}, {0, 0, -3}}, {{0, 1, 2}});
  const Mesh other = small_mesh({{0, -1, 0}, {0, 1, 0}, {0, 0, 3}}, {{0, 1, 2}});
  const Model a(one), b(other);
  std::vector<EdgeEdgePair> edge_edge(2);
  const ElementPairCount found = element_pairs({a}, {b}, 0, {}, edge_edge);
  EXPECT_EQ(found.vertex_face, 0U);
  ASSERT_EQ(found.edge_edge, 1U);
  EXPECT_EQ(edge_edge[0].a, 0U);
  EXPECT_EQ(edge_edge[0].b, 0U);
  EXPECT_EQ(edge_edge[0].parameter_a, 0.5);
  EXPECT_EQ(edge_edge[0].parameter_b, 0.5);
}

TEST(SelfElements, OfAFoldAreInNeighboringTriangles) {
  // Two triangles with a common edge, folded onto each other until their far corners are 0.1 apart.
  const Mesh fold = small_mesh({{0, 0, 0}, {0, 4, 0}, {2, 2, 0}, {2, 2, 0.1}}, {{0, 1, 2}, {1, 0, 3}});
  const Model model(fold);
  std::vector<VertexFacePair> vertex_face(9);
  std::vector<EdgeEdgePair> edge_edge(9);
  const ElementPairCount found = self_element_pairs(model, 0.1, vertex_face, edge_edge);
  ASSERT_EQ(found.vertex_face, 2U);
  EXPECT_EQ(vertex_face[0].vertex + vertex_face[1].vertex, 5U);
  EXPECT_FALSE(vertex_face[0].is_vertex_of_b);
  ASSERT_EQ(found.edge_edge, 2U);
  for (const EdgeEdgePair& pair : std::span(edge_edge).first(2)) {
    EXPECT_LT(pair.a, pair.b);
    const Ends p = model.edges().vertices()[pair.a], q = model.edges().vertices()[pair.b];
    EXPECT_TRUE(p[0] != q[0] && p[0] != q[1] && p[1] != q[0] && p[1] != q[1]);
  }
}

TEST(SelfElements, WithoutATriangleAreNotFound) {
  const Mesh mesh = small_mesh({{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0}}, {{0, 1, 2}});
  const ElementPairCount found = self_element_pairs(Model(mesh), 9, {}, {});
  EXPECT_EQ(found.vertex_face + found.edge_edge, 0U);
}

TEST(Elements, AreCountedBeyondTheRoomForThem) {
  const Mesh ball = scenes::ball(20, 12);
  const Model model(ball);
  const Placed a{model}, b{model, {{}, {1, 0, 0}}};
  std::vector<VertexFacePair> vertex_face(100'000), few_vertex_face(7);
  std::vector<EdgeEdgePair> edge_edge(100'000), few_edge_edge(5);
  const ElementPairCount all = element_pairs(a, b, 0.1, vertex_face, edge_edge);
  ASSERT_GT(all.vertex_face, 7U);
  ASSERT_GT(all.edge_edge, 5U);
  const ElementPairCount few = element_pairs(a, b, 0.1, few_vertex_face, few_edge_edge);
  EXPECT_EQ(few.vertex_face, all.vertex_face);
  EXPECT_EQ(few.edge_edge, all.edge_edge);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(few_vertex_face[i].vertex, vertex_face[i].vertex);
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(few_edge_edge[i].b, edge_edge[i].b);
}

TEST(Elements, EndWhenAVisitorSaysSo) {
  const Mesh ball = scenes::ball(20, 12);
  const Model model(ball);
  std::size_t visited = 0;
  const auto all = [](const auto&) { return true; };
  const auto third = [&](const auto&) { return ++visited % 3 != 0; };
  EXPECT_EQ(visit_self_element_pairs(model, 0.3, all, third).edge_edge, 3U);
  const ElementPairCount found = visit_self_element_pairs(model, 0.3, third, all);
  EXPECT_EQ(found.vertex_face, 3U);
  EXPECT_FALSE(found.is_complete);
  const auto throws = [](const auto&) -> bool { throw std::runtime_error("enough"); };
  EXPECT_THROW(visit_self_element_pairs(model, 0.3, throws, all), std::runtime_error);
}

TEST(ElementsMisuse, IsRefused) {
  const Mesh mesh = flat_square();
  Model model(mesh);
  const Placed placed{model};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double margin : {-1.0, nan, std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(element_pairs(placed, placed, margin, {}, {}), std::invalid_argument);
    EXPECT_THROW(self_element_pairs(model, margin, {}, {}), std::invalid_argument);
    EXPECT_THROW(reference::element_pairs({mesh}, {mesh}, margin), std::invalid_argument);
    EXPECT_THROW(reference::self_element_pairs(mesh, margin), std::invalid_argument);
  }
  const Transform stretched{{{2, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}};
  EXPECT_THROW(element_pairs(placed, {model, stretched}, 1, {}, {}), std::invalid_argument);
  EXPECT_THROW(reference::element_pairs({mesh}, {mesh, stretched}, 1), std::invalid_argument);
  model.move_all(mesh.positions()).value();
  EXPECT_THROW(self_element_pairs(model, 1, {}, {}), std::invalid_argument);
  EXPECT_THROW(element_pairs(placed, placed, 1, {}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace limber::testing

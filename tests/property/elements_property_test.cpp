// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of elements of two models, and of one with itself, against brute force: in random scenes, on every instruction
// set, on a real mesh, and while models deform.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "limber/elements.h"
#include "limber/io.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/crumpled_mesh.h"
#include "support/random_scene.h"
#include "support/real_meshes.h"

namespace limber::testing {
namespace {

using reference::ElementPairs;

auto ids_of(const VertexFacePair& p) { return std::tuple(p.is_vertex_of_b, p.vertex, p.triangle); }
auto ids_of(const EdgeEdgePair& p) { return std::tuple(p.a, p.b); }
auto numbers_of(const VertexFacePair& p) { return std::tuple(p.distance, p.weights.x, p.weights.y, p.weights.z); }
auto numbers_of(const EdgeEdgePair& p) { return std::tuple(p.distance, p.parameter_a, p.parameter_b); }

/// What a query visits, in its order.
template <typename Visit>
ElementPairs visited(const Visit& visit) {
  ElementPairs found;
  const ElementPairCount count =
      visit([&](const VertexFacePair& pair) { return found.vertex_face.push_back(pair), true; },
            [&](const EdgeEdgePair& pair) { return found.edge_edge.push_back(pair), true; });
  EXPECT_EQ(count.vertex_face, found.vertex_face.size());
  EXPECT_EQ(count.edge_edge, found.edge_edge.size());
  EXPECT_TRUE(count.is_complete);
  return found;
}

template <typename Pair>
void expect_same_list(const std::vector<Pair>& list, const std::vector<Pair>& other, const char* set) {
  EXPECT_EQ(list.size(), other.size()) << set;
  for (std::size_t i = 0; i < std::min(list.size(), other.size()); ++i) {
    EXPECT_EQ(ids_of(list[i]), ids_of(other[i])) << set;
    EXPECT_EQ(numbers_of(list[i]), numbers_of(other[i])) << set;
  }
}

/// The same lists on every instruction set, order included.
template <typename Visit>
ElementPairs visited_on_all_sets(const Visit& visit) {
  simd::use_kernels(&simd::scalar_kernels);
  const ElementPairs first = visited(visit);
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    const ElementPairs again = visited(visit);
    expect_same_list(again.vertex_face, first.vertex_face, set.name);
    expect_same_list(again.edge_edge, first.edge_edge, set.name);
  }
  simd::use_kernels(nullptr);
  return first;
}

/// Whether a query has found what brute force has, numbers to the bit. Pairs whose distance equals the margin up to
/// rounding may be missing. `truth` has all pairs within the margin, in ascending order.
template <typename Pair>
void expect_same(std::vector<Pair> found, const std::vector<Pair>& truth, double certain) {
  std::sort(found.begin(), found.end(), [](const Pair& p, const Pair& q) { return ids_of(p) < ids_of(q); });
  auto next = found.begin();
  for (const Pair& pair : truth) {
    if (next != found.end() && ids_of(*next) == ids_of(pair)) {
      EXPECT_EQ(numbers_of(*next++), numbers_of(pair));
    } else {
      EXPECT_GT(pair.distance, certain) << "a pair is missing";
    }
  }
  EXPECT_EQ(next, found.end()) << "pairs are wrong, or came twice";
}

void expect_same(const ElementPairs& found, const ElementPairs& truth, double margin, double rounding) {
  const double certain = margin == 0 ? 0 : margin - rounding;
  expect_same(found.vertex_face, truth.vertex_face, certain);
  expect_same(found.edge_edge, truth.edge_edge, certain);
}

struct Totals {
  std::size_t vertex_face = 0, edge_edge = 0, touching = 0;

  void add(const ElementPairs& pairs) {
    vertex_face += pairs.vertex_face.size(), edge_edge += pairs.edge_edge.size();
    for (const VertexFacePair& p : pairs.vertex_face) touching += p.distance == 0 ? 1 : 0;
    for (const EdgeEdgePair& p : pairs.edge_edge) touching += p.distance == 0 ? 1 : 0;
  }
};

TEST(ElementsProperty, AreThoseOfBruteForceInRandomScenes) {
  Rng rng(1501);
  Totals totals;
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const MeshEdges edges_a(s.mesh_a), edges_b(s.mesh_b);
    const double margin = some_margin(rng, s.size);
    const ElementPairs found = visited_on_all_sets([&](VertexFaceVisitor vertex_face, EdgeEdgeVisitor edge_edge) {
      return visit_element_pairs({model_a, s.pose_a}, edges_a, {model_b, s.pose_b}, edges_b, margin, vertex_face,
                                 edge_edge);
    });
    expect_same(found, reference::element_pairs({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}, margin), margin,
                s.tolerance);
    if (::testing::Test::HasFailure()) return;
    totals.add(found);
  }
  EXPECT_GT(totals.vertex_face, 2000U);
  EXPECT_GT(totals.edge_edge, 5000U);
  EXPECT_GT(totals.touching, 100U);
}

/// Slivers of heights down to 0 and triangles without an area, some with common vertices; those of `other` have corners
/// on or next to the first ones.
Mesh slivers(Rng& rng, const Mesh* other) {
  std::vector<Triangle> triangles;
  for (int i = 0; i < 24; ++i) {
    const Vec3 long_side = uniform_point(rng), across = uniform_point(rng);
    Vec3 at = uniform_point(rng);
    if (other != nullptr) {
      const Triangle t = other->triangle(static_cast<TriangleId>(rng.below(other->triangles().size())));
      const double aside = rng.below(2) == 0 ? 0 : std::ldexp(1.0, -4 - static_cast<int>(rng.below(40)));
      at = point_on(t, rng.uniform(0, 1), 0) + aside * uniform_point(rng);
    }
    const double height = rng.below(4) == 0 ? 0 : std::ldexp(1.0, -static_cast<int>(rng.below(60)));
    triangles.push_back({at, at + long_side, at + rng.uniform(-0.5, 1.5) * long_side + height * across});
  }
  return soup(triangles);
}

TEST(ElementsProperty, AreThoseOfBruteForceNextToSliversOfAnyHeight) {
  Rng rng(1506);
  Totals totals;
  for (int i = 0; i < 60; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh_a = slivers(rng, nullptr), mesh_b = slivers(rng, &mesh_a);
    const Model model_a(mesh_a), model_b(mesh_b);
    const MeshEdges edges_a(mesh_a), edges_b(mesh_b);
    const Transform pose = rng.below(2) == 0 ? Transform{} : random_pose(rng, 1);
    const double margin = std::ldexp(1.0, -static_cast<int>(rng.below(40)));
    const ElementPairs found = visited_on_all_sets([&](VertexFaceVisitor vertex_face, EdgeEdgeVisitor edge_edge) {
      return visit_element_pairs({model_a, pose}, edges_a, {model_b, pose}, edges_b, margin, vertex_face, edge_edge);
    });
    expect_same(found, reference::element_pairs({mesh_a, pose}, {mesh_b, pose}, margin), margin, 1e-13);
    if (::testing::Test::HasFailure()) return;
    totals.add(found);
  }
  EXPECT_GT(totals.vertex_face, 2000U);
  EXPECT_GT(totals.edge_edge, 2000U);
}

void check_self(const Model& model, const MeshEdges& edges, double margin, Totals& totals) {
  const ElementPairs found = visited_on_all_sets([&](VertexFaceVisitor vertex_face, EdgeEdgeVisitor edge_edge) {
    return visit_self_element_pairs(model, edges, margin, vertex_face, edge_edge);
  });
  expect_same(found, reference::self_element_pairs(model.mesh(), margin), margin, 1e-14 * extent_of(model.mesh()));
  totals.add(found);
}

TEST(SelfElementsProperty, AreThoseOfBruteForceInRandomMeshes) {
  Rng rng(1502);
  Totals totals;
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = crumpled(rng);
    check_self(Model(mesh), MeshEdges(mesh), some_margin(rng, extent_of(mesh)), totals);
    if (::testing::Test::HasFailure()) return;
  }
  EXPECT_GT(totals.vertex_face, 2000U);
  EXPECT_GT(totals.edge_edge, 5000U);
  EXPECT_GT(totals.touching, 100U);
}

TEST(SelfElementsProperty, AreThoseOfBruteForceWhileModelsDeform) {
  Rng rng(1503);
  Totals totals;
  for (int i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    const RebuildPolicy policy = rng.below(2) == 0 ? RebuildPolicy::off : RebuildPolicy::in_commit;
    const double motion_margin = rng.below(2) == 0 ? 0.05 : 0.002;
    Model model(crumpled(rng), {.motion_margin = motion_margin, .rebuild_policy = policy});
    const MeshEdges edges(model.mesh());
    const double size = extent_of(model.mesh());
    for (int step = 0; step < 6; ++step) {
      std::vector<Vec3> positions = model.mesh().positions();
      const double length = size * std::pow(10.0, rng.uniform(-4, -0.5));
      for (Vec3& p : positions) {
        if (rng.below(1 + step % 3) == 0) p += length * uniform_point(rng);
      }
      ASSERT_TRUE(static_cast<bool>(model.move_all(positions)));
      model.commit();
      if (step == 4) model.rebuild();
      check_self(model, edges, some_margin(rng, size), totals);
      if (::testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(totals.vertex_face, 2000U);
  EXPECT_GT(totals.edge_edge, 5000U);
}

TEST(SelfElementsProperty, AreThoseOfBruteForceOnARealMesh) {
  const Mesh mesh = load_mesh(real_mesh("spot.obj")).value();
  Totals totals;
  check_self(Model(mesh), MeshEdges(mesh), 0.01 * extent_of(mesh), totals);
  EXPECT_GT(totals.vertex_face, 100U);
  EXPECT_GT(totals.edge_edge, 500U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of features against brute force, of two models and of one with itself: in random scenes, on lattices where
// nearly all is a tie, on every instruction set, and while models deform.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "limber/elements.h"
#include "reference/reference.h"
#include "simd/kernels.h"
#include "support/keys.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

using Features = std::vector<FeaturePair>;

/// How many pairs have been compared with those of brute force, by kind.
struct FeatureTotals {
  std::size_t vertex_vertex = 0, vertex_edge = 0, vertex_face = 0, edge_edge = 0, several = 0, touching = 0;

  void add(const FeaturePair& p) {
    const bool has_face = p.kind_a == FeatureKind::face || p.kind_b == FeatureKind::face;
    const int edges = (p.kind_a == FeatureKind::edge ? 1 : 0) + (p.kind_b == FeatureKind::edge ? 1 : 0);
    ++(has_face ? vertex_face : edges == 0 ? vertex_vertex : edges == 1 ? vertex_edge : edge_edge);
    several += p.multiplicity > 2 ? 1 : 0, touching += p.distance == 0 ? 1 : 0;
  }
};

/// Makes the list on every instruction set; all have to be the same, order and numbers included.
template <typename Find>
Features found_on_all_sets(const Find& find) {
  simd::use_kernels(&simd::scalar_kernels);
  FeaturePairs memory;
  const auto list = [&] {
    const ElementPairCount count = find(memory);
    std::size_t pairs = 0;
    for (const FeaturePair& p : memory.list()) pairs += p.multiplicity;
    EXPECT_TRUE(count.is_complete);
    EXPECT_EQ(pairs, count.vertex_face + count.edge_edge);
    return Features(memory.list().begin(), memory.list().end());
  };
  const Features first = list();
  const auto are_same = [](const FeaturePair& p, const FeaturePair& q) { return key_of(p) == key_of(q); };
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::use_kernels(&set);
    const Features again = list();
    EXPECT_TRUE(std::equal(again.begin(), again.end(), first.begin(), first.end(), are_same)) << set.name;
  }
  simd::use_kernels(nullptr);
  return first;
}

/// The weighted mean of the vertices of a feature.
Vec3 mean_of(const std::array<VertexId, 3>& vertices, const Vec3& weights, const MeshView& mesh,
             const Transform& pose) {
  Vec3 sum;
  for (std::size_t k = 0; k < 3; ++k) sum += weights[k] * pose(mesh.positions[vertices[k]]);
  return sum;
}

/// What a pair says of itself is consistent.
void expect_consistent(const FeaturePair& p, const reference::Placed& a, const reference::Placed& b, double rounding) {
  for (const Vec3& w : {p.weights_a, p.weights_b}) {
    EXPECT_TRUE(w.x >= 0 && w.y >= 0 && w.z >= 0);
    EXPECT_NEAR(w.x + w.y + w.z, 1, 1e-14);
  }
  EXPECT_LE(max_abs(mean_of(p.vertices_a, p.weights_a, a.mesh, a.pose) - p.point_a), rounding);
  EXPECT_LE(max_abs(mean_of(p.vertices_b, p.weights_b, b.mesh, b.pose) - p.point_b), rounding);
  EXPECT_NEAR(length(p.normal), 1, 1e-14);
  EXPECT_TRUE(p.distance == 0 || max_abs(p.point_b - p.point_a - p.distance * p.normal) <= rounding);
}

/// Expects the pairs of brute force, each once, but for those at the margin.
void expect_features(Features found, const Features& truth, const reference::Placed& a, const reference::Placed& b,
                     double margin, double rounding, FeatureTotals& totals) {
  std::sort(found.begin(), found.end(), [](const auto& p, const auto& q) { return ids_of(p) < ids_of(q); });
  const double certain = margin == 0 ? 0 : margin - rounding;
  auto next = found.begin();
  for (const FeaturePair& t : truth) {
    if (next == found.end() || ids_of(*next) != ids_of(t)) {
      EXPECT_GT(t.distance, certain) << "a pair is missing";
      continue;
    }
    const FeaturePair& p = *next++;
    EXPECT_EQ(p.distance, t.distance);
    EXPECT_EQ(p.point_a, t.point_a);
    EXPECT_EQ(p.point_b, t.point_b);
    EXPECT_TRUE(t.distance > certain || p.multiplicity == t.multiplicity);
    expect_consistent(p, a, b, rounding);
    totals.add(p);
  }
  EXPECT_EQ(next, found.end()) << "pairs are wrong, or came twice";
}

void check_features_of_two(const RandomScene& s, double margin, FeatureTotals& totals) {
  const Model model_a(s.mesh_a), model_b(s.mesh_b);
  const reference::Placed twin_a{s.mesh_a, s.pose_a}, twin_b{s.mesh_b, s.pose_b};
  const Features found = found_on_all_sets([&](FeaturePairs& memory) {
    return feature_pairs({model_a, s.pose_a}, {model_b, s.pose_b}, margin, memory);
  });
  expect_features(found, reference::feature_pairs(twin_a, twin_b, margin), twin_a, twin_b, margin, s.tolerance, totals);
}

void check_features_of_one(const Model& model, double margin, FeatureTotals& totals) {
  const reference::Placed twin{model.mesh()};
  const Features found =
      found_on_all_sets([&](FeaturePairs& memory) { return self_feature_pairs(model, margin, memory); });
  const auto is_in_order = [](const FeaturePair& p) {
    return p.kind_a == p.kind_b ? p.a < p.b : p.kind_a == FeatureKind::vertex;
  };
  EXPECT_TRUE(std::all_of(found.begin(), found.end(), is_in_order));
  expect_features(found, reference::self_feature_pairs(model.mesh(), margin), twin, twin, margin,
                  1e-14 * extent_of(model.mesh()), totals);
}

TEST(FeaturesProperty, AreThoseOfBruteForceInRandomScenes) {
  Rng rng(4101);
  FeatureTotals totals;
  for (int i = 0; i < 100 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const RandomScene s = arbitrary_scene(rng);
    check_features_of_two(s, some_margin(rng, s.size), totals);
  }
  EXPECT_GT(totals.vertex_vertex, 100U);
  EXPECT_GT(totals.vertex_edge, 500U);
  EXPECT_GT(totals.vertex_face, 500U);
  EXPECT_GT(totals.edge_edge, 1000U);
  EXPECT_GT(totals.several, 300U);
  EXPECT_GT(totals.touching, 20U);
}

TEST(FeaturesProperty, AreThoseOfBruteForceInMeshesThatDeform) {
  Rng rng(4102);
  FeatureTotals totals;
  for (int i = 0; i < 120 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    Model model(crumpled(rng), {.motion_margin = rng.below(2) == 0 ? 0.05 : 0.002});
    const double size = extent_of(model.mesh());
    check_features_of_one(model, some_margin(rng, size), totals);
    deform(model, [&](const Vec3& p) { return rng.below(3) == 0 ? p + 0.01 * size * uniform_point(rng) : p; });
    check_features_of_one(model, some_margin(rng, size), totals);
  }
  EXPECT_GT(totals.vertex_vertex, 100U);
  EXPECT_GT(totals.vertex_edge, 1000U);
  EXPECT_GT(totals.vertex_face, 1000U);
  EXPECT_GT(totals.edge_edge, 1000U);
  EXPECT_GT(totals.several, 500U);
}

/// Triangles with corners on a small lattice, whose vertices and edges others share: edges of any number of triangles,
/// corners that name one vertex twice, triangles without an area and vertices in one place.
Mesh tangled_lattice(Rng& rng, double scale) {
  std::vector<Vec3> positions;
  for (std::uint32_t i = 0, count = some(rng, 4, 12); i < count; ++i) {
    const auto coordinate = [&] { return scale * static_cast<double>(rng.below(4)); };
    const double x = coordinate(), y = coordinate();
    positions.push_back({x, y, rng.below(2) == 0 ? 0 : coordinate()});
  }
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0, count = some(rng, 2, 20); i < count; ++i) {
    const auto corner = [&] { return static_cast<VertexId>(rng.below(positions.size())); };
    const VertexId v = corner(), w = corner();
    triangles.push_back({v, w, corner()});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

TEST(FeaturesProperty, AreThoseOfBruteForceWhereNearlyAllIsATie) {
  Rng rng(4103);
  FeatureTotals totals;
  for (int i = 0; i < 150 && !HasFailure(); ++i) {
    SCOPED_TRACE(i);
    const double scale = std::ldexp(1.0, 50 * (static_cast<int>(rng.below(5)) - 2)), margin = scale * rng.uniform(0, 2);
    const Mesh mesh_a = tangled_lattice(rng, scale), mesh_b = tangled_lattice(rng, scale);
    check_features_of_two({mesh_a, mesh_b, {}, {}, scale, 1e-13 * scale}, margin, totals);
    check_features_of_one(Model(mesh_a), margin, totals);
  }
  EXPECT_GT(totals.vertex_vertex, 1000U);
  EXPECT_GT(totals.several, 1000U);
  EXPECT_GT(totals.touching, 1000U);
}

}  // namespace
}  // namespace limber::testing

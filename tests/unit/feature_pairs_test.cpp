// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Pairs of features: known multiplicities, points and normals, of surfaces that are closed, open or neither; budgets,
// memory that is kept, and mistakes of callers. What they say of any meshes is tests/property's to check.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <utility>
#include <vector>

#include "limber/elements.h"
#include "limber/shapes.h"
#include "scenes/scenes.h"
#include "support/keys.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

/// `count` triangles around a tip at the origin, whose other corners are at that height.
Mesh pyramid(std::uint32_t count, double height) {
  std::vector<Vec3> positions{{0, 0, 0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    positions.push_back({std::cos(angle), std::sin(angle), height});
    triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  }
  return small_mesh(positions, triangles);
}

/// Pages that share an edge along the x axis and hang below it: a roof if there are two.
Mesh book(std::uint32_t pages) {
  std::vector<Vec3> positions{{-2, 0, 0}, {2, 0, 0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < pages; ++i) {
    positions.push_back({0, 0.25 * i - 0.1, -2});
    triangles.push_back({0, 1, 2 + i});
  }
  return small_mesh(positions, triangles);
}

FeaturePair only_pair(const Placed& a, const Placed& b, double margin) {
  FeaturePairs found;
  feature_pairs(a, b, margin, found);
  EXPECT_EQ(found.list().size(), 1U);
  return found.list().empty() ? FeaturePair{} : found.list()[0];
}

void expect_kinds(const FeaturePair& p, FeatureKind kind_a, FeatureKind kind_b, std::uint32_t multiplicity) {
  EXPECT_EQ(p.kind_a, kind_a);
  EXPECT_EQ(p.kind_b, kind_b);
  EXPECT_EQ(p.multiplicity, multiplicity);
}

TEST(FeaturePairs, OfTwoTipsComeOnceForAllFacesAndEdgesAroundThem) {
  for (const std::uint32_t n : {3U, 4U, 7U}) {
    const Model below(pyramid(n, -1)), above(pyramid(5, 1));
    const FeaturePair p = only_pair({below}, {above, {{}, {0, 0, 0.5}}}, 0.6);
    expect_kinds(p, FeatureKind::vertex, FeatureKind::vertex,
                 5 * n + 5 + n);  // edges with edges, tip with faces, faces with tip
    EXPECT_EQ(p.distance, 0.5);
    EXPECT_EQ(p.point_a, Vec3{});
    EXPECT_EQ(p.point_b, (Vec3{0, 0, 0.5}));
    EXPECT_EQ(p.normal, (Vec3{0, 0, 1}));
    EXPECT_EQ(p.weights_a, (Vec3{1, 0, 0}));
    EXPECT_EQ(p.a, 0U);
    EXPECT_EQ(p.vertices_b, (std::array<VertexId, 3>{0, 0, 0}));
  }
}

TEST(FeaturePairs, OfATipAndAnEdgeCountTheFacesOfTheEdge) {
  for (const std::uint32_t pages : {1U, 2U, 5U}) {
    const Model below(book(pages)), above(pyramid(4, 1));
    const Placed tip{above, {{}, {1, 0, 0.25}}};
    const FeaturePair p = only_pair({below}, tip, 0.3);
    expect_kinds(p, FeatureKind::edge, FeatureKind::vertex, pages + 4);
    EXPECT_EQ(below.edges().vertices()[p.a], (std::array<VertexId, 2>{0, 1}));
    EXPECT_EQ(p.vertices_a, (std::array<VertexId, 3>{0, 1, 0}));
    EXPECT_EQ(p.weights_a, (Vec3{0.25, 0.75, 0}));
    EXPECT_EQ(p.point_a, (Vec3{1, 0, 0}));
    EXPECT_EQ(p.normal, (Vec3{0, 0, 1}));
    const FeaturePair swapped = only_pair(tip, {below}, 0.3);
    expect_kinds(swapped, FeatureKind::vertex, FeatureKind::edge, pages + 4);
    EXPECT_EQ(swapped.normal, (Vec3{0, 0, -1}));
    EXPECT_EQ(std::pair(swapped.a, swapped.b), std::pair(p.b, p.a));
    EXPECT_EQ(swapped.weights_b, p.weights_a);
  }
}

TEST(FeaturePairs, InsideOfFacesAndOfBothEdgesComeOnce) {
  const Model floor(small_mesh({{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}}, {{0, 1, 2}})), tip(pyramid(6, 1));
  const FeaturePair of_face = only_pair({floor}, {tip, {{}, {0, 0, 0.125}}}, 0.2);
  expect_kinds(of_face, FeatureKind::face, FeatureKind::vertex, 1);
  EXPECT_EQ(of_face.weights_a, (Vec3{0.25, 0.25, 0.5}));
  EXPECT_EQ(of_face.vertices_a, (std::array<VertexId, 3>{0, 1, 2}));
  EXPECT_EQ(of_face.normal, (Vec3{0, 0, 1}));
  const Model ridge(book(2));
  const Placed across{ridge, {{{0, -1, 0}, {-1, 0, 0}, {0, 0, -1}}, {0, 0, 0.125}}};  // hangs upwards, along y
  const FeaturePair of_edges = only_pair({ridge}, across, 0.2);
  expect_kinds(of_edges, FeatureKind::edge, FeatureKind::edge, 1);
  EXPECT_EQ(of_edges.weights_a, (Vec3{0.5, 0.5, 0}));
  EXPECT_EQ(of_edges.normal, (Vec3{0, 0, 1}));
}

TEST(FeaturePairs, ThatMeetHaveTheNormalsThatAreDocumented) {
  constexpr double hardly = 0x1p-40;  // rounding puts single pairs of elements beyond 0
  const Model floor(small_mesh({{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}}, {{0, 1, 2}})), tip(pyramid(6, 1));
  const FeaturePair of_face = only_pair({floor}, {tip}, hardly);
  EXPECT_EQ(of_face.distance, 0);
  EXPECT_EQ(of_face.normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(only_pair({tip}, {floor}, hardly).normal, (Vec3{0, 0, -1}));
  const Model ridge(book(2));
  const FeaturePair of_edges = only_pair({ridge}, {ridge, {{{0, -1, 0}, {-1, 0, 0}, {0, 0, -1}}, {}}}, hardly);
  expect_kinds(of_edges, FeatureKind::edge, FeatureKind::edge, 1);
  EXPECT_EQ(of_edges.normal, (Vec3{0, 0, -1}));  // x axis times the negative y axis
  const Model exact(small_mesh({{0, 0, 0}, {1, 1, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, -1, 1}},
                               {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 1}}));
  const FeaturePair of_edge = only_pair({ridge}, {exact, {{}, {1, 0, 0}}}, 0);
  expect_kinds(of_edge, FeatureKind::edge, FeatureKind::vertex, 2 + 4);
  EXPECT_EQ(of_edge.normal.x, 0);
  EXPECT_NEAR(length(of_edge.normal), 1, 1e-15);
  const Model below(pyramid(4, -1));
  const FeaturePair of_tips = only_pair({below}, {tip}, hardly);
  expect_kinds(of_tips, FeatureKind::vertex, FeatureKind::vertex, 4 * 6 + 4 + 6);
  EXPECT_EQ(of_tips.normal, (Vec3{0, 0, 1}));
}

using Counts = std::map<std::pair<FeatureKind, FeatureKind>, std::pair<std::size_t, std::size_t>>;

/// How many pairs there are, and how many pairs of elements, by kinds.
Counts counts_of(const FeaturePairs& found) {
  Counts counts;
  for (const FeaturePair& p : found.list()) {
    auto& [pairs, elements] = counts[{p.kind_a, p.kind_b}];
    ++pairs, elements += p.multiplicity;
  }
  return counts;
}

TEST(FeaturePairs, OfGridsAboveEachOtherAreVerticesAlone) {
  const Model grid(scenes::grid(4, 4, 0, 0, 1, 1));
  FeaturePairs found;
  const ElementPairCount count = feature_pairs({grid}, {grid, {{}, {0, 0, 0.5}}}, 0.5, found);
  const Counts counts = counts_of(found);
  EXPECT_EQ(counts.at({FeatureKind::vertex, FeatureKind::vertex}).first, 25U);
  std::size_t pairs = 0;
  for (const auto& [kinds, both] : counts) pairs += both.second;
  EXPECT_EQ(pairs, count.vertex_face + count.edge_edge);
  for (const FeaturePair& p : found.list()) EXPECT_EQ(p.normal, (Vec3{0, 0, 1}));
}

TEST(FeaturePairs, AreTheSameAtAnyScale) {
  const Mesh ball = scenes::ball(12, 8);
  FeaturePairs found, of_scaled;
  const Transform aside{{}, {2.0625, 0.25, 0.125}};
  const Model unit(ball);
  feature_pairs({unit}, {unit, aside}, 0.25, found);
  ASSERT_GT(found.list().size(), 10U);
  for (const int exponent : {-300, -100, 100, 150}) {
    const double scale = std::ldexp(1.0, exponent);
    const Model model(scaled(ball, scale));
    feature_pairs({model}, {model, {{}, scale * aside.translation}}, 0.25 * scale, of_scaled);
    ASSERT_EQ(of_scaled.list().size(), found.list().size());
    for (std::size_t i = 0; i < found.list().size(); ++i) {
      const FeaturePair &p = found.list()[i], &q = of_scaled.list()[i];
      EXPECT_EQ(ids_of(p), ids_of(q));
      EXPECT_EQ(p.multiplicity, q.multiplicity);
      EXPECT_NEAR(q.distance / scale, p.distance, 1e-15);
      EXPECT_LE(max_abs(q.normal - p.normal), 1e-14);
    }
  }
}

TEST(FeaturePairs, FarFromTheOriginHaveExactNormals) {
  std::vector<Vec3> positions{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}, {0, 0, 0x1p-10}, {1, 0, 1}, {0, 1, 1}};
  for (Vec3& p : positions) p += Vec3{0x1p40, 0x1p40, 0x1p40};
  const Model model(small_mesh(positions, {{0, 1, 2}, {3, 4, 5}}));
  FeaturePairs found;
  self_feature_pairs(model, 0x1p-9, found);
  ASSERT_EQ(found.list().size(), 1U);
  expect_kinds(found.list()[0], FeatureKind::vertex, FeatureKind::face, 1);
  EXPECT_EQ(found.list()[0].distance, 0x1p-10);
  EXPECT_EQ(found.list()[0].normal, (Vec3{0, 0, -1}));  // from the vertex, which is a
}

TEST(FeaturePairs, StayInMemoryUntilTheNextCall) {
  const Model ball(scenes::ball(20, 12));
  FeaturePairs found;
  EXPECT_TRUE(found.list().empty());
  self_feature_pairs(ball, 0.3, found);
  const std::size_t count = found.list().size();
  ASSERT_GT(count, 100U);
  FeaturePairs moved = std::move(found);
  EXPECT_EQ(moved.list().size(), count);
  EXPECT_TRUE(found.list().empty());  // NOLINT(bugprone-use-after-move)
  self_feature_pairs(ball, 0, moved);
  EXPECT_TRUE(moved.list().empty());
  self_feature_pairs(ball, 0.3, found);
  self_feature_pairs(ball, 0.3, moved);
  for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(key_of(found.list()[i]), key_of(moved.list()[i]));
}

TEST(FeaturePairs, WithABudgetAreSomeOfAll) {
  const Model ball(scenes::ball(20, 12));
  FeaturePairs all, some;
  const ElementPairCount every = self_feature_pairs(ball, 0.4, all);
  std::map<decltype(ids_of(FeaturePair{})), std::uint32_t> multiplicities;
  for (const FeaturePair& p : all.list()) multiplicities[ids_of(p)] = p.multiplicity;
  const ElementPairCount count = self_feature_pairs(ball, 0.4, some, {.budget = {.max_steps = 60}});
  EXPECT_FALSE(count.is_complete);
  EXPECT_EQ(count.stopped_by, StoppedBy::max_steps);
  EXPECT_LT(count.edge_edge, every.edge_edge);
  ASSERT_GT(some.list().size(), 0U);
  for (const FeaturePair& p : some.list()) EXPECT_LE(p.multiplicity, multiplicities.at(ids_of(p)));
}

TEST(FeaturePairsMisuse, IsRefused) {
  const Mesh mesh = scenes::ball(6, 4);
  const Model model(mesh);
  Model moved(mesh);
  moved.move_all(mesh.positions()).value();
  FeaturePairs found;
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    EXPECT_THROW(feature_pairs({model}, {model}, bad, found), std::invalid_argument);
    EXPECT_THROW(self_feature_pairs(model, bad, found), std::invalid_argument);
  }
  const Transform doubled{{{2, 0, 0}, {0, 2, 0}, {0, 0, 2}}, {}};
  const Shape sphere = Shape::sphere(1);
  for (const Placed& wrong : {Placed{moved}, Placed{model, doubled}, Placed{sphere}}) {
    EXPECT_THROW(feature_pairs({model}, wrong, 1, found), std::invalid_argument);
    EXPECT_THROW(feature_pairs(wrong, {model}, 1, found), std::invalid_argument);
  }
  EXPECT_THROW(self_feature_pairs(moved, 1, found), std::invalid_argument);
  self_feature_pairs(model, 0.5, found);
  EXPECT_FALSE(found.list().empty());
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models whose triangles share a vertex or an edge, compared with themselves: as brute force, and in little more time
// than other models of their size.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <tuple>
#include <vector>

#include "limber/contacts.h"
#include "limber/elements.h"
#include "reference/reference.h"
#include "support/fans.h"

namespace limber::testing {
namespace {

std::vector<TrianglePair> in_order_of_ids(std::vector<TrianglePair> pairs) {
  std::sort(pairs.begin(), pairs.end(),
            [](const TrianglePair& p, const TrianglePair& q) { return std::tie(p.a, p.b) < std::tie(q.a, q.b); });
  return pairs;
}

TEST(Fans, MeetThemselvesWhereBruteForceSaysSo) {
  Rng rng(1701);
  std::size_t pairs = 0, meeting = 0;
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = arbitrary_fan(rng);
    const Model model(mesh);
    std::vector<TrianglePair> found;
    visit_self_intersections(model, [&](const TrianglePair& pair) { return found.push_back(pair), true; });
    const std::vector<TrianglePair> truth = in_order_of_ids(reference::self_intersections(mesh));
    ASSERT_EQ(found.size(), truth.size());
    found = in_order_of_ids(std::move(found));
    for (std::size_t k = 0; k < truth.size(); ++k) {
      ASSERT_EQ(std::tie(found[k].a, found[k].b), std::tie(truth[k].a, truth[k].b));
    }
    ASSERT_EQ(self_collide(model).is_yes(), !truth.empty());
    pairs += truth.size(), meeting += truth.empty() ? 0 : 1;
  }
  EXPECT_GT(pairs, 1000U);
  EXPECT_GT(meeting, 15U);
  EXPECT_LT(meeting, 120U);
}

TEST(Fans, HaveTheElementPairsOfBruteForce) {
  Rng rng(1702);
  std::size_t pairs = 0;
  for (int i = 0; i < 100; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = arbitrary_fan(rng);
    const Model model(mesh);
    const double size = model.bounding_sphere().radius;
    const double margin = rng.below(4) == 0 ? 0 : size * std::ldexp(1.0, -4 - static_cast<int>(rng.below(20)));
    std::size_t missing_may_be = 0;
    const reference::ElementPairs truth = reference::self_element_pairs(mesh, margin);
    const double certain = margin - 1e-13 * (size + max_abs(model.bounding_sphere().center));
    for (const VertexFacePair& p : truth.vertex_face) missing_may_be += p.distance > certain ? 1 : 0;
    for (const EdgeEdgePair& p : truth.edge_edge) missing_may_be += p.distance > certain ? 1 : 0;
    const ElementPairCount found = self_element_pairs(model, MeshEdges(mesh), margin, {}, {});
    const std::size_t all = truth.vertex_face.size() + truth.edge_edge.size();
    ASSERT_LE(found.vertex_face + found.edge_edge, all);
    ASSERT_GE(found.vertex_face + found.edge_edge + (margin == 0 ? 0 : missing_may_be), all);
    pairs += all;
  }
  EXPECT_GT(pairs, 10000U);
}

TEST(Fans, TakeLittleMoreThanTimeInProportionToTheirSize) {
  for (const bool is_book : {false, true}) {
    SCOPED_TRACE(is_book);
    std::uint64_t tests[2];
    for (const std::uint32_t k : {0U, 1U}) {
      const std::uint32_t count = 2000U << (3 * k);
      tests[k] = self_collide(Model(is_book ? book(count) : flat_fan(count))).stats.node_tests;
    }
    EXPECT_LT(tests[1], 12 * tests[0]);  // 64 times if all leaves were compared with each other
  }
  const Model copies(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Corners>(8000, {0, 1, 2})).value());
  EXPECT_LT(self_collide(copies).stats.node_tests, 20000U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles that are near along the surface, against a search from every vertex.
#include <gtest/gtest.h>

#include <vector>

#include "limber/contacts.h"
#include "reference/reference.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// Triangles of random vertices, some of which name a vertex twice; sheets and balls with odd triangles.
Mesh tangled(Rng& rng) {
  if (rng.below(3) == 0) {
    std::vector<Vec3> positions(1 + rng.below(60));
    std::vector<Corners> triangles(1 + rng.below(40));
    for (Corners& c : triangles) {
      for (VertexId& v : c) v = static_cast<VertexId>(rng.below(positions.size()));
    }
    return Mesh::create(std::move(positions), std::move(triangles)).value();
  }
  const Mesh mesh = rng.below(2) == 0 ? scenes::ball(some(rng, 3, 10), some(rng, 2, 8))
                                      : scenes::grid(some(rng, 1, 10), some(rng, 1, 10), 0, 0, 1, 1);
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& c : triangles) {
    if (rng.below(30) == 0) c[rng.below(3)] = static_cast<VertexId>(rng.below(mesh.positions().size()));
  }
  return Mesh::create(mesh.positions(), std::move(triangles)).value();
}

TEST(NeighborRingsProperty, AreThoseOfASearchFromEveryVertex) {
  Rng rng(1501);
  std::size_t near_count = 0, far_count = 0;
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    const Mesh mesh = tangled(rng);
    const auto edges = static_cast<std::uint32_t>(rng.below(6));
    const NeighborRings rings(mesh, edges);
    const std::vector<TrianglePair> truth = reference::near_pairs(mesh, edges);
    ASSERT_EQ(rings.pair_count(), truth.size());
    std::size_t next = 0;
    for (TriangleId a = 0; a < mesh.triangles().size(); ++a) {
      for (TriangleId b = a + 1; b < mesh.triangles().size(); ++b) {
        const bool is_near = next < truth.size() && truth[next] == TrianglePair{a, b};
        next += is_near ? 1 : 0;
        ASSERT_EQ(rings.are_near(a, b), is_near) << a << ' ' << b;
        ASSERT_EQ(rings.are_near(b, a), is_near) << b << ' ' << a;
        ++(is_near ? near_count : far_count);
      }
    }
  }
  EXPECT_GT(near_count, 10'000U);
  EXPECT_GT(far_count, 10'000U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles that are near along the surface: known answers, against a search from every vertex, and as a filter.
#include "limber/contacts.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

constexpr std::uint32_t most_edges = std::numeric_limits<std::uint32_t>::max();

TEST(NeighborRings, OfAStripReachOneSquareFurtherWithEachEdge) {
  // A strip of 30 squares: square k has triangles 2 k and 2 k + 1, which have vertices on both sides of it.
  const Mesh strip = scenes::grid(30, 1, 0, 0, 1, 1);
  for (const std::uint32_t edges : {1U, 2U, 5U}) {
    const NeighborRings rings(strip, edges);
    EXPECT_EQ(rings.triangle_count(), 60U);
    for (TriangleId b = 0; b < 60; ++b) {
      EXPECT_EQ(rings.are_near(0, b), b / 2 <= edges + 1) << edges << ' ' << b;
      EXPECT_EQ(rings(0, b), b / 2 > edges + 1) << edges << ' ' << b;
    }
  }
  EXPECT_EQ(NeighborRings(strip, most_edges).pair_count(), 60U * 59 / 2);
}

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

TEST(NeighborRings, AreThoseOfASearchFromEveryVertex) {
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

TEST(NeighborRings, DoNotJumpFromPieceToPiece) {
  const NeighborRings rings(soup({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}), most_edges);
  EXPECT_FALSE(rings.are_near(0, 1));  // equal positions, other vertices
  EXPECT_TRUE(rings.are_near(0, 0));
  EXPECT_EQ(rings.pair_count(), 0U);
}

TEST(NeighborRings, LeaveOnlyContactsOfOtherParts) {
  // A sheet that is folded in the middle, a little above itself.
  const Mesh flat = scenes::grid(20, 4, 0, 0, 1, 1);
  std::vector<Vec3> positions = flat.positions();
  for (Vec3& p : positions) {
    if (p.x > 10) p.x = 20 - p.x, p.z = 0.5;
  }
  const Model model(Mesh::create(positions, flat.triangles()).value());
  const NeighborRings rings(flat, 2);
  const std::size_t all = self_contacts(model, 0.6, {}).count;
  std::vector<Contact> found(all);
  const std::size_t far = self_contacts(model, 0.6, found, {.filter = rings}).count;
  EXPECT_GT(far, 100U);
  EXPECT_LT(far, all);
  for (std::size_t i = 0; i < far; ++i) EXPECT_NE(found[i].point_a.z, found[i].point_b.z);
}

TEST(NeighborRings, RefuseMeshesAndTrianglesThatAreNotThere) {
  Mesh mesh = scenes::grid(2, 2, 0, 0, 1, 1);
  NeighborRings rings(mesh, 1);
  EXPECT_THROW((void)rings.are_near(0, 8), std::invalid_argument);
  EXPECT_THROW((void)rings(no_id, 0), std::invalid_argument);
  const Model larger(scenes::grid(6, 6, 0, 0, 1, 1));
  EXPECT_THROW(self_contacts(larger, 10, {}, {.filter = rings}), std::invalid_argument);
  const NeighborRings taken_rings = std::move(rings);
  EXPECT_TRUE(taken_rings.are_near(0, 1));
  EXPECT_THROW((void)rings.are_near(0, 1), std::invalid_argument);  // NOLINT(*-use-after-move,*-cplusplus.Move)
  const Mesh taken = std::move(mesh);
  EXPECT_EQ(taken.triangles().size(), 8U);
  EXPECT_THROW(NeighborRings(mesh, 1), std::invalid_argument);  // NOLINT(bugprone-use-after-move)
}

}  // namespace
}  // namespace limber::testing

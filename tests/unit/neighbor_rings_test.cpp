// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Triangles that are near along the surface: known answers, and as a filter. Random meshes are in tests/property.
#include "limber/contacts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr std::uint32_t most_edges = std::numeric_limits<std::uint32_t>::max();

TEST(NeighborRings, WithoutEdgesAreTrianglesThatShareAVertex) {
  // A strip of 10 squares: square k has triangles 2 k and 2 k + 1.
  const Mesh strip = scenes::grid(10, 1, 0, 0, 1, 1);
  const NeighborRings rings(strip, 0);
  EXPECT_EQ(rings.triangle_count(), 20U);
  for (TriangleId a = 0; a < 20; ++a) {
    for (TriangleId b = 0; b < 20; ++b) {
      const Corners &ids_a = strip.triangles()[a], &ids_b = strip.triangles()[b];
      const bool share = std::find_first_of(ids_a.begin(), ids_a.end(), ids_b.begin(), ids_b.end()) != ids_a.end();
      EXPECT_EQ(rings.are_near(a, b), share) << a << ' ' << b;
      EXPECT_EQ(rings(a, b), !share) << a << ' ' << b;
    }
  }
}

TEST(NeighborRings, ReachOneSquareFurtherWithEachEdge) {
  const Mesh strip = scenes::grid(30, 1, 0, 0, 1, 1);
  for (const std::uint32_t edges : {1U, 2U, 5U}) {
    const NeighborRings rings(strip, edges);
    // Every triangle of a strip has vertices on both sides of its square.
    for (TriangleId b = 0; b < 60; ++b) EXPECT_EQ(rings.are_near(0, b), b / 2 <= edges + 1) << edges << ' ' << b;
    EXPECT_TRUE(rings.are_near(59, 59 - 2 * edges));
  }
  EXPECT_EQ(NeighborRings(strip, most_edges).pair_count(), 60U * 59 / 2);
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Work that other libraries do without need, in counts that do not depend on the machine.
#include "limber/points.h"
#include "peers.h"

namespace limber::testing {
namespace {

std::uint64_t steps(const QueryStats& stats) { return stats.node_tests + stats.primitive_tests; }

// FCL #276: a distance costs ten to a hundred times as much as a collision. It takes fewer steps than a body has
// triangles, and fewer yet where a rough one will do.
TEST(Effort, OfADistanceIsBelowTheNumberOfTriangles) {
  scenes::Rng rng(276);
  const Model a(scenes::ring(60, 30, 0.3)), b(scenes::ball(48, 32));
  const int poses = 60;
  std::uint64_t exactly = 0, roughly = 0;
  for (int i = 0; i < poses; ++i) {
    const Placed there{b, random_pose(rng, 3)};
    exactly += steps(distance({a}, there).stats);
    roughly += steps(distance({a}, there, {.relative_error = 0.1}).stats);
  }
  EXPECT_LT(exactly / poses, a.mesh().triangles().size());
  EXPECT_LT(roughly, exactly);
}

// Drake #15080, PR #15221: contact of a body that deforms compares all pairs, because trees are made for rigid meshes.
TEST(Effort, ContactsOfABodyThatDeformsNeedNoPassOverAllPairs) {
  const Mesh rest = scenes::ball(24, 16);
  Model body(rest);
  const Model floor(scenes::grid(20, 20, -2, -2, 0.2, 0.2));
  const std::size_t all_pairs = rest.triangles().size() * floor.mesh().triangles().size();
  for (int frame = 1; frame <= 5; ++frame) {
    std::vector<Vec3> positions = rest.positions();
    for (Vec3& p : positions) p.x += 0.08 * frame * p.y * p.z, p.z *= 1 + 0.08 * frame;
    body.move_all(positions).value();
    body.commit();
    const Placed there{body, at(0, 0, 0.9)};
    const PairCount found = contacts({floor}, there, 0.001, {});
    EXPECT_EQ(found.count, reference::contacts(in_reference({floor}), in_reference(there), 0.001).size());
    EXPECT_LT(steps(found.stats), all_pairs / 100) << frame;
  }
}

// PhysX (Omniverse) #399: whether bodies are closer than a tolerance is asked by listing all pairs that are, which is
// slow.
TEST(Effort, AThresholdIsCheaperThanTheListOfPairsBelowIt) {
  const Model a(scenes::ball(48, 32));
  const Placed there{a, at(1.99, 0.05, 0.02)};
  const CollideResult near = within({a}, there, 0.3);
  const PairCount listed = contacts({a}, there, 0.3, {});
  EXPECT_TRUE(near.is_yes());
  EXPECT_GT(listed.count, 1000U);
  EXPECT_LT(steps(near.stats), 200U);
  EXPECT_LT(20 * steps(near.stats), steps(listed.stats));
}

}  // namespace
}  // namespace limber::testing

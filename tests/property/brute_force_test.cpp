// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The brute force of the tests against that of the library.
#include "support/brute_force.h"

#include <gtest/gtest.h>

#include "support/random_scene.h"

namespace limber::testing {
namespace {

TEST(BruteForce, EqualsTheReferenceToTheBitWhateverItSkips) {
  Rng rng(92);
  int contacts = 0;
  for (int i = 0; i < 1000; ++i) {
    const Scene s = arbitrary_scene(rng);
    const double truth = reference::distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}).upper;
    ASSERT_EQ(brute_force_distance({s.mesh_a, s.pose_a}, {s.mesh_b, s.pose_b}), truth) << "scene " << i;
    contacts += truth == 0 ? 1 : 0;
  }
  EXPECT_GT(contacts, 50);
  EXPECT_LT(contacts, 950);
}

}  // namespace
}  // namespace limber::testing

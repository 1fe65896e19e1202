// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The tree against brute force on real meshes: some ten million pairs of triangles for every answer.
#include <gtest/gtest.h>

#include <cmath>

#include "limber/classic.h"
#include "limber/io.h"
#include "limber/reference.h"
#include "scenes/scenes.h"
#include "support/real_meshes.h"

namespace limber::testing {
namespace {

TEST(RealMeshes, TreeEqualsBruteForceApartNearAndOverlapping) {
  if (!std::filesystem::exists(real_mesh("spot.obj")) || !std::filesystem::exists(real_mesh("beetle.obj"))) {
    GTEST_SKIP() << "no data";
  }
  const classic::Model spot(load_mesh(real_mesh("spot.obj")).value());
  const classic::Model beetle(load_mesh(real_mesh("beetle.obj")).value());
  scenes::Rng rng(80);
  int contacts = 0;
  for (const double away : {0.3, 1.2, 1.5, 6.0}) {
    const Transform pose_a{scenes::random_rotation(rng), {}};
    const Transform pose_b{scenes::random_rotation(rng), {away, 0.2 * away, 0}};
    const DistanceResult truth = reference::distance({spot.mesh(), pose_a}, {beetle.mesh(), pose_b});
    const DistanceResult found = classic::distance({spot, pose_a}, {beetle, pose_b});
    EXPECT_EQ(found.upper, truth.upper) << away;
    EXPECT_EQ(found.lower, truth.lower) << away;
    EXPECT_EQ(classic::collide({spot, pose_a}, {beetle, pose_b}).collision, truth.upper == 0) << away;
    const DistanceResult roughly = classic::distance({spot, pose_a}, {beetle, pose_b}, {.relative_error = 0.1});
    EXPECT_LE(truth.upper, roughly.upper) << away;
    EXPECT_LE(roughly.upper, 1.1 * truth.upper) << away;
    EXPECT_LE(roughly.lower, truth.upper) << away;
    contacts += truth.upper == 0 ? 1 : 0;
  }
  EXPECT_GT(contacts, 0);
  EXPECT_LT(contacts, 4);
}

}  // namespace
}  // namespace limber::testing

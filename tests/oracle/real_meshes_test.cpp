// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The trees compared with brute force on real meshes: some ten million pairs of triangles for every answer.
#include <gtest/gtest.h>

#include <cmath>

#include "limber/distance.h"
#include "limber/io.h"
#include "limber/model.h"
#include "reference/classic/classic.h"
#include "scenes/scenes.h"
#include "support/brute_force.h"
#include "support/real_meshes.h"

namespace limber::testing {
namespace {

TEST(RealMeshes, AreAnsweredAsByBruteForceApartNearAndOverlapping) {
  const Mesh mesh = load_mesh(real_mesh("spot.ply")).value(), ball_mesh = scenes::thesis_ball();
  const Model spot(mesh), ball(ball_mesh);
  const classic::Model classic_spot(mesh), classic_ball(ball_mesh);
  scenes::Rng rng(80);
  int contacts = 0;
  for (const double offset : {0.8, 2.5}) {
    const Transform pose_a{scenes::random_rotation(rng), {}};
    const Transform pose_b{scenes::random_rotation(rng), {offset, 0.2 * offset, 0}};
    const double truth = brute_force_distance({mesh, pose_a}, {ball_mesh, pose_b});
    const DistanceResult found = distance({spot, pose_a}, {ball, pose_b});
    const DistanceResult classic_found = classic::distance({classic_spot, pose_a}, {classic_ball, pose_b});
    EXPECT_NEAR(found.upper, truth, 0x1p-45 * (2 + offset)) << offset;
    EXPECT_EQ(found.lower, found.upper) << offset;
    EXPECT_EQ(classic_found.upper, truth) << offset;
    EXPECT_EQ(classic_found.lower, truth) << offset;
    EXPECT_EQ(collide({spot, pose_a}, {ball, pose_b}).is_yes(), truth == 0) << offset;
    EXPECT_EQ(classic::collide({classic_spot, pose_a}, {classic_ball, pose_b}).is_yes(), truth == 0) << offset;
    for (const DistanceResult& roughly :
         {distance({spot, pose_a}, {ball, pose_b}, {.relative_error = 0.1}),
          classic::distance({classic_spot, pose_a}, {classic_ball, pose_b}, {.relative_error = 0.1})}) {
      EXPECT_LE(truth, roughly.upper * (1 + 1e-14)) << offset;
      EXPECT_LE(roughly.upper, 1.1 * truth * (1 + 1e-14)) << offset;
      EXPECT_LE(roughly.lower, truth * (1 + 1e-14)) << offset;
    }
    contacts += truth == 0 ? 1 : 0;
  }
  EXPECT_GT(contacts, 0);
  EXPECT_LT(contacts, 2);
}

TEST(RealMeshes, ThatDeformAreAnsweredAsByBruteForce) {
  const Mesh mesh = load_mesh(real_mesh("spot.ply")).value();
  Model deforming(mesh, {.motion_margin = 0.02});
  const Model ball(scenes::thesis_ball());
  const Transform pose{{}, {1.6, 0.5, 0.2}};
  QueryCache cache;
  for (int frame = 0; frame < 2; ++frame) {
    std::vector<Vec3> positions = mesh.positions();
    for (Vec3& p : positions) p.x += 0.1 * scenes::sine(3 * p.y + frame), p.z *= 1 + 0.05 * frame;
    deforming.move_all(positions).value();
    deforming.commit();
    ASSERT_TRUE(static_cast<bool>(deforming.validate()));
    const double truth = brute_force_distance({deforming.mesh()}, {ball.mesh(), pose});
    EXPECT_NEAR(distance({deforming}, {ball, pose}).upper, truth, 0x1p-43) << frame;
    EXPECT_NEAR(distance({deforming}, {ball, pose}, {.cache = &cache}).upper, truth, 0x1p-43) << frame;
  }
}

}  // namespace
}  // namespace limber::testing

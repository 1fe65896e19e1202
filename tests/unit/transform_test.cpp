// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "support/random_geometry.h"

namespace limber::testing {
namespace {

TEST(Transform, TurnsThenShifts) {
  const double h = std::sqrt(0.5);  // a quarter turn around z
  const Transform t = transform_from_quaternion({10, 0, 0}, h, 0, 0, h).value();
  EXPECT_NEAR(length(t({1, 0, 0}) - Vec3{10, 1, 0}), 0, 1e-15);
}

TEST(Transform, InverseAndProductUndoEachOther) {
  Rng rng(1);
  for (int i = 0; i < 200; ++i) {
    const Transform a = random_pose(rng, 5), b = random_pose(rng, 5);
    const Vec3 p = uniform_point(rng);
    EXPECT_NEAR(length((a * b)(p)-a(b(p))), 0, 1e-14);
    EXPECT_NEAR(length(inverse(a)(a(p)) - p), 0, 1e-14);
    EXPECT_TRUE(is_rigid(a));
    EXPECT_TRUE(is_rigid(inverse(a * b)));
  }
}

TEST(Transform, QuaternionOfAnyLengthGivesTheSameRotation) {
  const Transform one = transform_from_quaternion({}, 0.5, 0.5, 0.5, 0.5).value();
  for (const double scale : {1e-300, 3.0, 1e300}) {
    const Transform other = transform_from_quaternion({}, scale, scale, scale, scale).value();
    EXPECT_NEAR(length(other({1, 2, 3}) - one({1, 2, 3})), 0, 1e-14);
  }
  EXPECT_NEAR(length(one({1, 0, 0}) - Vec3{0, 1, 0}), 0, 1e-15);
}

TEST(Transform, BadInputIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(transform_from_quaternion({}, 0, 0, 0, 0).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({}, nan, 0, 0, 1).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({nan, 0, 0}, 1, 0, 0, 0).error().code, ErrorCode::non_finite);
  EXPECT_EQ(transform_from_quaternion({1e300, 0, 0}, 1, 0, 0, 0).error().code, ErrorCode::too_large);
}

TEST(Transform, ReflectionsAndStretchesAreNotRigid) {
  EXPECT_TRUE(is_rigid({}));
  EXPECT_FALSE(is_rigid({{{-1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}));
  EXPECT_FALSE(is_rigid({{{1.001, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {}}));
  EXPECT_FALSE(is_rigid({{}, {std::numeric_limits<double>::infinity(), 0, 0}}));
  EXPECT_FALSE(is_rigid({{}, {0x1p201, 0, 0}}));
}

TEST(Transform, StretchBoundIsNeverBelowTheTrueStretch) {
  Rng rng(2);
  for (int i = 0; i < 200; ++i) {
    Mat3 m = scenes::random_rotation(rng);
    m.row0 += uniform_point(rng) * 1e-3;
    const double bound = max_stretch(m);
    EXPECT_GE(bound, 1);
    for (int k = 0; k < 50; ++k) {
      const Vec3 v = uniform_point(rng);
      EXPECT_LE(length(m * v), bound * length(v));
    }
  }
}

}  // namespace
}  // namespace limber::testing

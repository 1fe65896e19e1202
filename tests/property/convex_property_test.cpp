// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Random convex hulls, on a lattice and off it: distances as those of their triangles, depths as by all normals that
// the border of the Minkowski difference can have.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "limber/convex.h"
#include "limber/shapes.h"
#include "reference/convex_depth.h"
#include "support/random_bodies.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

/// Two hulls, some of them flat, and their poses.
struct HullPair {
  Shape a, b;
  Transform pose_a, pose_b;

  static Shape hull(Rng& rng, std::uint64_t most) {
    const std::uint64_t kind = rng.below(8);
    const std::size_t count = 1 + rng.below(most);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) {
      Vec3 p = kind < 4 ? uniform_point(rng) : 0.5 * (lattice_point(rng, 5) - Vec3{2, 2, 2});
      if (kind == 3) p.z *= 1e-6;
      if (kind == 7) p.z = 0;
      points.push_back(p);
    }
    return Shape::convex_hull(points);
  }
  HullPair(Rng& rng, std::uint64_t most) : a(hull(rng, most)), b(hull(rng, most)) {
    if (rng.below(2) == 0) {
      pose_b.translation = 0.5 * (lattice_point(rng, 5) - Vec3{2, 2, 2});
    } else {
      pose_a = random_pose(rng, 0.5), pose_b = random_pose(rng, 1);
    }
    if (rng.below(8) == 0) pose_a.translation += Vec3{1e6, 0, 0}, pose_b.translation += Vec3{1e6, 0, 0};
  }
};

std::vector<Vec3> placed_positions(const Shape& shape, const Transform& pose) {
  std::vector<Vec3> positions = shape.model().mesh().positions();
  for (Vec3& p : positions) p = pose(p);
  return positions;
}

template <typename Number>
Number depth_sq_of(const HullPair& pair) {
  return reference::LeastDepth<Number>(placed_positions(pair.a, pair.pose_a), pair.a.model().mesh().triangles(),
                                       placed_positions(pair.b, pair.pose_b), pair.b.model().mesh().triangles())
      .depth_sq();
}

double as_double(double x) { return x; }
double as_double(const Rational& x) { return x.get_d(); }

/// Checks a pair against brute force; whether it meets.
template <typename Number>
bool check(const HullPair& pair) {
  const Placed a(pair.a, pair.pose_a), b(pair.b, pair.pose_b);
  const BodiesTruth truth = truth_of(a, b);
  const DistanceResult near = distance(a, b);
  EXPECT_NEAR(near.upper, truth.distance(), truth.tolerance);
  EXPECT_EQ(near.upper == 0, truth.distance() == 0);
  EXPECT_EQ(collide(a, b).is_yes(), truth.distance() == 0);
  const ConvexDepth depth = convex_depth(a, b);
  if (truth.distance() > truth.tolerance) {
    EXPECT_EQ(depth.upper, 0);
    return false;
  }
  if (truth.distance() > 0) return false;
  const double exact = std::sqrt(as_double(depth_sq_of<Number>(pair)));
  EXPECT_LE(depth.lower, exact + 0.125 * truth.tolerance);
  EXPECT_GE(depth.upper, exact - 0.125 * truth.tolerance);
  EXPECT_LE(depth.upper - depth.lower, 4 * truth.tolerance) << "at a depth of " << exact;
  return true;
}

TEST(ConvexProperty, RandomHullsAreAsBruteForceSays) {
  Rng rng(21);
  int meeting = 0;
  for (int round = 0; round < 1500; ++round) {
    SCOPED_TRACE(::testing::Message() << "round " << round);
    meeting += check<double>(HullPair(rng, 12)) ? 1 : 0;
  }
  EXPECT_GT(meeting, 300);
}

TEST(ConvexProperty, LargerHullsAreAsBruteForceSays) {
  Rng rng(22);
  for (int round = 0; round < 40; ++round) {
    SCOPED_TRACE(::testing::Message() << "round " << round);
    check<double>(HullPair(rng, 80));
  }
}

TEST(ConvexProperty, DepthsAreAsRationalNumbersSay) {
  Rng rng(23);
  for (int round = 0; round < 60; ++round) {
    SCOPED_TRACE(::testing::Message() << "round " << round);
    check<Rational>(HullPair(rng, 6));
  }
}

}  // namespace
}  // namespace limber::testing

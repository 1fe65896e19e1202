// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels that compare a tree with a point.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "geometry/primitives.h"
#include "limber/points.h"
#include "point/placed_model.h"
#include "simd/kernels.h"
#include "support/random_points.h"
#include "unit/internals.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

using point::PlacedModel;

/// A model of a few leaves, flat or thin or points, and a point near it or far away.
struct PointCase {
  Model model;
  Transform pose;
  Vec3 point;
  std::vector<Triangle> world;

  explicit PointCase(Rng& rng) : model(some_soup(rng, 1 + rng.below(64))), pose(random_pose(rng, 1)) {
    point = arbitrary_query_point(rng, {model.mesh(), pose}, 4);
    world = placed_triangles(model.mesh(), pose);
  }
  const bvh::Tree& tree() const { return tree_of(model); }
  const bvh::Node& node() const { return lowest_node(model); }
  simd::QueryPoint in_frame() const { return PlacedModel({model, pose}).in_frame(point); }

  double distance_of(TriangleId t) const { return geometry::closest_on(world[t], point).distance; }
  double distance_of(const bvh::Leaf& leaf) const {
    double least = std::numeric_limits<double>::infinity();
    for (const TriangleId t : leaf.triangle) least = std::min(least, distance_of(t));
    return least;
  }
};

TEST(PointKernels, BoundsOfChildrenHoldTheirDistances) {
  Rng rng(831);
  int near = 0, far = 0, tight = 0;
  for (int i = 0; i < 4000; ++i) {
    const PointCase c(rng);
    const simd::QueryPoint in_frame = c.in_frame();
    const bvh::Node& node = c.node();
    simd::ChildrenInOrder children;
    simd::kernels().bound_children_to_point(node, in_frame, no_limit_sq, children);
    double least = std::numeric_limits<double>::infinity();
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const double truth = c.distance_of(c.tree().leaves[k]);
      const double bound = std::sqrt(std::max(0.0, static_cast<double>(children.bound[k]))) * c.tree().unit;
      ASSERT_LE(bound, truth) << "case " << i;
      tight += bound > 0.5 * truth ? 1 : 0;
      least = std::min(least, truth);
    }
    ASSERT_GE(static_cast<double>(children.upper) * c.tree().unit, least) << "case " << i;
    ASSERT_EQ(children.kept, (1U << node.child_count) - 1);
    ++near;
    if (!in_frame.is_far) continue;
    ++far;
    simd::kernels().bound_children_along(node, in_frame, no_limit_sq, children);
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const double bound = static_cast<double>(children.bound[k]) * c.tree().unit + in_frame.height;
      ASSERT_LE(bound, c.distance_of(c.tree().leaves[k]) + in_frame.error) << "case " << i;
    }
  }
  EXPECT_GT(far, 300);
  EXPECT_GT(tight, 2 * near);
}

TEST(PointKernels, IntervalsOfTrianglesHoldTheirDistances) {
  Rng rng(832);
  int dropped = 0;
  for (int i = 0; i < 6000; ++i) {
    const PointCase c(rng);
    const simd::QueryPoint in_frame = c.in_frame();
    const bvh::Node& node = c.node();
    const auto slot = static_cast<std::uint32_t>(rng.below(node.child_count));
    const bvh::Leaf& leaf = c.tree().leaves[slot];
    const double least = c.distance_of(leaf), limit = least * rng.uniform(1, 2);
    for (const bool along : {false, true}) {
      if (along && !in_frame.is_far) continue;
      const auto kernel = along ? simd::kernels().bound_triangles_along : simd::kernels().bound_triangles_to_point;
      simd::TriangleIntervals found;
      kernel(node, slot, leaf.corners, in_frame, limit, found);
      ASSERT_GE(static_cast<double>(found.upper) * found.step, least) << "case " << i;
      for (std::uint32_t k = 0; k < bvh::width; ++k) {
        const double truth = c.distance_of(leaf.triangle[k]);
        ASSERT_LE(static_cast<double>(found.lower[k]) * found.step, truth) << "case " << i;
        if ((found.kept >> k & 1) != 0) continue;
        ++dropped;
        ASSERT_TRUE(truth > limit || truth > least) << "case " << i;
      }
    }
  }
  EXPECT_GT(dropped, 10'000);
}

TEST(PointKernels, AreTheSameToTheBitOnEveryInstructionSet) {
  Rng rng(834);
  int ray_count = 0;
  for (int i = 0; i < 3000; ++i) {
    const PointCase c(rng);
    const simd::QueryPoint in_frame = c.in_frame();
    const bvh::Node& node = c.node();
    const auto slot = static_cast<std::uint32_t>(rng.below(node.child_count));
    const auto limit = static_cast<float>(rng.uniform(0, 1));
    const double length = rng.uniform(0, 4);
    const auto ask = [&](const simd::Kernels& set, bool along, simd::ChildrenInOrder& children,
                         simd::TriangleIntervals& intervals) {
      // Padding and what is not written compare equal.
      std::memset(&children, 0, sizeof(children));
      std::memset(&intervals, 0, sizeof(intervals));
      (along ? set.bound_children_along : set.bound_children_to_point)(node, in_frame, limit, children);
      (along ? set.bound_triangles_along : set.bound_triangles_to_point)(node, slot, c.tree().leaves[slot].corners,
                                                                         in_frame, length, intervals);
    };
    for (const bool along : {false, true}) {
      if (along && !in_frame.is_far) continue;
      simd::ChildrenInOrder children0, children;
      simd::TriangleIntervals intervals0, intervals;
      ask(simd::scalar_kernels, along, children0, intervals0);
      for (const simd::Kernels& set : simd::all_kernels()) {
        ask(set, along, children, intervals);
        ASSERT_EQ(std::memcmp(&children, &children0, sizeof(children)), 0) << set.name << ", case " << i;
        ASSERT_EQ(std::memcmp(&intervals, &intervals0, sizeof(intervals)), 0) << set.name << ", case " << i;
      }
    }
    const auto ray = PlacedModel({c.model, c.pose}).ray_from(c.point);
    if (!ray) continue;
    ++ray_count;
    const bvh::QuantizedTriangles& corners = c.tree().leaves[slot].corners;
    for (const simd::Kernels& set : simd::all_kernels()) {
      ASSERT_EQ(set.find_crossed_children(node, ray->in_frame),
                simd::scalar_kernels.find_crossed_children(node, ray->in_frame))
          << set.name << ", case " << i;
      ASSERT_EQ(set.find_crossed_triangles(node, slot, corners, ray->in_frame),
                simd::scalar_kernels.find_crossed_triangles(node, slot, corners, ray->in_frame))
          << set.name << ", case " << i;
    }
  }
  EXPECT_GT(ray_count, 1000);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bounds of volumes that are as small as what they hold, so that nothing but the error budget keeps a bound from
// exceeding the distance.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "limber/model.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"
#include "unit/internals.h"
#include "unit/kernel_cases.h"
#include "unit/shapes.h"

namespace limber::testing {
namespace {

using pair::Frames;
using pair::PlacedPair;
using pair::Pruning;
using pair::Side;

/// Points, each of them a leaf of equal triangles.
Mesh points(Rng& rng, std::size_t count) {
  std::vector<Triangle> triangles;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 p = uniform_point(rng, -2, 2);
    triangles.insert(triangles.end(), bvh::width, {p, p, p});
  }
  return soup(triangles);
}

/// Two placed models whose lowest nodes are compared.
struct Comparison {
  Placed a, b;
  PlacedPair placed;
  Frames frames;
  std::vector<Triangle> world_a, world_b;

  Comparison(const Placed& first, const Placed& second)
      : a(first),
        b(second),
        placed(a, b),
        frames(placed),
        world_a(placed_triangles(a.model().mesh(), a.pose)),
        world_b(placed_triangles(b.model().mesh(), b.pose)) {}

  ClosestPoints truth(std::uint32_t slot_a, std::uint32_t slot_b) const {
    return closest(tree_of(a.model()).leaves[slot_a], world_a, tree_of(b.model()).leaves[slot_b], world_b);
  }
  /// The children of a's node, compared with a slot of b.
  BoundedChildren children(std::uint32_t slot_b, bool as_leaf, const Pruning& pruning, float limit_sq = no_limit_sq,
                           bool has_bounds = true) {
    return {simd::kernels(),    lowest_node(a.model()), at_slot(b.model(), slot_b, as_leaf),
            frames.of(Side::a), pruning.of(Side::a),    limit_sq,
            has_bounds};
  }
};

TEST(Kernels, BoundsOfPointsNeverExceedDistances) {
  // A point of one model is next to nothing from a point of the other, and far from the origins of both nodes.
  Rng rng(206);
  int contact_count = 0;
  for (int i = 0; i < 300; ++i) {
    const Model a(points(rng, 1 + rng.below(8))), b(points(rng, 1 + rng.below(8)));
    const Transform pose_a = random_pose(rng, rng.below(3) == 0 ? 100 : 1);
    Transform pose_b = random_pose(rng, 0);
    const double apart = rng.below(2) == 0 ? 0 : std::pow(10.0, rng.uniform(-12, 0));
    pose_b.translation =
        pose_a(a.mesh().positions().back()) - pose_b(b.mesh().positions().back()) + apart * uniform_point(rng);
    Comparison c({a, pose_a}, {b, pose_b});
    for (std::uint32_t slot_a = 0; slot_a < lowest_node(a).child_count; ++slot_a) {
      for (std::uint32_t slot_b = 0; slot_b < lowest_node(b).child_count; ++slot_b) {
        const ClosestPoints truth = c.truth(slot_a, slot_b);
        const double cutoff = truth.distance * (1 + 1e-14);
        const Pruning without(c.placed, cutoff);
        const Pruning along = pruning_along(c.placed, cutoff, truth.point_b - truth.point_a);
        for (const bool as_leaf : {false, true}) {
          for (const Pruning* pruning : {&without, &along}) {
            const BoundedChildren found = c.children(slot_b, as_leaf, *pruning);
            ASSERT_TRUE(found.keeps(slot_a)) << "case " << i;
            ASSERT_LE(found.bound(slot_a, a), cutoff) << "case " << i;
          }
          // Where only contacts matter, points that are apart by no more than rounding overlap.
          if (truth.distance > 1e-15 * (1 + length(pose_a.translation))) continue;
          const Pruning any(c.placed, 0);
          ASSERT_TRUE(c.children(slot_b, as_leaf, any, contact_sq, false).overlaps(slot_a)) << "case " << i;
          ++contact_count;
        }
      }
    }
  }
  EXPECT_GT(contact_count, 200);
}

TEST(Kernels, BoundsOfBoxesThatTouchNeverExceedDistances) {
  // The corner of a brick is on a face of another one, nearly. Both bricks stand along the axes of their models, whose
  // poses are turned at random: boxes are the tightest volumes there.
  Rng rng(218);
  int apart_count = 0;
  for (int i = 0; i < 2000; ++i) {
    // A second leaf makes the node larger than the brick.
    const auto model = [&](const Vec3& half) {
      std::vector<Triangle> triangles;
      for (const Vec3& p : box_corners(-half, half)) triangles.push_back({p, p, p});
      const Vec3 far = half + uniform_point(rng, 1, 4);
      triangles.insert(triangles.end(), bvh::width, {far, far, far});
      return Model(soup(triangles));
    };
    const Vec3 half_a = uniform_point(rng, 0.1, 2), half_b = uniform_point(rng, 0.1, 2);
    const Model a = model(half_a), b = model(half_b);
    const Transform pose_a = random_pose(rng, rng.below(3) == 0 ? 100 : 1);
    Transform pose_b = random_pose(rng, 0);
    // Of either brick a corner is nearest; the other one has a point on a face there.
    const auto axis = static_cast<std::size_t>(rng.below(3));
    const bool corner_of_b = rng.below(2) == 0;
    const Mat3 &rotation = (corner_of_b ? pose_a : pose_b).rotation, &other = (corner_of_b ? pose_b : pose_a).rotation;
    const Vec3 &half = corner_of_b ? half_a : half_b, &other_half = corner_of_b ? half_b : half_a;
    Vec3 on_face = half * 0.5, normal;
    on_face[axis] = half[axis], normal[axis] = 1;
    const Vec3 n = rotation * normal, heights = transpose(other) * n;
    Vec3 corner;  // of the other brick, the lowest over the face
    for (std::size_t k = 0; k < 3; ++k) corner[k] = heights[k] > 0 ? -other_half[k] : other_half[k];
    const double gap = rng.below(2) == 0 ? 0 : std::pow(10.0, rng.uniform(-6, -1));
    const Vec3 shift = rotation * on_face + gap * n - other * corner;
    pose_b.translation = pose_a.translation + (corner_of_b ? shift : -shift);
    Comparison c({a, pose_a}, {b, pose_b});
    const auto leaf_of = [](const Model& m, std::size_t triangle) {
      for (std::uint32_t slot = 0; slot < lowest_node(m).child_count; ++slot) {
        for (const TriangleId t : tree_of(m).leaves[slot].triangle)
          if (t == triangle) return slot;
      }
      return bvh::width;
    };
    const std::uint32_t slot_a = leaf_of(a, 0), slot_b = leaf_of(b, 0);
    const double smallest = std::numeric_limits<double>::min();
    const Pruning any(c.placed, smallest);
    const double bound = c.children(slot_b, false, any).bound(slot_a, a);
    ASSERT_LE(bound, gap * (1 + 1e-9)) << "case " << i;
    // The same where nothing but overlap matters.
    const BoundedChildren met = c.children(slot_b, false, any, contact_sq, false);
    ASSERT_EQ(met.kept.all, met.kept.overlapping);
    const bool overlap = met.keeps(slot_a);
    ASSERT_TRUE(overlap || gap > 0) << "case " << i;
    ASSERT_EQ(overlap, met.order[slot_a] <= 0);
    apart_count += overlap ? 0 : 1;
    if (gap > 1e-3 * (1 + length(pose_b.translation))) {
      ASSERT_GT(bound, 0.9 * gap) << "case " << i;
      ASSERT_FALSE(overlap) << "case " << i;
    }
  }
  EXPECT_GT(apart_count, 500);
}

TEST(Kernels, BoundsOfFlatLeavesThatNearlyTouchNeverExceedDistances) {
  // Two disks face each other, nearly parallel. They nearly touch where both rims tilt towards the other disk. The sine
  // of a tilt is so small that its square is lost in rounding.
  Rng rng(207);
  for (int i = 0; i < 1000; ++i) {
    // In a frame where the boxes are of no use.
    const auto disk = [&](const Mat3& frame) {
      std::vector<Triangle> triangles;
      const auto rim = [&](int k) {
        return frame * Vec3{std::cos(std::numbers::pi * k / 4), std::sin(std::numbers::pi * k / 4), 0};
      };
      for (int k = 0; k < 8; ++k) triangles.push_back({{}, rim(k), rim(k + 1)});
      return soup(triangles);
    };
    const Mat3 frame_a = scenes::random_rotation(rng), frame_b = scenes::random_rotation(rng);
    const Model a(disk(frame_a)), b(disk(frame_b));
    const auto tilted = [](double sine) {
      const double cosine = std::sqrt(1 - sine * sine);
      return Mat3{{cosine, 0, -sine}, {0, 1, 0}, {sine, 0, cosine}};
    };
    const double sine_a = rng.uniform(0, 0.002), sine_b = rng.uniform(0, 0.002);
    const double gap = std::pow(10.0, rng.uniform(-9, -3));
    Comparison c({a, {tilted(sine_a) * transpose(frame_a), {}}},
                 {b, {tilted(-sine_b) * transpose(frame_b), {0, 0, sine_a + sine_b + gap}}});
    const Pruning pruning(c.placed, 1);
    const BoundedChildren found = c.children(0, false, pruning);
    ASSERT_TRUE(found.keeps(0)) << "case " << i;
    ASSERT_LE(found.bound(0, a), c.truth(0, 0).distance) << "case " << i;
  }
}

TEST(Kernels, CornersTowardsAPointAreNeverPruned) {
  // Along a direction a leaf extends as far as its farthest corner, which is only known up to its quantization.
  Rng rng(208);
  int corner_count = 0;
  for (int i = 0; i < 2000; ++i) {
    std::vector<Triangle> triangles(1 + rng.below(8));
    for (Triangle& t : triangles) t = uniform_triangle(rng);
    const Model a(points(rng, 4)), b(soup(triangles));
    Comparison c({a, random_pose(rng, 1)}, {b, random_pose(rng, 4)});
    for (std::uint32_t slot_a = 0; slot_a < lowest_node(a).child_count; ++slot_a) {
      const ClosestPoints truth = c.truth(slot_a, 0);
      const Vec3 direction = truth.point_b - truth.point_a;
      // Where other corners are nearer along the direction, it prunes less than it may.
      double nearest_sq = length_sq(direction);
      for (const Triangle& t : c.world_b) {
        for (std::size_t k = 0; k < 3; ++k) nearest_sq = std::min(nearest_sq, dot(direction, t[k] - truth.point_a));
      }
      if (truth.distance == 0 || nearest_sq < length_sq(direction) * (1 - 1e-9)) continue;
      ++corner_count;
      const double cutoff = truth.distance * (1 + 1e-9);
      const BoundedChildren found = c.children(0, true, pruning_along(c.placed, cutoff, direction));
      ASSERT_TRUE(found.keeps(slot_a)) << "case " << i;
      ASSERT_LE(found.bound(slot_a, a), cutoff) << "case " << i;
    }
  }
  EXPECT_GT(corner_count, 2000);
}

TEST(Kernels, WhatIsTooLargeToBeSquaredIsEverywhere) {
  // The other model is so large that its numbers, in units of this tree, have no squares in float32. The children may
  // be far from the origin of their node: it stays where it is when they slack.
  Rng rng(209);
  const double huge = 0x1p70;
  const Model b(soup({{{-huge, -huge, 0}, {huge, -huge, 0}, {0, huge, 0}}}));
  for (int i = 0; i < 100; ++i) {
    const Model a(points(rng, 8));
    Comparison c({a}, {b});
    bvh::Node node = lowest_node(a);
    const float slack = std::ldexp(1.0F, static_cast<int>(rng.below(60)));
    for (float* centers : {node.bounds.center_x, node.bounds.center_y, node.bounds.center_z}) {
      for (std::uint32_t k = 0; k < bvh::width; ++k) centers[k] += slack * static_cast<float>(rng.uniform(-1, 1));
    }
    node.radius += 2 * slack;
    const double smallest = std::numeric_limits<double>::min();
    for (const Vec3& direction : {Vec3{}, uniform_point(rng)}) {
      const Pruning pruning = pruning_along(c.placed, smallest, direction);
      for (const simd::Kernels& set : simd::all_kernels()) {
        const simd::SlotRef other = at_slot(b, 0, rng.below(2) == 0);
        for (const bool has_bounds : {true, false}) {
          const BoundedChildren found(set, node, has_bounds ? other : at_slot(b, 0, false), c.frames.of(Side::a),
                                      pruning.of(Side::a), contact_sq, has_bounds);
          ASSERT_EQ(found.kept.all, 0xffU) << set.name << " 2^" << std::log2(slack);
          ASSERT_EQ(found.kept.overlapping, 0xffU) << set.name;
        }
      }
    }
  }
}

TEST(Kernels, BoundsAlongSlabsNeverExceedDistances) {
  // A point of an edge of one model is at or next to one of the other: rods, and all that some_soup() has, in any pose.
  // Some have moved within their margin since their bounds were fitted.
  Rng rng(219);
  int moved_count = 0, better_count = 0, pruned_count = 0, contact_count = 0;
  for (int i = 0; i < 1500; ++i) {
    const Model a(rods(rng, 1 + rng.below(8), 2.5));
    const double margin = rng.below(2) == 0 ? 0 : 0.02;
    Model b(rng.below(3) == 0 ? some_soup(rng, 1 + rng.below(64)) : rods(rng, 1 + rng.below(8), 2.5),
            {.motion_margin = margin});
    std::vector<Vec3> moved = b.mesh().positions();
    for (Vec3& p : moved) p = p + 0.5 * margin * uniform_point(rng);
    b.move_all(moved).value();
    b.commit();
    moved_count += tree_of(b).slack > 0 ? 1 : 0;
    const Transform pose_a = random_pose(rng, rng.below(3) == 0 ? 100 : 1);
    Transform pose_b = random_pose(rng, 0);
    const auto some_point = [&](const Mesh& mesh) {
      const Triangle t = mesh.triangle(static_cast<TriangleId>(rng.below(mesh.triangles().size())));
      const double along = rng.below(2) == 0 ? 0 : rng.uniform(0, 1);
      return t.v0 + along * (t.v1 - t.v0);
    };
    const double apart = rng.below(2) == 0 ? 0 : std::pow(10.0, rng.uniform(-6, 0));
    pose_b.translation = pose_a(some_point(a.mesh())) - pose_b(some_point(b.mesh())) + apart * uniform_point(rng);
    const bool swapped = rng.below(2) == 0;
    const Placed first{a, pose_a}, second{b, pose_b};
    Comparison c(swapped ? second : first, swapped ? first : second);
    bvh::Node without = lowest_node(c.a.model()), other_without = lowest_node(c.b.model());
    without.elongated_slots = other_without.elongated_slots = 0;
    for (std::uint32_t slot_b = 0; slot_b < other_without.child_count; ++slot_b) {
      const Pruning contacts(c.placed, 0);
      const BoundedChildren touching = c.children(slot_b, false, contacts, contact_sq, false);
      const auto bounds_without = [&](const Pruning& pruning, float limit_sq, bool has_bounds) {
        return BoundedChildren(simd::kernels(), without, {&other_without, slot_b, nullptr}, c.frames.of(Side::a),
                               pruning.of(Side::a), limit_sq, has_bounds);
      };
      pruned_count += std::popcount(bounds_without(contacts, contact_sq, false).kept.all & ~touching.kept.all);
      for (std::uint32_t slot_a = 0; slot_a < without.child_count; ++slot_a) {
        const ClosestPoints truth = c.truth(slot_a, slot_b);
        const double cutoff = truth.distance * (1 + 1e-12) + 1e-14;
        const Pruning pruning(c.placed, cutoff);
        const BoundedChildren found = c.children(slot_b, false, pruning);
        ASSERT_TRUE(found.keeps(slot_a)) << "case " << i;
        ASSERT_LE(found.bound(slot_a, c.a.model()), cutoff) << "case " << i;
        const double before = bounds_without(pruning, no_limit_sq, true).bound(slot_a, c.a.model());
        ASSERT_GE(found.bound(slot_a, c.a.model()), before) << "case " << i;
        better_count += found.bound(slot_a, c.a.model()) > before ? 1 : 0;
        if (truth.distance > 1e-15 * (1 + length(pose_a.translation))) continue;
        ASSERT_TRUE(touching.keeps(slot_a) && touching.overlaps(slot_a)) << "case " << i;
        ++contact_count;
      }
    }
  }
  EXPECT_GT(moved_count, 600);
  EXPECT_GT(better_count, 1000);
  EXPECT_GT(pruned_count, 50);
  EXPECT_GT(contact_count, 200);
}

TEST(Kernels, MergedBoundsHoldTheRimsOfTheirChildren) {
  // Children are disks, most of them across the line to the center of all: then the farthest points are on their rims,
  // and how far the center is from the axis of a disk is lost in rounding.
  Rng rng(215);
  for (int i = 0; i < 2000; ++i) {
    bvh::Node node{};
    node.child_count = 2 + static_cast<std::uint32_t>(rng.below(7));
    const auto as_float = [](const Vec3& v, float(&x)[bvh::width], float(&y)[bvh::width], float(&z)[bvh::width],
                             std::uint32_t k) {
      x[k] = static_cast<float>(v.x), y[k] = static_cast<float>(v.y), z[k] = static_cast<float>(v.z);
    };
    bvh::ChildBounds& n = node.bounds;
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      as_float(uniform_point(rng), n.center_x, n.center_y, n.center_z, k);
      n.radius[k] = n.half_x[k] = n.half_y[k] = n.half_z[k] = static_cast<float>(rng.uniform(0.1, 1));
    }
    // The boxes alone decide where the center is.
    const bvh::MergedBounds around_boxes = simd::kernels().merge_bounds(node, false);
    const Vec3 middle{around_boxes.center[0], around_boxes.center[1], around_boxes.center[2]};
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const double tilt = rng.below(4) == 0 ? 1 : std::pow(10.0, rng.uniform(-5, -2));
      const Vec3 axis = bvh::local_slot_center(node, k) - middle + tilt * uniform_point(rng);
      as_float(axis * (1 / length(axis)), n.normal_x, n.normal_y, n.normal_z, k);
      const double thickness = n.radius[k] * std::pow(10.0, rng.uniform(-7, 0));
      n.low[k] = -static_cast<float>(thickness), n.high[k] = static_cast<float>(0.5 * thickness);
    }
    const bvh::MergedBounds whole = simd::kernels().merge_bounds(node, false);
    ASSERT_EQ(middle, (Vec3{whole.center[0], whole.center[1], whole.center[2]}));
    const Vec3 half{whole.half[0], whole.half[1], whole.half[2]};
    const Vec3 normal{whole.normal[0], whole.normal[1], whole.normal[2]};
    for (std::uint32_t k = 0; k < node.child_count; ++k) {
      const Vec3 stored{n.normal_x[k], n.normal_y[k], n.normal_z[k]}, axis = stored * (1 / length(stored));
      const Vec3 any = cross(axis, max_abs(axis) == std::abs(axis.x) ? Vec3{0, 1, 0} : Vec3{1, 0, 0});
      const Vec3 u = any * (1 / length(any)), v = cross(axis, u);
      for (const float cut : {n.low[k], n.high[k]}) {
        const double radius = n.radius[k], height = static_cast<double>(cut) / length(stored);
        const double rim = std::sqrt(radius * radius - height * height);
        for (int step = 0; step < 16; ++step) {
          const double angle = std::numbers::pi * step / 8;
          const Vec3 from_center = height * axis + rim * (std::cos(angle) * u + std::sin(angle) * v);
          const Vec3 p = bvh::local_slot_center(node, k) + (1 - 1e-12) * from_center - middle;
          ASSERT_LE(length(p), static_cast<double>(whole.radius)) << "case " << i;
          ASSERT_EQ(max(abs(p), half), half) << "case " << i;
          ASSERT_GE(dot(normal, p), static_cast<double>(whole.low)) << "case " << i;
          ASSERT_LE(dot(normal, p), static_cast<double>(whole.high)) << "case " << i;
        }
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing

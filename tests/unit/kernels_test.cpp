// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "simd/kernels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "limber/model.h"
#include "query/placed_pair.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using query::Heading;
using query::PlacedPair;
using query::Side;
using tree::Block;

constexpr float all = 1e38F;

/// Soups of one kind: spread out, in a small place, flat, thin, points.
Mesh some_soup(Rng& rng, std::size_t count) {
  std::vector<Triangle> triangles;
  const std::uint64_t kind = rng.below(5);
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at = uniform_point(rng, -2, 2);
    const double size = kind == 1 ? 1e-3 : 0.5;
    Triangle t{at, at + size * uniform_point(rng), at + size * uniform_point(rng)};
    if (kind == 2) t.v0.z = t.v1.z = t.v2.z = 0.25;
    if (kind == 3) t.v2 = t.v0 + 1e-6 * uniform_point(rng);
    if (kind == 4) t.v1 = t.v2 = t.v0;
    triangles.push_back(t);
  }
  return soup(triangles);
}

std::vector<Triangle> placed_triangles(const Mesh& mesh, const Transform& pose) {
  std::vector<Triangle> placed;
  for (TriangleId t = 0; t < mesh.triangles().size(); ++t) {
    const Triangle m = mesh.triangle(t);
    placed.push_back({pose(m.v0), pose(m.v1), pose(m.v2)});
  }
  return placed;
}

double closest(const tree::Leaf& a, const std::vector<Triangle>& world_a, const tree::Leaf& b,
               const std::vector<Triangle>& world_b) {
  double best = std::numeric_limits<double>::infinity();
  for (const TriangleId s : a.triangle) {
    for (const TriangleId t : b.triangle) best = std::min(best, closest_points(world_a[s], world_b[t]).distance);
  }
  return best;
}

/// Two models of a few leaves each, somewhere in the world.
struct Case {
  Model a, b;
  Transform pose_a, pose_b;
  std::vector<Triangle> world_a, world_b;

  explicit Case(Rng& rng)
      : a(some_soup(rng, 9 + rng.below(56))),
        b(some_soup(rng, 9 + rng.below(56))),
        pose_a(random_pose(rng, 1)),
        pose_b(random_pose(rng, rng.below(3) == 0 ? 100 : 3)),
        world_a(placed_triangles(a.mesh(), pose_a)),
        world_b(placed_triangles(b.mesh(), pose_b)) {}

  /// The nodes of leaves: lanes of block 1, which holds them all.
  static tree::NodeId leaf_node(std::uint32_t lane) { return simd::width + lane; }
};

TEST(Kernels, ScalarIsAmongThemAndLast) {
  const auto sets = simd::all_kernels();
  ASSERT_GE(sets.size(), 2U);
  EXPECT_STREQ(sets.back().name, "scalar");
  EXPECT_STREQ(simd::kernels().name, sets.front().name);
}

TEST(Kernels, BoundsNeverExceedDistances) {
  Rng rng(200);
  int told_apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const Block& lanes = c.a.tree().blocks[1];
    const auto facing_leaf = static_cast<std::uint32_t>(rng.below(c.b.tree().blocks[1].count));
    const simd::Facing facing = placed.facing(Side::a, lanes, Case::leaf_node(facing_leaf));
    float order[simd::width];
    const unsigned kept = simd::kernels().bound_lanes(lanes.bounds, lanes.count, facing, nullptr, all, order);
    ASSERT_EQ(kept, (1U << lanes.count) - 1);
    for (std::uint32_t lane = 0; lane < lanes.count; ++lane) {
      const double true_distance =
          closest(c.a.tree().leaves[lane], c.world_a, c.b.tree().leaves[facing_leaf], c.world_b);
      const double bound = order[lane] > 0 ? std::sqrt(static_cast<double>(order[lane])) * c.a.tree().unit : 0;
      ASSERT_LE(bound, true_distance) << "case " << i;
      told_apart += bound > 0.5 * true_distance ? 1 : 0;
    }
  }
  EXPECT_GT(told_apart, 3000);
}

TEST(Kernels, HeadingsNeverRuleOutWhatMatters) {
  Rng rng(201);
  int ruled_out = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const Block& lanes = c.a.tree().blocks[1];
    const auto facing_leaf = static_cast<std::uint32_t>(rng.below(c.b.tree().blocks[1].count));
    const tree::NodeId node = Case::leaf_node(facing_leaf);
    // From the middle of one to that of the other, more or less.
    const Vec3 way = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
    const Heading heading = placed.heading(way * (1 / length(way)));
    const simd::Facing facing = placed.facing(Side::a, lanes, node);
    const double reach = rng.below(2) == 0 ? placed.reach(Side::b, node, heading)
                                           : placed.leaf_reach(Side::b, node, facing_leaf, heading, simd::kernels());
    for (std::uint32_t lane = 0; lane < lanes.count; ++lane) {
      const double true_distance =
          closest(c.a.tree().leaves[lane], c.world_a, c.b.tree().leaves[facing_leaf], c.world_b);
      const double cut = true_distance * rng.uniform(1, 1.01) + 1e-12;  // so that the lane matters
      float order[simd::width];
      const simd::Toward toward = placed.toward(Side::a, lanes, node, reach, heading, cut);
      const unsigned kept = simd::kernels().bound_lanes(lanes.bounds, lanes.count, facing, &toward, all, order);
      ASSERT_TRUE((kept >> lane & 1) != 0) << "case " << i;
      const simd::Toward nearer = placed.toward(Side::a, lanes, node, reach, heading, 0.8 * true_distance + 1e-12);
      if ((simd::kernels().bound_lanes(lanes.bounds, lanes.count, facing, &nearer, all, order) >> lane & 1) == 0) {
        ++ruled_out;
      }
    }
  }
  EXPECT_GT(ruled_out, 3000);
}

TEST(Kernels, CandidatesContainEveryPairThatMatters) {
  Rng rng(202);
  int left_out = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const auto ka = static_cast<std::uint32_t>(rng.below(c.a.tree().blocks[1].count));
    const auto kb = static_cast<std::uint32_t>(rng.below(c.b.tree().blocks[1].count));
    const tree::Leaf &la = c.a.tree().leaves[ka], &lb = c.b.tree().leaves[kb];
    Heading heading;
    if (rng.below(2) == 0) {
      const Vec3 way = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
      heading = placed.heading(way * (1 / length(way)));
    }
    const double cut = closest(la, c.world_a, lb, c.world_b) * rng.uniform(1, 1.2) + 1e-12;
    double scale = 1;
    const simd::LeafPair pair = placed.leaf_pair(Case::leaf_node(ka), Case::leaf_node(kb), heading, cut, scale);
    simd::Candidate found[simd::width * simd::width];
    const std::uint32_t count = simd::kernels().leaf_candidates(la.corners, lb.corners, pair, found);
    for (std::uint8_t s = 0; s < simd::width; ++s) {
      for (std::uint8_t t = 0; t < simd::width; ++t) {
        const double true_distance = closest_points(c.world_a[la.triangle[s]], c.world_b[lb.triangle[t]]).distance;
        const simd::Candidate *const begin = found, *const end = found + count;
        const auto* const it =
            std::find_if(begin, end, [&](const simd::Candidate& f) { return f.lane_a == s && f.lane_b == t; });
        if (it == end) {
          ASSERT_GE(true_distance, cut * (1 - 1e-15)) << "case " << i;
          ++left_out;
        } else {
          const double least = std::sqrt(static_cast<double>(it->bound_sq)) - static_cast<double>(pair.error);
          ASSERT_LE(least, true_distance * scale * (1 + 1e-6)) << "case " << i;
        }
      }
    }
  }
  EXPECT_GT(left_out, 50000);
}

TEST(Kernels, AreTheSameToTheBitOnEveryInstructionSet) {
  Rng rng(203);
  const auto sets = simd::all_kernels();
  for (int i = 0; i < 2000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const Block& lanes = c.b.tree().blocks[1];
    const tree::NodeId node = Case::leaf_node(static_cast<std::uint32_t>(rng.below(c.a.tree().blocks[1].count)));
    const Vec3 way = uniform_point(rng);
    const Heading heading = placed.heading(way * (1 / length(way)));
    const double cut = rng.uniform(0, 4);
    const simd::Facing facing = placed.facing(Side::b, lanes, node);
    const simd::Toward toward = placed.toward(Side::b, lanes, node, placed.reach(Side::a, node, heading), heading, cut);
    const auto limit_sq = static_cast<float>(cut * cut);
    double scale = 1;
    const simd::LeafPair pair = placed.leaf_pair(node, Case::leaf_node(0), heading, cut, scale);
    const tree::Leaf &la = c.a.tree().leaves[tree::lane_of(node)], &lb = c.b.tree().leaves[0];

    float order0[simd::width], order[simd::width];
    simd::Candidate found0[simd::width * simd::width], found[simd::width * simd::width];
    const simd::Kernels& first = simd::scalar_kernels;
    const unsigned kept0 = first.bound_lanes(lanes.bounds, lanes.count, facing, &toward, limit_sq, order0);
    const std::uint32_t count0 = first.leaf_candidates(la.corners, lb.corners, pair, found0);
    for (const simd::Kernels& set : sets) {
      ASSERT_EQ(set.bound_lanes(lanes.bounds, lanes.count, facing, &toward, limit_sq, order), kept0) << set.name;
      ASSERT_EQ(std::memcmp(order, order0, lanes.count * sizeof(float)), 0) << set.name;
      ASSERT_EQ(set.leaf_candidates(la.corners, lb.corners, pair, found), count0) << set.name;
      for (std::uint32_t k = 0; k < count0; ++k) {
        ASSERT_EQ(std::memcmp(&found[k].bound_sq, &found0[k].bound_sq, sizeof(float)), 0) << set.name;
        ASSERT_EQ(found[k].lane_a, found0[k].lane_a) << set.name;
        ASSERT_EQ(found[k].lane_b, found0[k].lane_b) << set.name;
      }
      const float support = set.leaf_support(la.corners, heading.out_of(Side::a));
      ASSERT_EQ(support, first.leaf_support(la.corners, heading.out_of(Side::a))) << set.name;
    }
  }
}

}  // namespace
}  // namespace limber::testing

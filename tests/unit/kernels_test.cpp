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
};

TEST(Kernels, ScalarIsAmongThemAndLast) {
  const auto sets = simd::all_kernels();
  ASSERT_GE(sets.size(), 2U);
  EXPECT_STREQ(sets.back().name, "scalar");
  EXPECT_STREQ(simd::kernels().name, sets.front().name);
}

/// Lane `lane` of the leaves' block, as a node or as a leaf.
simd::Seen seen(const Model& model, std::uint32_t lane, bool as_leaf) {
  return {&model.tree().blocks[1], lane, as_leaf ? &model.tree().leaves[lane].corners : nullptr};
}

TEST(Kernels, BoundsNeverExceedDistances) {
  Rng rng(200);
  int told_apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const Block& lanes = c.a.tree().blocks[1];
    const auto facing = static_cast<std::uint32_t>(rng.below(c.b.tree().blocks[1].count));
    alignas(32) float order[simd::width], bound_sq[simd::width];
    const unsigned kept =
        simd::kernels().bound_lanes(lanes, seen(c.b, facing, false), placed.view(Side::a), all, order, bound_sq).all;
    ASSERT_EQ(kept, (1U << lanes.count) - 1);
    for (std::uint32_t lane = 0; lane < lanes.count; ++lane) {
      const double true_distance = closest(c.a.tree().leaves[lane], c.world_a, c.b.tree().leaves[facing], c.world_b);
      const double bound = order[lane] > 0 ? std::sqrt(static_cast<double>(order[lane])) * c.a.tree().unit : 0;
      ASSERT_LE(bound, true_distance) << "case " << i;
      ASSERT_EQ(bound_sq[lane], std::max(order[lane], 0.0F));
      told_apart += bound > 0.5 * true_distance ? 1 : 0;
    }
  }
  EXPECT_GT(told_apart, 3000);
}

TEST(Kernels, DirectionsNeverRuleOutWhatMatters) {
  Rng rng(201);
  int ruled_out = 0, sharper = 0;
  for (int i = 0; i < 3000; ++i) {
    const Case c(rng);
    PlacedPair placed({c.a, c.pose_a}, {c.b, c.pose_b});
    const Block& lanes = c.a.tree().blocks[1];
    const auto facing = static_cast<std::uint32_t>(rng.below(c.b.tree().blocks[1].count));
    // From the middle of one to that of the other, more or less.
    const Vec3 way = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
    placed.aim(way * (1 / length(way)));
    const simd::Seen other = seen(c.b, facing, rng.below(2) == 0);
    alignas(32) float order[simd::width] = {}, bound_sq[simd::width] = {};
    const auto kept = [&](double cut) {
      placed.set_cut(cut);
      return simd::kernels().bound_lanes(lanes, other, placed.view(Side::a), all, order, bound_sq).all;
    };
    for (std::uint32_t lane = 0; lane < lanes.count; ++lane) {
      const double true_distance = closest(c.a.tree().leaves[lane], c.world_a, c.b.tree().leaves[facing], c.world_b);
      const double cut = true_distance * rng.uniform(1, 1.01) + 1e-12;  // so that the lane matters
      for (const double any_cut : {cut, 0.8 * true_distance + 1e-12, 0.1 * true_distance + 1e-12}) {
        const bool is_kept = (kept(any_cut) >> lane & 1) != 0;
        ASSERT_TRUE(is_kept || any_cut != cut) << "case " << i;
        ruled_out += is_kept ? 0 : 1;
        const double bound = std::sqrt(static_cast<double>(bound_sq[lane])) * c.a.tree().unit;
        ASSERT_LE(bound, true_distance) << "case " << i;
        ASSERT_GE(bound_sq[lane], std::max(order[lane], 0.0F));
        sharper += bound_sq[lane] > std::max(order[lane], 0.0F) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(ruled_out, 10000);
  EXPECT_GT(sharper, 3000);
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
    if (rng.below(2) == 0) {
      const Vec3 way = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
      placed.aim(way * (1 / length(way)));
    }
    const double cut = closest(la, c.world_a, lb, c.world_b) * rng.uniform(1, 1.2) + 1e-12;
    placed.set_cut(cut);
    simd::Candidates found;
    simd::kernels().leaf_candidates(seen(c.a, ka, true), seen(c.b, kb, true), placed.view(Side::a), found);
    for (std::uint8_t s = 0; s < simd::width; ++s) {
      for (std::uint8_t t = 0; t < simd::width; ++t) {
        const double true_distance = closest_points(c.world_a[la.triangle[s]], c.world_b[lb.triangle[t]]).distance;
        const simd::Candidate *const begin = found.pairs, *const end = found.pairs + found.count;
        const auto* const it =
            std::find_if(begin, end, [&](const simd::Candidate& f) { return f.lane_a == s && f.lane_b == t; });
        if (it == end) {
          ASSERT_GE(true_distance, cut * (1 - 1e-15)) << "case " << i;
          ++left_out;
        } else {
          const double least = std::sqrt(static_cast<double>(it->bound_sq)) - static_cast<double>(found.error);
          ASSERT_LE(least, true_distance * found.scale * (1 + 1e-6)) << "case " << i;
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
    const auto facing = static_cast<std::uint32_t>(rng.below(c.a.tree().blocks[1].count));
    const double cut = rng.uniform(0, 4);
    placed.set_cut(cut);
    if (rng.below(4) != 0) {
      const Vec3 way = uniform_point(rng);
      placed.aim(way * (1 / length(way)));
    }
    const auto limit_sq = static_cast<float>(cut * cut);
    const simd::Seen node = seen(c.a, facing, rng.below(2) == 0);
    const simd::Seen leaf_a = seen(c.a, facing, true), leaf_b = seen(c.b, 0, true);

    alignas(32) float order0[simd::width], order[simd::width], bound_sq0[simd::width], bound_sq[simd::width];
    simd::Candidates found0, found;
    const simd::Kernels& first = simd::scalar_kernels;
    const simd::KeptLanes kept0 = first.bound_lanes(lanes, node, placed.view(Side::b), limit_sq, order0, bound_sq0);
    first.leaf_candidates(leaf_a, leaf_b, placed.view(Side::a), found0);
    for (const simd::Kernels& set : sets) {
      const simd::KeptLanes kept = set.bound_lanes(lanes, node, placed.view(Side::b), limit_sq, order, bound_sq);
      ASSERT_EQ(kept.all, kept0.all) << set.name;
      ASSERT_EQ(kept.meeting, kept0.meeting) << set.name;
      ASSERT_EQ(std::memcmp(order, order0, lanes.count * sizeof(float)), 0) << set.name;
      ASSERT_EQ(std::memcmp(bound_sq, bound_sq0, lanes.count * sizeof(float)), 0) << set.name;
      set.leaf_candidates(leaf_a, leaf_b, placed.view(Side::a), found);
      ASSERT_EQ(found.count, found0.count) << set.name;
      ASSERT_EQ(std::memcmp(&found.error, &found0.error, sizeof(float)), 0) << set.name;
      ASSERT_EQ(std::memcmp(&found.scale, &found0.scale, sizeof(double)), 0) << set.name;
      for (std::uint32_t k = 0; k < found0.count; ++k) {
        ASSERT_EQ(std::memcmp(&found.pairs[k].bound_sq, &found0.pairs[k].bound_sq, sizeof(float)), 0) << set.name;
        ASSERT_EQ(found.pairs[k].lane_a, found0.pairs[k].lane_a) << set.name;
        ASSERT_EQ(found.pairs[k].lane_b, found0.pairs[k].lane_b) << set.name;
      }
    }
  }
}

TEST(Kernels, FitAlikeToTheBitOnEveryInstructionSet) {
  Rng rng(204);
  for (int i = 0; i < 500; ++i) {
    const Mesh mesh = some_soup(rng, 1 + rng.below(64));
    const tree::Tree tree = tree::build(mesh);
    // The lanes beyond the last leaf hold copies of it.
    const auto fitted = [&](const simd::Kernels& set, tree::Tree& copy, simd::WholeBound& whole) {
      copy = tree;
      Block& block = copy.blocks.back();
      std::memset(&block.bounds, 0, sizeof(block.bounds));
      whole = set.fit_leaves(mesh.positions().data(), copy.unit, block, copy.leaves);
    };
    tree::Tree first, other;
    simd::WholeBound first_whole, other_whole;
    fitted(simd::scalar_kernels, first, first_whole);
    for (const simd::Kernels& set : simd::all_kernels()) {
      fitted(set, other, other_whole);
      const Block &a = first.blocks.back(), &b = other.blocks.back();
      ASSERT_EQ(std::memcmp(&a.bounds, &b.bounds, sizeof(a.bounds)), 0) << set.name << " " << i;
      ASSERT_EQ(a.origin, b.origin) << set.name;
      ASSERT_EQ(a.reach, b.reach) << set.name;
      ASSERT_EQ(std::memcmp(&first_whole, &other_whole, sizeof(first_whole)), 0) << set.name << " " << i;
      ASSERT_EQ(std::memcmp(first.leaves.data(), other.leaves.data(), first.leaves.size() * sizeof(tree::Leaf)), 0);
      const simd::WholeBound around = simd::scalar_kernels.enclose(a), other_around = set.enclose(b);
      ASSERT_EQ(std::memcmp(&around, &other_around, sizeof(around)), 0) << set.name << " " << i;
    }
  }
}

TEST(Kernels, MeasureMotionAlikeOnEveryInstructionSet) {
  Rng rng(205);
  const double most = 1000;
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<Vec3> from(count), to(count);
    double furthest_sq = 0;
    for (std::size_t i = 0; i < count; ++i) {
      from[i] = 900 * uniform_point(rng), to[i] = from[i] + uniform_point(rng);
      furthest_sq = std::max(furthest_sq, length_sq(to[i] - from[i]));
    }
    const auto expect = [&](double wanted_sq, bool is_bounded) {
      for (const simd::Kernels& set : simd::all_kernels()) {
        const simd::Motion found = set.measure_motion(from.data(), to.data(), count, most);
        EXPECT_EQ(found.furthest_sq, wanted_sq) << set.name << " " << count;
        EXPECT_EQ(found.is_bounded, is_bounded) << set.name << " " << count;
      }
    };
    expect(furthest_sq, true);
    // Every number counts, wherever it is.
    for (std::size_t i = 0; i < 3 * count; ++i) {
      double& number = (&to[i / 3].x)[i % 3];
      const double before = number;
      for (const double bad :
           {std::nan(""), -std::numeric_limits<double>::infinity(), std::nextafter(most, 2 * most)}) {
        number = bad;
        expect(0, false);
      }
      number = -most;
      expect(std::max(furthest_sq, length_sq(to[i / 3] - from[i / 3])), true);
      number = before;
    }
  }
}

}  // namespace
}  // namespace limber::testing

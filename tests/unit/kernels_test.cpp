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
#include "pair/placed_pair.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/kernel_cases.h"

namespace limber::testing {
namespace {

using bvh::Node;
using pair::Frames;
using pair::PlacedPair;
using pair::Pruning;
using pair::Side;

TEST(Kernels, ScalarIsAmongThemAndLast) {
  const auto sets = simd::all_kernels();
  ASSERT_GE(sets.size(), 2U);
  EXPECT_STREQ(sets.back().name, "scalar");
  EXPECT_STREQ(simd::kernels().name, sets.front().name);
}

TEST(Kernels, DirectionsNeverPruneWhatMatters) {
  Rng rng(201);
  int pruned_count = 0, sharper = 0;
  for (int i = 0; i < 3000; ++i) {
    KernelCase c(rng);
    const Node& node = tree_of(c.a).nodes[1];
    const auto slot_b = static_cast<std::uint32_t>(rng.below(tree_of(c.b).nodes[1].child_count));
    // Roughly from one model to the other.
    const Vec3 direction = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
    const simd::SlotRef other = at_slot(c.b, slot_b, rng.below(2) == 0);
    const auto children = [&](double cutoff) {
      const Pruning pruning = pruning_along(c.placed, cutoff, direction);
      return BoundedChildren(simd::kernels(), node, other, c.frames.of(Side::a), pruning.of(Side::a), no_limit_sq);
    };
    for (std::uint32_t slot = 0; slot < node.child_count; ++slot) {
      const double true_distance =
          closest(tree_of(c.a).leaves[slot], c.world_a, tree_of(c.b).leaves[slot_b], c.world_b).distance;
      const double cutoff = true_distance * rng.uniform(1, 1.01) + 1e-12;  // so that the child is kept
      for (const double any_distance : {cutoff, 0.8 * true_distance + 1e-12, 0.1 * true_distance + 1e-12}) {
        const BoundedChildren found = children(any_distance);
        ASSERT_TRUE(found.keeps(slot) || any_distance != cutoff) << "case " << i;
        pruned_count += found.keeps(slot) ? 0 : 1;
        ASSERT_LE(found.bound(slot, c.a), true_distance) << "case " << i;
        const float by_boxes = std::max(found.order[slot], 0.0F);
        ASSERT_GE(found.bound_sq[slot], by_boxes);
        sharper += found.bound_sq[slot] > by_boxes ? 1 : 0;
      }
    }
  }
  EXPECT_GT(pruned_count, 10000);
  EXPECT_GT(sharper, 3000);
}

TEST(Kernels, CandidatesContainEveryPairThatMatters) {
  Rng rng(202);
  int not_candidates = 0, beyond = 0, candidates = 0, tight = 0;
  for (int i = 0; i < 3000; ++i) {
    KernelCase c(rng);
    const auto ka = static_cast<std::uint32_t>(rng.below(tree_of(c.a).nodes[1].child_count));
    const auto kb = static_cast<std::uint32_t>(rng.below(tree_of(c.b).nodes[1].child_count));
    const bvh::Leaf &la = tree_of(c.a).leaves[ka], &lb = tree_of(c.b).leaves[kb];
    const ClosestPoints best = closest(la, c.world_a, lb, c.world_b);
    Vec3 direction = c.world_b[0].v0 - c.world_a[0].v0 + 0.1 * uniform_point(rng);
    double cutoff = best.distance * rng.uniform(1, 1.2) + 1e-12;
    if (rng.below(3) == 0) direction = {};
    if (rng.below(3) == 0) {  // the closest pair matters by less than quantization moves corners
      direction = best.point_b - best.point_a;
      cutoff = best.distance * (1 + 1e-9) + 1e-12;
    }
    const Pruning pruning = pruning_along(c.placed, cutoff, direction);
    simd::Candidates found;
    simd::kernels().find_candidates(at_slot(c.a, ka, true), at_slot(c.b, kb, true), c.frames.of(Side::a),
                                    pruning.of(Side::a), nullptr, true, found);
    const double apart = static_cast<double>(found.pruned_bound) / found.scale;
    simd::Candidates refined = found;
    simd::kernels().refine_candidates(refined);
    ASSERT_EQ(refined.count, found.count);
    for (std::uint8_t s = 0; s < bvh::width; ++s) {
      for (std::uint8_t t = 0; t < bvh::width; ++t) {
        const double true_distance = closest_points(c.world_a[la.triangle[s]], c.world_b[lb.triangle[t]]).distance;
        const simd::Candidate *const begin = found.pairs, *const end = found.pairs + found.count;
        const auto* const it =
            std::find_if(begin, end, [&](const simd::Candidate& f) { return f.slot_a == s && f.slot_b == t; });
        if (it == end) {
          ASSERT_GE(true_distance, cutoff * (1 - 1e-15)) << "case " << i;
          ASSERT_GE(true_distance, apart) << "case " << i;
          ++not_candidates;
          beyond += apart > cutoff ? 1 : 0;
        } else {
          const double least = std::sqrt(static_cast<double>(it->bound_sq)) - static_cast<double>(found.error);
          const simd::Candidate& better = refined.pairs[it - begin];
          ASSERT_TRUE(better.slot_a == s && better.slot_b == t && better.bound_sq >= it->bound_sq) << "case " << i;
          const double more = std::sqrt(static_cast<double>(better.bound_sq)) - static_cast<double>(found.error);
          ASSERT_LE(std::max(least, more), true_distance * found.scale * (1 + 1e-6)) << "case " << i;
          ++candidates;
          tight += more >= true_distance * found.scale * (1 - 1e-3) - 3 * static_cast<double>(found.error) ? 1 : 0;
        }
      }
    }
  }
  EXPECT_GT(not_candidates, 50000);
  EXPECT_GT(beyond, 10000);
  EXPECT_GT(candidates, 10000);
  EXPECT_GT(tight, 0.999 * candidates);
}

TEST(Kernels, CandidatesLeaveOutWhatFillsUpALeaf) {
  Rng rng(207);
  for (int i = 0; i < 64; ++i) {
    KernelCase c(rng);
    simd::SlotRef a = at_slot(c.a, 0, true), b = at_slot(c.b, 0, true);
    a.triangle_count = 1 + static_cast<std::uint32_t>(i) % 8, b.triangle_count = 1 + static_cast<std::uint32_t>(i) / 8;
    const Pruning pruning = pruning_along(c.placed, std::numeric_limits<double>::infinity(), {});
    for (const simd::Kernels& kernels : simd::all_kernels()) {
      simd::Candidates found;
      kernels.find_candidates(a, b, c.frames.of(Side::a), pruning.of(Side::a), nullptr, false, found);
      std::vector<bool> is_found(bvh::width * bvh::width);
      for (std::uint32_t k = 0; k < found.count; ++k) {
        ASSERT_LT(found.pairs[k].slot_a, a.triangle_count);
        ASSERT_LT(found.pairs[k].slot_b, b.triangle_count);
        is_found[found.pairs[k].slot_a * bvh::width + found.pairs[k].slot_b] = true;
      }
      EXPECT_EQ(std::count(is_found.begin(), is_found.end(), true), a.triangle_count * b.triangle_count);
      EXPECT_EQ(found.count, a.triangle_count * b.triangle_count) << kernels.name;
    }
  }
}

// A leaf of triangles as large as the scene, and a small part of another model among them.
TEST(Kernels, BoundsOfALeafAreThoseOfItsTriangles) {
  Rng rng(208);
  int far_cases = 0, tight = 0, told_apart_by_triangles_only = 0;
  for (int i = 0; i < 20'000; ++i) {
    const double size = std::exp2(rng.uniform(-8, 0));
    std::vector<Vec3> corners;
    for (int k = 0; k < 24; ++k) corners.push_back(uniform_point(rng));
    if (rng.below(8) == 0) corners[1] = corners[2] = corners[0];  // a triangle that is a point
    if (rng.below(2) == 0) {                                      // slivers: their closest points are hard to find
      const double width = std::exp2(rng.uniform(-30, -10));
      for (int k = 0; k < 24; k += 3) corners[k + 2] = corners[k] + width * uniform_point(rng);
    }
    std::vector<Corners> triangles;
    for (VertexId k = 0; k < 24; k += 3) triangles.push_back({k, k + 1, k + 2});
    const Model a(Mesh::create(std::move(corners), triangles).value());
    std::vector<Vec3> small;
    for (int k = 0; k < 24; ++k) small.push_back(size * uniform_point(rng));
    // Triangles across a corner of their box, whose center their slab does not contain.
    if (rng.below(3) == 0) {
      for (int k = 0; k < 24; ++k)
        small[k] = size * Vec3{k % 3 == 0 ? 1.0 : 0, k % 3 == 1 ? 1.0 : 0, k % 3 == 2 ? 1.0 : 0};
    }
    const Model b(Mesh::create(std::move(small), triangles).value());
    const Transform pose_a{random_rotation(rng), 2 * uniform_point(rng)};
    Transform pose_b{random_rotation(rng), pose_a.translation + uniform_point(rng)};
    // At half of the poses the center of b's volume is next to the end of a triangle of a.
    if (rng.below(2) == 0) {
      const Triangle t = a.mesh().triangle(0);
      const Vec3 on_a = t.v0 + rng.uniform(0, size) * (t.v1 - t.v0);
      const Box box = b.bounding_box();
      pose_b.translation =
          pose_a(on_a) - pose_b.rotation * (0.5 * (box.low + box.high)) + 0.3 * size * uniform_point(rng);
    }
    const PlacedPair placed({a, pose_a}, {b, pose_b});
    Frames frames(placed);
    const simd::SlotRef leaf = at_slot(a, 0, true), other = at_slot(b, 0, rng.below(2) == 0);
    const double unit = tree_of(a).unit;
    const double bound = std::sqrt(static_cast<double>(simd::kernels().bound_leaf(leaf, other, frames.of(Side::a))));
    // Of all pairs: distance() would be wrong where the bound is.
    const double true_distance = closest(tree_of(a).leaves[0], placed_triangles(a.mesh(), pose_a), tree_of(b).leaves[0],
                                         placed_triangles(b.mesh(), pose_b))
                                     .distance;
    ASSERT_LE(bound * unit, true_distance) << "case " << i;
    if (true_distance < 4 * size) continue;
    ++far_cases;
    tight += bound * unit >= true_distance - 2 * size ? 1 : 0;
    const Pruning pruning = pruning_along(placed, 1, {});
    const BoundedChildren found(simd::kernels(), *other.node, leaf, frames.of(Side::b), pruning.of(Side::b),
                                no_limit_sq, false);
    told_apart_by_triangles_only += found.order[0] <= 0 && bound > 0 ? 1 : 0;
  }
  EXPECT_GT(far_cases, 1000);
  EXPECT_GT(tight, 0.99 * far_cases);
  EXPECT_GT(told_apart_by_triangles_only, 0.5 * far_cases);
}

template <typename T>
bool is_same_to_the_bit(const T& s, const T& t) {
  return std::memcmp(&s, &t, sizeof(T)) == 0;
}

TEST(Kernels, AreTheSameToTheBitOnEveryInstructionSet) {
  Rng rng(203);
  const auto sets = simd::all_kernels();
  for (int i = 0; i < 2000; ++i) {
    KernelCase c(rng);
    const Node& node = tree_of(c.b).nodes[1];
    const auto slot = static_cast<std::uint32_t>(rng.below(tree_of(c.a).nodes[1].child_count));
    const double cutoff = rng.uniform(0, 4);
    const Pruning pruning = pruning_along(c.placed, cutoff, rng.below(4) != 0 ? uniform_point(rng) : Vec3{});
    const auto limit_sq = static_cast<float>(cutoff * cutoff);
    const simd::SlotRef other = at_slot(c.a, slot, rng.below(2) == 0);
    const simd::SlotRef leaf_a = at_slot(c.a, slot, true), leaf_b = at_slot(c.b, 0, true);
    const simd::FrameTransform &in_a = c.frames.of(Side::a), &in_b = c.frames.of(Side::b);
    const simd::PruneLimits &of_a = pruning.of(Side::a), &of_b = pruning.of(Side::b);

    simd::Candidates found0, found;
    const simd::Kernels& first = simd::scalar_kernels;
    first.find_candidates(leaf_a, leaf_b, in_a, of_a, nullptr, true, found0);
    const Pruning any_contact = pruning_along(c.placed, 0, rng.below(2) == 0 ? uniform_point(rng) : Vec3{});
    const auto kept_by = [&](const simd::Kernels& set) {
      return BoundedChildren(set, node, other, in_b, of_b, limit_sq);
    };
    const auto met_by = [&](const simd::Kernels& set) {
      return BoundedChildren(set, node, other, in_b, any_contact.of(Side::b), contact_sq, false);
    };
    const BoundedChildren kept0 = kept_by(first), met0 = met_by(first);
    for (const simd::Kernels& set : sets) {
      const auto expect_same = [&](const BoundedChildren& s, const BoundedChildren& t) {
        EXPECT_EQ(s.kept.all, t.kept.all) << set.name;
        EXPECT_EQ(s.kept.overlapping, t.kept.overlapping) << set.name;
        EXPECT_EQ(s.kept.larger, t.kept.larger) << set.name;
        EXPECT_EQ(std::memcmp(s.order, t.order, node.child_count * sizeof(float)), 0) << set.name;
        EXPECT_EQ(std::memcmp(s.bound_sq, t.bound_sq, node.child_count * sizeof(float)), 0) << set.name;
      };
      expect_same(kept_by(set), kept0);
      expect_same(met_by(set), met0);
      set.find_candidates(leaf_a, leaf_b, in_a, of_a, nullptr, true, found);
      ASSERT_EQ(found.count, found0.count) << set.name;
      ASSERT_TRUE(is_same_to_the_bit(found.error, found0.error)) << set.name;
      ASSERT_TRUE(is_same_to_the_bit(found.pruned_bound, found0.pruned_bound)) << set.name;
      ASSERT_TRUE(is_same_to_the_bit(found.scale, found0.scale)) << set.name;
      for (std::uint32_t k = 0; k < found0.count; ++k) {
        ASSERT_TRUE(is_same_to_the_bit(found.pairs[k].bound_sq, found0.pairs[k].bound_sq)) << set.name;
        ASSERT_EQ(found.pairs[k].slot_a, found0.pairs[k].slot_a) << set.name;
        ASSERT_EQ(found.pairs[k].slot_b, found0.pairs[k].slot_b) << set.name;
      }
      simd::Candidates refined0 = found0;
      first.refine_candidates(refined0);
      set.refine_candidates(found);
      for (std::uint32_t k = 0; k < found0.count; ++k) {
        ASSERT_TRUE(is_same_to_the_bit(found.pairs[k].bound_sq, refined0.pairs[k].bound_sq)) << set.name;
      }
      ASSERT_TRUE(is_same_to_the_bit(set.bound_leaf(leaf_a, at_slot(c.b, 0, false), in_a),
                                     first.bound_leaf(leaf_a, at_slot(c.b, 0, false), in_a)))
          << set.name;
    }
  }
}

TEST(Kernels, FitAlikeToTheBitOnEveryInstructionSet) {
  Rng rng(204);
  int elongated_count = 0;
  std::uint32_t elongated_nodes = 0;
  for (int i = 0; i < 500; ++i) {
    const Mesh mesh = some_soup(rng, 1 + rng.below(64));
    const bvh::Tree tree = bvh::build(mesh);
    // The slots beyond the last leaf hold copies of it.
    const bool sides = i % 4 != 0;
    const auto fitted = [&](const simd::Kernels& set, bvh::Tree& copy, bvh::MergedBounds& whole) {
      copy = tree;
      Node& node = copy.nodes.back();
      std::memset(&node.bounds, 0, sizeof(node.bounds)), std::memset(&node.sides, 0, sizeof(node.sides));
      whole = set.fit_leaves(mesh.positions().data(), copy.unit, node, copy.leaves, sides);
    };
    bvh::Tree first, other;
    bvh::MergedBounds first_whole, other_whole;
    fitted(simd::scalar_kernels, first, first_whole);
    for (const simd::Kernels& set : simd::all_kernels()) {
      fitted(set, other, other_whole);
      const Node &a = first.nodes.back(), &b = other.nodes.back();
      ASSERT_TRUE(is_same_to_the_bit(a.bounds, b.bounds)) << set.name << " " << i;
      ASSERT_TRUE(is_same_to_the_bit(a.sides, b.sides)) << set.name << " " << i;
      ASSERT_EQ(a.elongated_slots, b.elongated_slots) << set.name << " " << i;
      elongated_count += a.elongated_slots != 0 ? 1 : 0, elongated_nodes += first_whole.is_elongated;
      ASSERT_EQ(a.origin, b.origin) << set.name;
      ASSERT_EQ(a.radius, b.radius) << set.name;
      ASSERT_TRUE(is_same_to_the_bit(first_whole, other_whole)) << set.name << " " << i;
      ASSERT_EQ(std::memcmp(first.leaves.data(), other.leaves.data(), first.leaves.size() * sizeof(bvh::Leaf)), 0);
      const bvh::MergedBounds around = simd::scalar_kernels.merge_bounds(a, sides),
                              other_around = set.merge_bounds(b, sides);
      ASSERT_TRUE(is_same_to_the_bit(around, other_around)) << set.name << " " << i;
    }
  }
  EXPECT_GT(elongated_count, 100);
  EXPECT_GT(elongated_nodes, 10U);
}

TEST(Kernels, MeasureMotionAlikeOnEveryInstructionSet) {
  Rng rng(205);
  const double most = 1000;
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<Vec3> from(count), to(count);
    double farthest_sq = 0;
    for (std::size_t i = 0; i < count; ++i) {
      from[i] = 900 * uniform_point(rng), to[i] = from[i] + uniform_point(rng);
      farthest_sq = std::max(farthest_sq, length_sq(to[i] - from[i]));
    }
    const auto expect = [&](double wanted_sq, bool is_bounded) {
      for (const simd::Kernels& set : simd::all_kernels()) {
        const simd::Displacement found = set.max_displacement(from.data(), to.data(), count, most);
        EXPECT_EQ(found.farthest_sq, wanted_sq) << set.name << " " << count;
        EXPECT_EQ(found.is_bounded, is_bounded) << set.name << " " << count;
      }
    };
    expect(farthest_sq, true);
    // Each coordinate of each point is checked.
    for (std::size_t i = 0; i < 3 * count; ++i) {
      double& number = (&to[i / 3].x)[i % 3];
      const double before = number;
      for (const double bad :
           {std::nan(""), -std::numeric_limits<double>::infinity(), std::nextafter(most, 2 * most)}) {
        number = bad;
        expect(0, false);
      }
      number = -most;
      expect(std::max(farthest_sq, length_sq(to[i / 3] - from[i / 3])), true);
      number = before;
    }
  }
}

TEST(Kernels, ExtendBoxesAlikeOnEveryInstructionSet) {
  Rng rng(206);
  for (std::size_t count = 0; count < 40; ++count) {
    std::vector<float> points(4 * count);
    simd::PointBox wanted{{-0.5F, 0.25F, 3}, {-0.25F, 0.5F, 4}};
    const simd::PointBox before = wanted;
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i] = static_cast<float>(rng.uniform(-1, 1));
      if (i % 4 == 3) {
        points[i] = std::numeric_limits<float>::quiet_NaN();  // not used
        continue;
      }
      wanted.low[i % 4] = std::min(wanted.low[i % 4], points[i]);
      wanted.high[i % 4] = std::max(wanted.high[i % 4], points[i]);
    }
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::PointBox found = before;
      set.extend_box(points.data(), count, found);
      EXPECT_TRUE(is_same_to_the_bit(found, wanted)) << set.name << " " << count;
    }
  }
}

TEST(Kernels, FindTheLeastOfFewAlikeOnEveryInstructionSet) {
  Rng rng(207);
  for (std::size_t count = 1; count <= simd::few_points; ++count) {
    // So many coordinates that many, some or none are equal, or most of them infinite.
    for (const double distinct : {2., 10., 1e6, std::numeric_limits<double>::infinity()}) {
      std::vector<float> points(4 * count);
      for (float& x : points) {
        x = std::isinf(distinct) ? (rng.below(3) == 0 ? 1 : std::numeric_limits<float>::infinity())
                                 : static_cast<float>(std::floor(rng.uniform(-distinct, distinct)));
      }
      for (const std::size_t n : {std::size_t{1}, (count + 1) / 2, count}) {
        const std::size_t axis = count % 3;
        const auto at = [&](std::size_t i) { return points[4 * i + axis]; };
        std::uint64_t least = 0, greatest = 0;
        std::vector<float> sorted;
        for (std::size_t i = 0; i < count; ++i) sorted.push_back(at(i));
        std::sort(sorted.begin(), sorted.end());
        for (std::size_t i = 0; i < count; ++i) {
          least |= std::uint64_t{at(i) <= sorted[n - 1]} << i;
          greatest |= std::uint64_t{at(i) == sorted[n - 1]} << i;
        }
        for (const simd::Kernels& set : simd::all_kernels()) {
          const simd::FewLeast found = set.least_of_few(points.data(), axis, count, n);
          EXPECT_EQ(found.least, least) << set.name << " " << count << " " << n;
          EXPECT_EQ(found.greatest, greatest) << set.name << " " << count << " " << n;
        }
      }
    }
  }
}

}  // namespace
}  // namespace limber::testing

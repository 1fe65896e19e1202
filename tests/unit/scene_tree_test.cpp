// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// What is under a scene: bounds of placed models, their order and their tree, next to all pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "limber/model.h"
#include "scene/box_tree.h"
#include "scene/world_bounds.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

using scene::BoxTree;
using scene::WorldBounds;

WorldBounds bounds_about(const Vec3& center, const Vec3& half) {
  return {{center - half, center + half}, {center, length(half)}};
}

/// Bounds of many models, of one kind.
std::vector<WorldBounds> some_bounds(Rng& rng, std::size_t count, std::uint64_t kind) {
  std::vector<WorldBounds> all;
  for (std::size_t i = 0; i < count; ++i) {
    Vec3 at = uniform_point(rng, 0, std::cbrt(static_cast<double>(count)));
    double size = 0.5;
    switch (kind) {
      case 0:  // spread out
        break;
      case 1:  // all in one place
        at = {1, 2, 3};
        break;
      case 2:  // on a lattice, touching
        at = lattice_point(rng, 5);
        break;
      case 3:  // flat, and far away
        at.z = 0, at += Vec3{1e9, -1e9, 1e9};
        break;
      case 4:  // clusters in clusters
        at = std::pow(1e-7, static_cast<double>(rng.below(5))) * uniform_point(rng), size = 1e-3 * max_abs(at);
        break;
      case 5:  // tiny ones beside huge ones
        size = std::pow(10.0, rng.uniform(-30, 30)), at *= size;
        break;
      case 6:  // everything there is
        size = std::ldexp(1.0, static_cast<int>(rng.below(800)) - 600);
        at = std::ldexp(1.0, static_cast<int>(rng.below(800)) - 600) * uniform_point(rng);
        break;
      default:  // points on a line
        at = {at.x, 0, 0}, size = 0;
    }
    all.push_back(bounds_about(at, size * abs(uniform_point(rng))));
  }
  return all;
}
constexpr std::uint64_t kinds = 8;

std::vector<std::uint32_t> all_ids(std::size_t count) {
  std::vector<std::uint32_t> ids(count);
  std::iota(ids.begin(), ids.end(), 0U);
  return ids;
}

using IdPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs that a tree finds, in its order.
IdPairs found_by(const BoxTree& tree, double margin) {
  IdPairs pairs;
  for (std::uint32_t leaf = 0; leaf < tree.leaf_count(); ++leaf) {
    EXPECT_TRUE(tree.visit_pairs(leaf, margin, [&](std::uint32_t a, std::uint32_t b) {
      EXPECT_EQ(a / bvh::width, leaf);
      EXPECT_LT(a, b);
      pairs.emplace_back(tree.id_of(a), tree.id_of(b));
      return true;
    }));
  }
  return pairs;
}

/// How far apart the bounds of two models are, in higher precision, and what rounding may make of that.
struct TrueGap {
  std::uint32_t a, b;
  long double gap, error;
};

std::vector<TrueGap> true_gaps(const std::vector<WorldBounds>& bounds) {
  std::vector<TrueGap> gaps;
  for (std::uint32_t i = 0; i < bounds.size(); ++i) {
    for (std::uint32_t j = i + 1; j < bounds.size(); ++j) {
      const WorldBounds &a = bounds[i], &b = bounds[j];
      long double gap_sq = 0, between_sq = 0;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const long double above = static_cast<long double>(b.box.low[axis]) - a.box.high[axis];
        const long double below = static_cast<long double>(a.box.low[axis]) - b.box.high[axis];
        const long double gap = std::max({0.0L, above, below});
        const long double between = static_cast<long double>(b.sphere.center[axis]) - a.sphere.center[axis];
        gap_sq += gap * gap, between_sq += between * between;
      }
      const long double between = std::sqrt(between_sq);
      const long double radii = static_cast<long double>(a.sphere.radius) + b.sphere.radius;
      // Squares of less than 2^-900 count as nothing.
      gaps.push_back({i, j, std::max(std::sqrt(gap_sq), between - radii), 1e-12L * between + 0x1p-449L});
    }
  }
  return gaps;
}

/// With the lower id first, and sorted.
IdPairs in_order(IdPairs pairs) {
  for (auto& [a, b] : pairs) {
    if (a > b) std::swap(a, b);
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(SceneTree, FindsTheSamePairsAsAllPairsAndWhatIsNearOne) {
  Rng rng(8101);
  for (const std::size_t count : {0, 1, 2, 7, 8, 9, 17, 63, 64, 65, 150, 200, 300}) {
    for (std::uint64_t kind = 0; kind < kinds; ++kind) {
      const std::string where = std::to_string(count) + " of kind " + std::to_string(kind);
      const std::vector<WorldBounds> bounds = some_bounds(rng, count + 1, kind);  // the last one is not in the tree
      const auto own = static_cast<std::uint32_t>(count);
      BoxTree tree;
      tree.build(all_ids(count), std::span(bounds).first(count));
      const std::vector<TrueGap> gaps = true_gaps(bounds);
      for (const double margin : {0.0, 0.1, 1e3, 0x1p180}) {
        IdPairs found = in_order(found_by(tree, margin));
        EXPECT_TRUE(tree.visit_near(bounds[own], margin, [&](std::uint32_t rank) {
          EXPECT_LE(tree.lower_bound(bounds[own], rank), margin);
          return found.emplace_back(tree.id_of(rank), own), true;
        }));
        found = in_order(std::move(found));
        ASSERT_EQ(std::adjacent_find(found.begin(), found.end()), found.end()) << where;
        auto next = found.begin();
        for (const auto& [a, b, gap, error] : gaps) {
          const bool is_found = next != found.end() && *next == std::pair(a, b);
          if (is_found) ++next;
          ASSERT_TRUE(is_found || gap > margin) << where;
          ASSERT_TRUE(!is_found || gap <= margin + error + 1e-12L * margin) << where;
        }
        ASSERT_EQ(next, found.end()) << where;
      }
    }
  }
}

TEST(SceneTree, FindsSpheresThatTouchWhereSquaresVanish) {
  Rng rng(8110);
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::ldexp(1.0, -static_cast<int>(500 + rng.below(60)));
    const Vec3 center = uniform_point(rng);
    const double radius = std::nextafter(0.5 * length(center), 1.0);
    const auto ball_at = [&](const Vec3& at) {
      const Vec3 half = scale * radius * Vec3{1, 1, 1};
      return WorldBounds{{scale * at - half, scale * at + half}, {scale * at, scale * radius}};
    };
    BoxTree tree;
    tree.build(all_ids(2), std::vector<WorldBounds>{ball_at({}), ball_at(center)});
    ASSERT_TRUE(tree.may_be_within(0, 1, 0)) << "case " << i;
    ASSERT_EQ(tree.lower_bound(0, 1), 0) << "case " << i;
  }
}

TEST(SceneTree, BoundsAreBelowAllDistances) {
  Rng rng(8104);
  for (std::uint64_t kind = 0; kind < kinds; ++kind) {
    const std::vector<WorldBounds> bounds = some_bounds(rng, 60, kind);
    BoxTree tree;
    tree.build(all_ids(bounds.size()), bounds);
    for (std::uint32_t a = 0; a < tree.size(); ++a) {
      for (std::uint32_t b = a + 1; b < tree.size(); ++b) {
        const double bound = tree.lower_bound(a, b);
        ASSERT_GE(bound, 0);
        ASSERT_TRUE(std::isfinite(bound));
        // What is nearer than the bound is not near.
        if (bound > 0) {
          ASSERT_FALSE(tree.may_be_within(a, b, 0.999999 * bound)) << "kind " << kind;
        }
        ASSERT_TRUE(tree.may_be_within(a, b, scene::margin_with_error(1.000001 * bound))) << "kind " << kind;
      }
    }
  }
}

// --- order ---

TEST(HilbertOrder, IsAPermutationThatDoesNotDependOnWhatWasBefore) {
  Rng rng(8105);
  scene::HilbertOrder used;
  for (const std::size_t count : {0, 1, 8, 9, 100, 256, 257, 3000}) {
    for (std::uint64_t kind = 0; kind < kinds; ++kind) {
      std::vector<Vec3> centers;
      for (const WorldBounds& b : some_bounds(rng, count, kind)) centers.push_back(b.sphere.center);
      const auto order = used.sort(centers);
      scene::HilbertOrder fresh;
      const auto again = fresh.sort(centers);
      ASSERT_TRUE(std::equal(order.begin(), order.end(), again.begin(), again.end()));
      std::vector<std::uint32_t> sorted(order.begin(), order.end());
      std::sort(sorted.begin(), sorted.end());
      ASSERT_EQ(sorted, all_ids(count));
      if (kind == 1) {  // equal points keep their order
        ASSERT_TRUE(std::is_sorted(order.begin(), order.end()));
      }
    }
  }
}

TEST(HilbertOrder, IsNotSpoiltByOnePointFarAway) {
  // Boxes in a row, each touching the next. The number of boxes that are compared shows whether neighbors are together.
  Rng rng(8106);
  std::vector<WorldBounds> bounds;
  for (int i = 0; i < 3000; ++i) bounds.push_back(bounds_about(uniform_point(rng, 0, 16), {0.5, 0.5, 0.5}));
  static std::uint64_t calls;
  static const simd::Kernels& real = simd::kernels();
  simd::Kernels counting = real;
  counting.overlapping_pairs = [](const bvh::BoxNode& a, const bvh::BoxNode& b, const Box& around_b, double margin) {
    ++calls;
    return real.overlapping_pairs(a, b, around_b, margin);
  };
  const auto calls_of = [&] {
    BoxTree tree;
    tree.build(all_ids(bounds.size()), bounds);
    calls = 0;
    simd::use_kernels(&counting);
    (void)found_by(tree, 0);
    simd::use_kernels(nullptr);
    return calls;
  };
  const std::uint64_t usual = calls_of();
  bounds.push_back(bounds_about({1e60, -1e30, 0}, {1, 1, 1}));
  bounds.push_back(bounds_about({1e20, 0, 1e10}, {1, 1, 1}));
  EXPECT_LT(calls_of(), usual + usual / 4);
  EXPECT_LT(usual, 20'000U);
}

// --- bounds ---

TEST(WorldBounds, ContainPlacedVertices) {
  Rng rng(8107);
  for (int i = 0; i < 3000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(rng.below(600)) - 500);
    const double offset = rng.below(2) == 0 ? 0 : std::ldexp(scale, static_cast<int>(rng.below(60)));
    std::vector<Triangle> triangles;
    for (std::uint64_t k = 0; k <= rng.below(4); ++k) {
      const Vec3 at = offset * Vec3{1, -1, 0.5};
      triangles.push_back({at + scale * uniform_point(rng), at + scale * uniform_point(rng), at});
    }
    const Model model(soup(triangles));
    Transform pose = random_pose(rng, 1);
    if (rng.below(4) == 0) pose.rotation = {};
    pose.translation *= std::max(offset, scale) * std::ldexp(1.0, static_cast<int>(rng.below(40)) - 20);
    const WorldBounds bounds = scene::world_bounds(scene::local_bounds(model), pose);
    for (const Vec3& p : model.mesh().positions()) {
      const Vec3 placed = pose(p);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        ASSERT_LE(bounds.box.low[axis], placed[axis]) << "case " << i;
        ASSERT_GE(bounds.box.high[axis], placed[axis]) << "case " << i;
      }
      ASSERT_LE(length(placed - bounds.sphere.center), bounds.sphere.radius) << "case " << i;
    }
    // Not much larger than the turned box, nor than the sphere.
    const double radius = model.bounding_sphere().radius, rounding = 1e-12 * (max_abs(pose.translation) + offset);
    EXPECT_LE(bounds.sphere.radius, radius * 1.000001 + rounding + 1e-300);
    EXPECT_LE(max_abs(bounds.box.high - bounds.box.low), 2.00001 * radius + rounding + 1e-300);
  }
}

TEST(WorldBounds, OfABallAreHardlyLarger) {
  for (const auto& [slices, most] :
       {std::pair(4U, 1.00001), {16U, 1.00001}, {60U, 1.00001}, {90U, 1.15}, {220U, 1.15}}) {
    Model ball(scenes::ball(slices, slices / 2 + 1));
    EXPECT_LE(scene::local_bounds(ball).radius, most) << slices;
    // Everything moves away, within a motion margin.
    ball.set_motion_margin(0.5);
    std::vector<Vec3> positions = ball.mesh().positions();
    for (int frame = 0; frame < 3; ++frame) {
      for (Vec3& p : positions) p *= 1.1;
      ASSERT_TRUE(static_cast<bool>(ball.move_all(positions)));
      ball.commit();
      const scene::LocalBounds bounds = scene::local_bounds(ball);
      for (const Vec3& p : positions) ASSERT_LE(length(p - bounds.center), bounds.radius) << slices;
    }
  }
}

TEST(WorldBounds, DoNotHoldVerticesThatNoTriangleNames) {
  const Model model(Mesh::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1e9, 0, 0}}, {{0, 1, 2}}).value());
  EXPECT_LE(scene::local_bounds(model).radius, 1);
}

TEST(WorldBounds, StayFiniteAtTheLargestCoordinates) {
  const Vec3 far{max_coordinate, -max_coordinate, max_coordinate};
  const Model model(soup({{far, -far, {}}}));
  Rng rng(8108);
  std::vector<WorldBounds> bounds;
  for (int i = 0; i < 20; ++i) {
    const Transform pose{scenes::random_rotation(rng), i % 2 == 0 ? far : -far};
    bounds.push_back(scene::world_bounds(scene::local_bounds(model), pose));
    ASSERT_TRUE(is_finite(bounds.back().box.low) && is_finite(bounds.back().box.high));
    ASSERT_TRUE(std::isfinite(bounds.back().sphere.radius));
  }
  BoxTree tree;
  tree.build(all_ids(bounds.size()), bounds);
  const double most = scene::margin_with_error(std::numeric_limits<double>::max());
  ASSERT_TRUE(std::isfinite(most));
  EXPECT_EQ(found_by(tree, 0).size(), 190U);
  EXPECT_EQ(found_by(tree, most).size(), 190U);
}

// --- kernels ---

TEST(Kernels, FindOverlappingBoxesToTheBit) {
  Rng rng(8109);
  for (int i = 0; i < 2000; ++i) {
    bvh::BoxNode wide[2];
    Box boxes[2][bvh::width];
    std::uint32_t counts[2];
    for (int side = 0; side < 2; ++side) {
      counts[side] = static_cast<std::uint32_t>(1 + rng.below(bvh::width));
      for (std::uint32_t k = 0; k < bvh::width; ++k) {
        constexpr double infinity = std::numeric_limits<double>::infinity();
        const Vec3 p = lattice_point(rng, 6), q = lattice_point(rng, 6);
        Box box{min(p, q), max(p, q)};
        if (k >= counts[side]) box = {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
        boxes[side][k] = box;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          wide[side].low[axis][k] = box.low[axis], wide[side].high[axis][k] = box.high[axis];
        }
      }
    }
    const double margin = static_cast<double>(rng.below(3));
    Box around = boxes[1][0];
    for (std::uint32_t k = 0; k < counts[1]; ++k) {
      around = {min(around.low, boxes[1][k].low), max(around.high, boxes[1][k].high)};
    }
    const auto meet = [](const Box& a, const Box& b, double by) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (a.low[axis] - by > b.high[axis] || a.high[axis] + by < b.low[axis]) return false;
      }
      return true;
    };
    std::uint64_t pairs = 0;
    unsigned of_first = 0;
    for (std::uint32_t k = 0; k < counts[0]; ++k) {
      if (meet(boxes[1][0], boxes[0][k], 0)) of_first |= 1U << k;
      for (std::uint32_t j = 0; j < counts[1]; ++j) {
        if (meet(boxes[0][k], boxes[1][j], margin)) pairs |= std::uint64_t{1} << (8 * k + j);
      }
    }
    for (const simd::Kernels& kernels : simd::all_kernels()) {
      ASSERT_EQ(kernels.overlapping_boxes(wide[0], boxes[1][0].low, boxes[1][0].high), of_first) << kernels.name;
      ASSERT_EQ(kernels.overlapping_pairs(wide[0], wide[1], around, margin), pairs) << kernels.name;
    }
  }
}

}  // namespace
}  // namespace limber::testing

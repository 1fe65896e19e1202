// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Thousands of triangles at one place: duplicates, and meshes that have collapsed.
#include <gtest/gtest.h>

#include <span>
#include <vector>

#include "limber/distance.h"
#include "limber/model.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_geometry.h"
#include "unit/internals.h"

namespace limber::testing {
namespace {

/// A mesh of `count` equal triangles, which share their vertices or have their own.
Mesh repeated(const Triangle& t, std::uint32_t count, bool shares_vertices) {
  if (!shares_vertices) return soup(std::vector<Triangle>(count, t));
  return Mesh::create({t.v0, t.v1, t.v2}, std::vector<Corners>(count, Corners{0, 1, 2})).value();
}

TEST(Coincident, TrianglesCostNoMoreThanAFew) {
  const Triangle low{{0, 0, 0}, {1, 0.1, 0}, {0.2, 1, 0}}, high{{0, 0, 1}, {1, 0, 1.5}, {0.3, 1, 2}};
  for (const bool shares_vertices : {false, true}) {
    const Model a(repeated(low, 8000, shares_vertices)), b(repeated(high, 8000, shares_vertices));
    ASSERT_TRUE(static_cast<bool>(a.validate()));
    const DistanceResult found = distance({a}, {b});
    EXPECT_EQ(found.upper, closest_points(low, high).distance);
    EXPECT_EQ(found.status, DistanceStatus::exact);
    EXPECT_LT(found.stats.node_tests + found.stats.primitive_tests, 100U);
    EXPECT_FALSE(collide({a}, {b}).is_yes());
    EXPECT_TRUE(collide({a}, {a, {{}, {0.1, 0.1, 0}}}).is_yes());
  }
}

TEST(Coincident, TrianglesAmongOthersAreFoundAsBefore) {
  Rng rng(701);
  for (int i = 0; i < 100; ++i) {
    std::vector<Triangle> triangles;
    while (triangles.size() < 600) {
      const Triangle t = uniform_triangle(rng);
      // 64 to 200 times, or once: equal triangles fill whole nodes and parts of nodes.
      triangles.insert(triangles.end(), rng.below(2) == 0 ? 64 + rng.below(137) : 1, t);
    }
    const Mesh mesh = soup(triangles), other = soup({uniform_triangle(rng), uniform_triangle(rng)});
    const Model a(mesh), b(other);
    ASSERT_TRUE(static_cast<bool>(a.validate()));
    const Transform pose = random_pose(rng, 3);
    const double truth = reference::distance({mesh}, {other, pose}).upper;
    ASSERT_NEAR(distance({a}, {b, pose}).upper, truth, 1e-14);
    ASSERT_NEAR(distance({b, pose}, {a}).upper, truth, 1e-14);
    ASSERT_EQ(collide({a}, {b, pose}).is_yes(), truth == 0);
  }
}

TEST(Coincident, TrianglesThatPartAreToldApartAgain) {
  // One vertex of a collapsed mesh moves out. Its triangles are below slots that were marked coincident.
  for (const double motion_margin : {0.0, 0.5}) {
    const Mesh home = scenes::ball(24, 13);
    Model a(home, {.motion_margin = motion_margin});
    const Model probe(soup({{{0, 0, 5}, {1, 0, 6}, {0, 1, 6}}}));
    QueryCache cache;
    for (VertexId v = 0; v < home.positions().size(); v += 7) {
      deform(a, [](const Vec3&) { return Vec3{}; });
      ASSERT_EQ(distance({a}, {probe}, {.cache = &cache}).upper, 5);
      for (const double height : {0.25, 3.0}) {
        const std::vector<VertexId> ids{v};
        const std::vector<Vec3> place{{0, 0, height}};
        a.move_vertices(ids, place).value();
        a.commit();
        ASSERT_TRUE(static_cast<bool>(a.validate())) << "vertex " << v;
        ASSERT_EQ(distance({a}, {probe}).upper, 5 - height) << "vertex " << v;
        ASSERT_EQ(distance({a}, {probe}, {.cache = &cache}).upper, 5 - height) << "vertex " << v;
      }
    }
    a.move_all(home.positions()).value();
    a.commit();
    ASSERT_NEAR(distance({a}, {probe}, {.cache = &cache}).upper, reference::distance({home}, {probe.mesh()}).upper,
                1e-14);
  }
}

TEST(Coincident, TrianglesThatPartByLessThanASquareCanTellAreToldApart) {
  // The last of many equal triangles moves to the other model, by a displacement whose square is 0 in float64.
  constexpr double little = 0x1p-600;
  const Triangle high{{0, 0, little}, {1, 0, little}, {0, 1, little}}, low{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  constexpr std::uint32_t count = 200;
  const std::vector<VertexId> last{3 * count - 3, 3 * count - 2, 3 * count - 1};
  for (const bool moves_all : {false, true}) {
    Model many(repeated(high, count, false), {.motion_margin = 0.5});
    const Model probe(soup({low}));
    ASSERT_FALSE(collide({many}, {probe}).is_yes());
    std::vector<Vec3> positions = many.mesh().positions();
    for (std::size_t k = 0; k < 3; ++k) positions[last[k]] = low[k];
    if (moves_all) {
      many.move_all(positions).value();
    } else {
      many.move_vertices(last, std::span(positions).last(3)).value();
    }
    many.commit();
    ASSERT_TRUE(static_cast<bool>(many.validate()));
    EXPECT_TRUE(collide({many}, {probe}).is_yes()) << moves_all;
    EXPECT_EQ(distance({many}, {probe}).upper, 0) << moves_all;
  }
}

TEST(Coincident, TrianglesThatPartByLessThanBoundsCanTellAreToldApart) {
  // Some of many equal triangles move so little that no bound changes. The marks of all slots above have to change.
  constexpr double little = 0x1p-200;
  const Triangle flat{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  Model many(repeated(flat, 1000, false));
  const Model probe(soup({{{-1, -1, little}, {3, -1, little}, {-1, 3, little}}}));
  const auto is_one_again = [&] {
    const DistanceResult found = distance({many}, {probe});
    return found.upper == little && found.stats.node_tests + found.stats.primitive_tests < 100;
  };
  ASSERT_TRUE(is_one_again());
  const bvh::Tree& tree = tree_of(many);
  ASSERT_GT(tree.first_lowest_node(), 1U);
  const auto raise = [&](const bvh::Leaf& leaf, double height) {
    std::vector<VertexId> ids;
    for (const auto& corners : leaf.vertices) ids.push_back(corners[0]);
    many.move_vertices(ids, std::vector<Vec3>(ids.size(), {0, 0, height})).value();
  };
  for (std::size_t n = tree.first_lowest_node(); n < tree.nodes.size(); n += 3) {
    const std::uint32_t first = tree.nodes[n].first_child;
    for (const std::uint32_t count : {1U, tree.nodes[n].child_count}) {  // a leaf, or all leaves of a node
      for (const double height : {little, 0.0}) {
        for (std::uint32_t k = 0; k < count; ++k) raise(tree.leaves[first + k], height);
        many.commit();
        const auto sound = many.validate();
        ASSERT_TRUE(static_cast<bool>(sound)) << n << ": " << sound.error().text;
        ASSERT_EQ(collide({many}, {probe}).is_yes(), height > 0) << n;
      }
      ASSERT_TRUE(is_one_again()) << n;
    }
  }
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// A collector of all hits: the example of docs/design/adding_a_query.md.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "geometry/primitives.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/collectors/collector.h"
#include "pair/search.h"
#include "reference/reference.h"
#include "scenes/scenes.h"
#include "support/random_scene.h"

namespace limber::testing {
namespace {

/// How many pairs of triangles are at most a given distance apart.
class CountWithin {
 public:
  static constexpr pair::Hits hits = pair::Hits::all;
  static constexpr bool is_self = false;

  explicit CountWithin(double max_distance) : max_distance_(max_distance) {}

  /// Just above the limit: a pair exactly max_distance apart counts.
  double initial_cutoff() const { return std::nextafter(max_distance_, std::numeric_limits<double>::infinity()); }
  bool is_done() const { return false; }

  void compare(const pair::PlacedTriangle& a, const pair::PlacedTriangle& b) {
    if (geometry::closest_points(a.corners, b.corners).distance <= max_distance_) ++count;
  }

  std::uint64_t count = 0;

 private:
  double max_distance_;
};

std::uint64_t count_within(const Placed& a, const Placed& b, double max_distance) {
  const pair::PlacedPair placed(a, b);
  CountWithin collector(max_distance);
  QueryStats stats;
  pair::BudgetMeter meter;
  pair::search_all(placed, collector, meter, stats);
  return collector.count;
}

std::uint64_t brute_force_count(const Placed& a, const Placed& b, double max_distance) {
  return reference::contacts({a.model().mesh(), a.pose}, {b.model().mesh(), b.pose}, max_distance).size();
}

TEST(CountingCollector, IsOfferedEachPairOnceHoweverManyLeavesAreFull) {
  for (std::uint32_t columns = 1; columns <= 12; ++columns) {  // 2 to 24 triangles, and 10 times as many
    for (const std::uint32_t rows : {1U, 10U}) {
      const Model a(scenes::grid(columns, rows, 0, 0, 1, 1)), b(scenes::grid(rows, columns, 0.1, 0.2, 1, 1));
      const Placed placed_b{b, {{}, {0, 0, 1}}};
      EXPECT_EQ(count_within({a}, placed_b, 1.5), brute_force_count({a}, placed_b, 1.5)) << columns << ", " << rows;
    }
  }
}

TEST(CountingCollector, IsOfferedEachOfManyCoincidentTriangles) {
  const Triangle low{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, high{{0, 0, 2}, {1, 0, 2}, {0, 1, 2}};
  const Model many(soup(std::vector<Triangle>(500, low))), few(soup(std::vector<Triangle>(3, high)));
  EXPECT_EQ(count_within({many}, {few}, 2), 1500U);
  EXPECT_EQ(count_within({few}, {many}, 2), 1500U);
  EXPECT_EQ(count_within({many}, {few}, 1.9), 0U);
}

TEST(CountingCollector, CountsWhatBruteForceDoesInRandomScenes) {
  Rng rng(801);
  std::uint64_t counted = 0;
  for (int i = 0; i < 500; ++i) {
    const Scene s = arbitrary_scene(rng);
    const Model model_a(s.mesh_a), model_b(s.mesh_b);
    const Placed a{model_a, s.pose_a}, b{model_b, s.pose_b};
    // Pairs within rounding of the limit may count or not; contacts are exact.
    const double limit = i % 4 == 0 ? 0 : distance(a, b).upper + rng.uniform(0, 0.1) * s.size;
    const double rounding = limit == 0 ? 0 : s.tolerance;
    const std::uint64_t count = count_within(a, b, limit);
    ASSERT_GE(count, brute_force_count(a, b, std::max(limit - rounding, 0.0))) << i;
    ASSERT_LE(count, brute_force_count(a, b, limit + rounding)) << i;
    counted += count;
  }
  EXPECT_GT(counted, 1000U);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernel that compares pairs of segments, next to one pair at a time.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "geometry/primitives.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr std::uint32_t room = simd::SegmentPairs::room;

Segment segment_a(const simd::SegmentPairs& pairs, std::uint32_t i) { return {pairs.start_a[i], pairs.end_a[i]}; }
Segment segment_b(const simd::SegmentPairs& pairs, std::uint32_t i) { return {pairs.start_b[i], pairs.end_b[i]}; }

/// Edges of random triangles, all lengths times a scale.
simd::SegmentPairs random_segments(Rng& rng, PairKind kind, double scale) {
  simd::SegmentPairs pairs;
  for (std::uint32_t i = 0; i < room; ++i) {
    const auto [t, u] = random_pair(rng, kind);
    pairs.start_a[i] = scale * t[i % 3], pairs.end_a[i] = scale * t[(i + 1) % 3];
    pairs.start_b[i] = scale * u[i / 3 % 3], pairs.end_b[i] = scale * u[(i / 3 + 1) % 3];
  }
  return pairs;
}

/// Compares one set of pairs with every instruction set. Returns how many pairs were ordinary.
int compare_all(const simd::SegmentPairs& pairs) {
  int ordinary = 0;
  for (const simd::Kernels& set : simd::all_kernels()) {
    simd::ClosestOfSegments found;
    set.compare_segments(pairs, found);
    ordinary = 0;
    for (std::uint32_t i = 0; i < room; ++i) {
      const geometry::PointsOnSegments expected = geometry::closest_on(segment_a(pairs, i), segment_b(pairs, i));
      const bool is_ordinary = (found.are_ordinary >> i & 1) != 0;
      EXPECT_FALSE(is_ordinary && expected.distance == 0) << set.name << ", pair " << i;
      if (!is_ordinary) continue;
      ++ordinary;
      EXPECT_EQ(found.distance[i], expected.distance) << set.name << ", pair " << i;
      EXPECT_EQ(found.s[i], expected.s) << set.name << ", pair " << i;
      EXPECT_EQ(found.t[i], expected.t) << set.name << ", pair " << i;
    }
  }
  return ordinary;
}

class CompareSegments : public ::testing::TestWithParam<PairKind> {};

TEST_P(CompareSegments, GivesTheClosestPointsToTheBit) {
  Rng rng(1701);
  int ordinary = 0;
  for (int round = 0; round < 500; ++round) ordinary += compare_all(random_segments(rng, GetParam(), 1));
  EXPECT_GT(ordinary, 0);
}

TEST_P(CompareSegments, LeavesTheHugeTheTinyAndTheTouchingToOthers) {
  Rng rng(1702);
  for (const double scale : {0x1p-1000, 0x1p-500, 0x1p-110, 0x1p110, 0x1p500, 0x1p900}) {
    EXPECT_EQ(compare_all(random_segments(rng, GetParam(), scale)), 0) << scale;
  }
  simd::SegmentPairs touching;  // points, at the origin
  EXPECT_EQ(compare_all(touching), 0);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompareSegments,
                         ::testing::Values(PairKind::uniform, PairKind::lattice, PairKind::near_lattice,
                                           PairKind::touching, PairKind::sliver, PairKind::coplanar,
                                           PairKind::mixed_scale, PairKind::one_line),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace limber::testing

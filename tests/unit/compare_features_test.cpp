// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels that compare pairs of segments, and edges, corners and crossings of two triangles, next to one pair at a
// time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>
#include <utility>
#include <vector>

#include "geometry/primitives.h"
#include "geometry/segment_distance.h"
#include "geometry/triangle_contact.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

class CompareFeatures : public ::testing::TestWithParam<PairKind> {};

// --- segments ---

constexpr std::uint32_t segment_room = simd::SegmentPairs::room;

/// Edges of random triangles, all lengths times a scale.
simd::SegmentPairs random_segments(Rng& rng, PairKind kind, double scale) {
  simd::SegmentPairs pairs;
  for (std::uint32_t i = 0; i < segment_room; ++i) {
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
    for (std::uint32_t i = 0; i < segment_room; ++i) {
      const Segment a{pairs.start_a[i], pairs.end_a[i]}, b{pairs.start_b[i], pairs.end_b[i]};
      const geometry::PointsOnSegments expected = geometry::closest_on(a, b);
      const bool is_ordinary = (found.are_ordinary >> i & 1) != 0;
      EXPECT_FALSE(is_ordinary && expected.distance == 0) << set.name << ", pair " << i;
      if (!is_ordinary) continue;
      ++ordinary;
      EXPECT_EQ(std::tuple(found.distance[i], found.s[i], found.t[i]),
                std::tuple(expected.distance, expected.s, expected.t))
          << set.name << ", pair " << i;
    }
  }
  return ordinary;
}

TEST_P(CompareFeatures, OfSegmentsGivesTheClosestPointsToTheBit) {
  Rng rng(1701);
  int ordinary = 0;
  for (int round = 0; round < 500; ++round) ordinary += compare_all(random_segments(rng, GetParam(), 1));
  EXPECT_GT(ordinary, 0);
}

TEST_P(CompareFeatures, OfSegmentsLeavesTheHugeTheTinyAndTheTouchingToOthers) {
  if (GetParam() == PairKind::far_away) return;  // larger than a part of the scales is for
  Rng rng(1702);
  for (const double scale : {0x1p-1000, 0x1p-500, 0x1p-110, 0x1p110, 0x1p500, 0x1p900}) {
    EXPECT_EQ(compare_all(random_segments(rng, GetParam(), scale)), 0) << scale;
  }
  simd::SegmentPairs touching;  // points, at the origin
  EXPECT_EQ(compare_all(touching), 0);
}

// --- triangles ---

simd::FaceVectors face_of(const Triangle& t) {
  simd::FaceVectors face{t, {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2}, {}};
  const Vec3 normal = cross(face.edge[0], face.edge[1]);
  for (std::size_t i = 0; i < 3; ++i) face.inward[i] = cross(normal, face.edge[i]);
  return face;
}

/// One pair of edges after the other.
simd::TriangleFeatures compare_edges(const simd::FaceVectors& a, const simd::FaceVectors& b) {
  simd::TriangleFeatures best{std::numeric_limits<double>::infinity(), 0, 0, 0, 0, 0, 0};
  for (std::uint32_t i = 0; i < 3; ++i) {
    for (std::uint32_t j = 0; j < 3; ++j) {
      const Segment of_a{a.corner[i], a.corner[geometry::next_corner[i]]},
          of_b{b.corner[j], b.corner[geometry::next_corner[j]]};
      const auto [s, t] = geometry::closest_parameters(of_a, of_b);
      const double distance_sq = length_sq((of_b.p0 - of_a.p0) + (t * b.edge[j] - s * a.edge[i]));
      if (distance_sq < best.distance_sq) best = {distance_sq, s, t, i, j, 0, 0};
    }
  }
  return best;
}

/// Corners whose foot is in a face.
unsigned feet_in(const simd::FaceVectors& face, const Triangle& corners) {
  unsigned feet = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double w2 = dot(face.inward[0], corners[k] - face.corner.v0);
    const double w0 = dot(face.inward[1], corners[k] - face.corner.v1);
    const double w1 = dot(face.inward[2], corners[k] - face.corner.v2);
    feet |= w0 >= 0 && w1 >= 0 && w2 >= 0 && w0 + w1 + w2 > 0 ? 1U << k : 0;
  }
  return feet;
}

auto values_of(const simd::TriangleFeatures& f) {
  return std::tuple(f.distance_sq, f.at_a, f.at_b, f.edge_a, f.edge_b, f.feet_of_a, f.feet_of_b);
}

TEST_P(CompareFeatures, OfTrianglesFindsTheFirstOfTheClosestEdgesAndAllFeet) {
  Rng rng(1501);
  int feet = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto [t, u] = random_pair(rng, GetParam());
    const simd::FaceVectors a = face_of(t), b = face_of(u);
    simd::TriangleFeatures expected = compare_edges(a, b);
    expected.feet_of_a = feet_in(b, t), expected.feet_of_b = feet_in(a, u);
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::TriangleFeatures found;
      set.compare_triangles(a, b, found);
      ASSERT_EQ(values_of(found), values_of(expected)) << set.name << ", pair " << i;
    }
    feet += expected.distance_sq > 0 && expected.feet_of_b != 0 ? 1 : 0;
  }
  EXPECT_GT(feet, 0);
}

// --- contacts of triangles ---

auto values_of(const TriangleContact& c) {
  return std::tuple(c.distance, c.depth, c.point_a, c.point_b, c.normal, c.weights_a, c.weights_b, c.feature_a,
                    c.feature_b, c.normal_side);
}

/// A few pairs, each with random outsides.
struct OrientedPairs {
  std::vector<std::pair<Triangle, Triangle>> triangles;
  std::vector<OrientedFaces> oriented;

  OrientedPairs(Rng& rng, PairKind kind) {
    for (std::size_t i = 0; i < geometry::ContactBatch::room; ++i) {
      triangles.push_back(random_pair(rng, kind));
      constexpr OrientedFaces ways[] = {OrientedFaces::none, OrientedFaces::of_a, OrientedFaces::of_b,
                                        OrientedFaces::both};
      oriented.push_back(ways[rng.below(4)]);
    }
  }
  /// The contacts of the first `count`, found together.
  std::vector<TriangleContact> contacts(std::size_t count, double farthest) const {
    geometry::ContactBatch batch;
    for (std::size_t i = 0; i < count; ++i) batch.add(triangles[i].first, triangles[i].second, oriented[i]);
    batch.find_crossings();
    std::vector<TriangleContact> found;
    for (std::uint32_t i = 0; i < batch.size(); ++i) found.push_back(batch.contact(i, farthest));
    return found;
  }
};

TEST_P(CompareFeatures, ContactsDoNotDependOnInstructionSetsNorOnTheOtherPairs) {
  Rng rng(1503);
  for (int round = 0; round < 500; ++round) {
    const OrientedPairs pairs(rng, GetParam());
    const double farthest = round % 2 == 0 ? 1 : 0;
    std::vector<TriangleContact> expected;
    simd::use_kernels(&simd::scalar_kernels);
    for (std::size_t i = 0; i < pairs.triangles.size(); ++i) {
      const auto& [t, u] = pairs.triangles[i];
      expected.push_back(geometry::contact(t, u, pairs.oriented[i], farthest));
    }
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::use_kernels(&set);
      const std::size_t count = 1 + static_cast<std::size_t>(round) % expected.size();
      const std::vector<TriangleContact> found = pairs.contacts(count, farthest);
      ASSERT_EQ(found.size(), count);
      for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(values_of(found[i]), values_of(expected[i])) << set.name << ", pair " << i << " of round " << round;
      }
    }
    simd::use_kernels(nullptr);
  }
}

/// Pairs that the kernel calls certain intersect, and most pairs that intersect are certain.
TEST_P(CompareFeatures, CrossingsAreThoseOfTrianglesThatIntersect) {
  Rng rng(1504);
  int answered = 0, intersecting = 0;
  for (int round = 0; round < 1000; ++round) {
    simd::TrianglePairs pairs;
    bool intersect[simd::TrianglePairs::room];
    for (std::uint32_t i = 0; i < simd::TrianglePairs::room; ++i) {
      const auto [t, u] = random_pair(rng, GetParam());
      for (std::size_t k = 0; k < 3; ++k) pairs.a[k][i] = t[k], pairs.b[k][i] = u[k];
      intersect[i] = geometry::intersects(t, u);
      intersecting += intersect[i] ? 1 : 0;
    }
    simd::Crossings found;
    simd::kernels().find_crossings(pairs, found);
    for (std::uint32_t i = 0; i < simd::TrianglePairs::room; ++i) {
      if ((found.are_certain >> i & 1) == 0) continue;
      ++answered;
      ASSERT_TRUE(intersect[i]) << round;
    }
  }
  if (GetParam() == PairKind::uniform) {
    EXPECT_GT(answered, intersecting * 9 / 10);
  }
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompareFeatures,
                         ::testing::Values(PairKind::uniform, PairKind::lattice, PairKind::near_lattice,
                                           PairKind::touching, PairKind::sliver, PairKind::coplanar,
                                           PairKind::shared_edge, PairKind::mixed_scale, PairKind::far_away,
                                           PairKind::one_line, PairKind::needle),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace limber::testing

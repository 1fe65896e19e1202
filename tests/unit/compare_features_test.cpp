// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels that compare pairs of segments, and edges, corners and axes of two triangles, next to one pair at a time.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <tuple>

#include "geometry/primitives.h"
#include "geometry/segment_distance.h"
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

// --- axes of two triangles ---

/// Edges as given, and a normal of any two of them.
simd::TriangleAxes axes_of(const Triangle& t) {
  simd::TriangleAxes axes{t, {t.v1 - t.v0, t.v2 - t.v1, t.v0 - t.v2}, {}};
  const double size = std::max({max_abs(axes.edge[0]), max_abs(axes.edge[1]), max_abs(axes.edge[2]), 0x1p-500});
  for (Vec3& edge : axes.edge) edge = edge * (1 / size);
  axes.normal = cross(axes.edge[0], axes.edge[1]);
  return axes;
}

/// One axis after the other.
simd::LeastOverlap least_overlap(const simd::TriangleAxes& a, const simd::TriangleAxes& b, bool intersect) {
  simd::LeastOverlap least{std::numeric_limits<double>::infinity(), {}, false};
  const auto compare = [&](Vec3 axis) {
    if (max_abs(axis) == 0) return;
    if (length_sq(axis) > 0x1p-60) least.is_well_conditioned = true;
    if (!(length_sq(axis) > 0x1p-200)) axis = axis * 0x1p600;
    const auto range = [&](const Triangle& t) {
      return std::minmax({dot(axis, t.v0), dot(axis, t.v1), dot(axis, t.v2)});
    };
    const auto [low_a, high_a] = range(a.corner);
    const auto [low_b, high_b] = range(b.corner);
    double overlap = std::min(high_a - low_b, high_b - low_a);
    if (intersect && overlap < 0) overlap = 0;
    overlap = overlap / length(axis);
    if (overlap < least.overlap) least.overlap = overlap, least.axis = high_b - low_a < high_a - low_b ? -axis : axis;
  };
  compare(a.normal), compare(b.normal);
  for (const Vec3& e : a.edge) {
    for (const Vec3& f : b.edge) {
      Vec3 axis = cross(e, f);
      const double axis_sq = length_sq(axis);
      if (axis_sq < 0x1p-4 && axis_sq > 0) axis = axis - e * (dot(axis, e) / length_sq(e));
      compare(axis);
    }
  }
  return least;
}

TEST_P(CompareFeatures, OfTrianglesFindsTheFirstAxisOfLeastOverlap) {
  Rng rng(1503);
  int found_any = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto [t, u] = random_pair(rng, GetParam());
    const simd::TriangleAxes a = axes_of(t), b = axes_of(u);
    const bool intersect = geometry::intersects(t, u);
    const simd::LeastOverlap expected = least_overlap(a, b, intersect);
    for (const simd::Kernels& set : simd::all_kernels()) {
      simd::LeastOverlap found;
      set.find_least_overlap(a, b, intersect, found);
      ASSERT_EQ(found.overlap, expected.overlap) << set.name << ", pair " << i;
      ASSERT_EQ(found.axis, expected.axis) << set.name << ", pair " << i;
      ASSERT_EQ(found.is_well_conditioned, expected.is_well_conditioned) << set.name << ", pair " << i;
    }
    found_any += expected.is_well_conditioned ? 1 : 0;
  }
  EXPECT_GT(found_any, 0);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompareFeatures,
                         ::testing::Values(PairKind::uniform, PairKind::lattice, PairKind::near_lattice,
                                           PairKind::touching, PairKind::sliver, PairKind::coplanar,
                                           PairKind::shared_edge, PairKind::mixed_scale, PairKind::far_away,
                                           PairKind::one_line, PairKind::needle),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace limber::testing

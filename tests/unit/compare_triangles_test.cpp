// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernel that compares edges and corners of two triangles, next to one pair of edges at a time.
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <limits>

#include "geometry/segment_distance.h"
#include "simd/kernels.h"
#include "support/random_geometry.h"

namespace limber::testing {
namespace {

constexpr std::array<std::size_t, 3> next_corner{1, 2, 0};

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
      const Segment of_a{a.corner[i], a.corner[next_corner[i]]}, of_b{b.corner[j], b.corner[next_corner[j]]};
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

class CompareTriangles : public ::testing::TestWithParam<PairKind> {};

TEST_P(CompareTriangles, FindsTheFirstOfTheClosestEdgesAndAllFeet) {
  Rng rng(1501);
  const auto sets = simd::all_kernels();
  int feet = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto [t, u] = random_pair(rng, GetParam());
    const simd::FaceVectors a = face_of(t), b = face_of(u);
    const simd::TriangleFeatures expected = compare_edges(a, b);
    for (const simd::Kernels& set : sets) {
      simd::TriangleFeatures found;
      set.compare_triangles(a, b, found);
      ASSERT_EQ(found.distance_sq, expected.distance_sq) << set.name << ", pair " << i;
      ASSERT_EQ(found.edge_a, expected.edge_a) << set.name << ", pair " << i;
      ASSERT_EQ(found.edge_b, expected.edge_b) << set.name << ", pair " << i;
      ASSERT_EQ(found.at_a, expected.at_a) << set.name << ", pair " << i;
      ASSERT_EQ(found.at_b, expected.at_b) << set.name << ", pair " << i;
      ASSERT_EQ(found.feet_of_a, feet_in(b, t)) << set.name << ", pair " << i;
      ASSERT_EQ(found.feet_of_b, feet_in(a, u)) << set.name << ", pair " << i;
    }
    feet += expected.distance_sq > 0 && feet_in(a, u) != 0 ? 1 : 0;
  }
  EXPECT_GT(feet, 0);
}

INSTANTIATE_TEST_SUITE_P(EveryKind, CompareTriangles,
                         ::testing::Values(PairKind::uniform, PairKind::lattice, PairKind::near_lattice,
                                           PairKind::touching, PairKind::sliver, PairKind::coplanar,
                                           PairKind::shared_edge, PairKind::mixed_scale, PairKind::far_away,
                                           PairKind::one_line, PairKind::needle),
                         ::testing::PrintToStringParamName());

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Normals of triangles that are apart, next to the direction between their closest points in rational arithmetic.
// LIMBER_NORMAL_PAIRS says how many pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "limber/geometry.h"
#include "support/counts.h"
#include "support/exact_overlap.h"
#include "support/narrow_gaps.h"
#include "support/rational_distance.h"

namespace limber::testing {
namespace {

/// A vector divided by its largest coordinate, then rounded.
Vec3 direction_of(const RationalVec& v) {
  const Rational size = std::max({Rational(abs(v[0])), Rational(abs(v[1])), Rational(abs(v[2]))});
  return {Rational(v[0] / size).get_d(), Rational(v[1] / size).get_d(), Rational(v[2] / size).get_d()};
}

/// The true normal, and how far docs/algorithms/numerics.md allows to be from it.
struct TrueNormal {
  Vec3 direction;
  double allowed;

  TrueNormal(const Triangle& a, const Triangle& b) {
    const RationalVec between = closest_difference(a, b);
    const Rational extent = rational_extent(a, b);
    const Vec3 along = direction_of(between);
    direction = along * (1 / length(along));
    const double extent_over_distance = std::sqrt(Rational(extent * extent / dot(between, between)).get_d());
    allowed = std::sqrt(16 * 0x1p-53 * extent_over_distance);
  }
  double part_of_allowed(const Vec3& normal) const { return length(normal - direction) / allowed; }
};

TEST(ContactNormals, OfNarrowGapsAreWithinTheirErrorAndSeparate) {
  const std::uint64_t pairs = count_from("LIMBER_NORMAL_PAIRS", 20'000);
  Rng rng(4101);
  std::uint64_t apart = 0, narrow = 0;
  double worst = 0;
  for (std::uint64_t i = 0; i < pairs; ++i) {
    const auto [a, b] = narrow_gap(rng);
    const TriangleContact c = contact(a, b);
    if (c.distance == 0) continue;
    ++apart;
    const double extent = extent_of_pair(a, b);
    narrow += c.distance < 0x1p-26 * extent ? 1 : 0;
    const exact::Fraction allowed = exact::fraction(0x1p-48) * exact::fraction(extent);
    ASSERT_LE(exact::overlap_along(exact::exactly(c.normal), a, b), allowed) << "pair " << i;
    // Where it is scaled to, the square of the distance is next to the smallest number.
    const int exponent = std::ilogb(std::max(c.distance, 0x1p-48 * extent));
    const double scale = std::ldexp(1.0, -537 - static_cast<int>(rng.below(3)) - exponent);
    const auto scaled = [&](const Triangle& t) { return Triangle{t.v0 * scale, t.v1 * scale, t.v2 * scale}; };
    const TrueNormal truth(a, b);
    for (const Vec3& normal : {c.normal, contact(scaled(a), scaled(b)).normal}) {
      ASSERT_NEAR(length(normal), 1, 0x1p-50) << "pair " << i;
      ASSERT_LE(truth.part_of_allowed(normal), 1) << "pair " << i;
      worst = std::max(worst, truth.part_of_allowed(normal));
    }
  }
  std::cout << apart << " pairs apart, of which " << narrow << " narrowly; worst error " << worst << " of allowed\n";
  EXPECT_GT(narrow, pairs / 4);
}

}  // namespace
}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Normals of triangles that are apart, next to the direction between their closest points in rational arithmetic.
// LIMBER_NORMAL_PAIRS says how many pairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

#include "limber/geometry.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

// --- random triangles with a gap that is a small part of their size: rounding turns what lies across it ---

double power_of_two(Rng& rng, double low, double high) { return std::exp2(rng.uniform(low, high)); }

/// A triangle of any shape: also with a right angle at the origin, and thin at a corner or along an edge.
Triangle large_triangle(Rng& rng) {
  const double thin = power_of_two(rng, -40, 0);
  Triangle t = uniform_triangle(rng);
  switch (rng.below(6)) {
    case 0:
      return {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    case 1:
      return {{0, 0, 0}, {1, 0, 0}, {0, thin, 0}};
    case 2:
      t.v2 = t.v1 + thin * uniform_point(rng);
      return t;
    case 3:
      t.v2 = t.v0 + rng.uniform() * (t.v1 - t.v0) + thin * uniform_point(rng);
      return t;
    default:
      return t;
  }
}

/// A triangle and another one, of any size, that has its first corner close to a corner, an edge or the face.
std::pair<Triangle, Triangle> beside_a_triangle(Rng& rng) {
  const Triangle a = large_triangle(rng);
  const double gap = power_of_two(rng, -52, -20);
  const double size = rng.below(2) == 0 ? gap * power_of_two(rng, -2, 6) : power_of_two(rng, -30, 0);
  // Near a corner that of an edge is as close as the corner itself, up to rounding.
  const double along = rng.below(3) == 0 ? 0 : rng.below(2) == 0 ? power_of_two(rng, -40, 0) : rng.uniform();
  const double inward = rng.below(4) == 0 ? rng.uniform() * (1 - along) : 0;
  const Vec3 p = point_on(a, along, inward) + gap * uniform_point(rng);
  const auto next = [&](const Vec3& edge) {
    const std::uint64_t kind = rng.below(6);
    if (kind == 0) return p;
    return p + (kind == 1 ? power_of_two(rng, -50, 0) * edge : size * uniform_point(rng));
  };
  const Vec3 q = next(a.v1 - a.v0), r = next(a.v2 - a.v0);
  return {a, {p, q, r}};
}

/// Two triangles of which some corners are close to one another, or all are close to one plane or one line.
std::pair<Triangle, Triangle> along_each_other(Rng& rng) {
  const double gap = power_of_two(rng, -52, -20);
  Triangle a = large_triangle(rng), b = a;
  const std::uint64_t kind = rng.below(3);
  const Vec3 u = uniform_point(rng), v = kind == 1 ? uniform_point(rng) : Vec3{}, off = uniform_point(rng);
  for (Vec3* corner : {&a.v0, &a.v1, &a.v2, &b.v0, &b.v1, &b.v2}) {
    if (kind > 0) *corner = rng.uniform(-1, 1) * u + rng.uniform(-1, 1) * v;
    if (kind == 2) *corner += gap * uniform_point(rng);
  }
  for (Vec3* corner : {&b.v0, &b.v1, &b.v2}) {
    *corner += gap * (kind == 0 ? uniform_point(rng) : off);
    if (kind < 2 && rng.below(4) == 0) *corner += uniform_point(rng);
  }
  return {a, b};
}

/// Coordinates of which each has an exponent of its own, down to the smallest.
std::pair<Triangle, Triangle> tiny_pair(Rng& rng) {
  const auto lowest = static_cast<int>(rng.below(100)), range = static_cast<int>(1 + rng.below(50));
  const auto coordinate = [&] {
    const int exponent = lowest + static_cast<int>(rng.below(static_cast<std::uint64_t>(range))) - 1074;
    return rng.below(6) == 0 ? 0 : std::ldexp(rng.uniform(-1, 1), exponent);
  };
  Triangle a, b;
  for (Vec3* corner : {&a.v0, &a.v1, &a.v2, &b.v0, &b.v1, &b.v2}) *corner = {coordinate(), coordinate(), coordinate()};
  if (rng.below(2) == 0) b = a;
  for (Vec3* corner : {&b.v0, &b.v1, &b.v2}) (*corner)[rng.below(3)] *= rng.uniform();
  return {a, b};
}

/// Any of these, at any scale and place, in any order. Few of them meet.
std::pair<Triangle, Triangle> narrow_gap(Rng& rng) {
  const std::uint64_t kind = rng.below(8);
  auto [a, b] = kind == 0 ? tiny_pair(rng) : kind <= 2 ? along_each_other(rng) : beside_a_triangle(rng);
  const Vec3 off = rng.below(10) == 0 ? power_of_two(rng, 0, 30) * uniform_point(rng) : Vec3{};
  const double scale = kind > 0 && rng.below(8) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(1200)) - 1050) : 1;
  for (Vec3* corner : {&a.v0, &a.v1, &a.v2, &b.v0, &b.v1, &b.v2}) {
    *corner = kind == 0 ? *corner : (*corner + off) * scale;
  }
  if (rng.below(2) == 0) std::swap(a, b);
  if (rng.below(2) == 0) std::swap(a.v0, a.v1);
  if (rng.below(3) == 0) std::swap(b.v0, b.v2);
  return {a, b};
}

// --- their normals ---

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
    const Rational extent = extent_of_pair(a, b);
    const Vec3 along = direction_of(between);
    direction = along * (1 / length(along));
    const double extent_over_distance = std::sqrt(Rational(extent * extent / dot(between, between)).get_d());
    allowed = std::sqrt(16 * 0x1p-53 * extent_over_distance);
  }
  double part_of_allowed(const Vec3& normal) const { return length(normal - direction) / allowed; }
};

TEST(ContactNormals, OfNarrowGapsAreWithinTheirErrorAndSeparate) {
  const std::uint64_t pairs = count_from("LIMBER_NORMAL_PAIRS", 5'000);
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
    ASSERT_LE(overlap_along(rational(c.normal), a, b), Rational(0x1p-48) * Rational(extent)) << "pair " << i;
    // Where it is scaled to, the square of the distance is next to the smallest number.
    const int exponent = std::ilogb(std::max(c.distance, 0x1p-48 * extent));
    const double scale = std::ldexp(1.0, -537 - static_cast<int>(rng.below(3)) - exponent);
    const auto scaled = [scale](const Vec3& p) { return p * scale; };
    const TrueNormal truth(a, b);
    for (const Vec3& normal : {c.normal, contact(mapped(a, scaled), mapped(b, scaled)).normal}) {
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

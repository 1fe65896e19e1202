// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <tuple>
#include <vector>

#include "geometry/triangle_contact.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"
#include "support/rational_geometry.h"

namespace limber::testing {
namespace {

/// A triangle times a scale.
Triangle scaled_triangle(const Triangle& t, double scale) {
  return mapped(t, [scale](const Vec3& p) { return p * scale; });
}

/// A feature as the triangle that it is.
Triangle hull_of(const Triangle& t, const Feature& f) {
  const Vec3 &p = t[f.index], &q = t[(f.index + 1U) % 3];
  return f.kind == FeatureKind::vertex ? Triangle{p, p, p} : f.kind == FeatureKind::edge ? Triangle{p, q, q} : t;
}

std::string name_of(const Feature& f) {
  return std::string(f.kind == FeatureKind::vertex ? "vertex"
                     : f.kind == FeatureKind::edge ? "edge"
                                                   : "face") +
         std::to_string(f.index);
}

bool is_pair_of_disjoint_triangles(const Feature& a, const Feature& b) {
  if (a.kind == FeatureKind::face) return b.kind == FeatureKind::vertex;
  return b.kind != FeatureKind::face || a.kind == FeatureKind::vertex;
}

/// The normals of both faces and the cross products of edges, without rounding.
std::vector<RationalVec> separating_axes(const Triangle& a, const Triangle& b) {
  const auto edges = [](const Triangle& t) {
    return std::array{minus(rational(t.v1), rational(t.v0)), minus(rational(t.v2), rational(t.v1)),
                      minus(rational(t.v0), rational(t.v2))};
  };
  const auto e = edges(a), f = edges(b);
  std::vector<RationalVec> axes{cross(e[0], e[1]), cross(f[0], f[1])};
  for (const auto& e_i : e) {
    for (const auto& f_j : f) axes.push_back(cross(e_i, f_j));
  }
  return axes;
}

/// Checks that weights are those of the feature's corners, and give the point.
void expect_weights(const Triangle& t, const Vec3& weights, const Feature& f, const Vec3& point, double tolerance) {
  EXPECT_NEAR(weights.x + weights.y + weights.z, 1, 0x1p-50);
  for (std::size_t i = 0; i < 3; ++i) {
    const bool has_corner = f.kind == FeatureKind::face || i == f.index ||
                            (f.kind == FeatureKind::edge && i == (f.index + std::size_t{1}) % 3);
    EXPECT_GE(weights[i], 0);
    EXPECT_EQ(weights[i] != 0, has_corner) << i;
  }
  const Vec3 at = weights.x * (t.v0 - point) + weights.y * (t.v1 - point) + weights.z * (t.v2 - point);
  EXPECT_LE(max_abs(at), tolerance);
}

/// contact(), and a check that queries which look at several pairs at once would get the same.
TriangleContact checked_contact(const Triangle& a, const Triangle& b) {
  const TriangleContact c = contact(a, b);
  geometry::ContactBatch batch;
  batch.add(a, b, OrientedFaces::none);
  batch.find_crossings();
  const TriangleContact d = batch.contact(0, std::numeric_limits<double>::infinity());
  EXPECT_EQ(std::tie(c.distance, c.depth, c.point_a, c.point_b, c.normal, c.weights_a, c.weights_b),
            std::tie(d.distance, d.depth, d.point_a, d.point_b, d.normal, d.weights_a, d.weights_b));
  EXPECT_EQ(c.feature_a, d.feature_a);
  EXPECT_EQ(c.feature_b, d.feature_b);
  return c;
}

/// Checks everything that does not depend on how well shaped the triangles are.
void expect_sound(const Triangle& a, const Triangle& b) {
  const TriangleContact c = checked_contact(a, b);
  const ClosestFeatures features = closest_features(a, b);
  const ClosestPoints points = closest_points(a, b);
  const double extent = extent_of_pair(a, b);
  EXPECT_EQ(c.distance, points.distance);
  EXPECT_EQ(c.point_a, points.point_a);
  EXPECT_EQ(c.point_b, points.point_b);
  EXPECT_EQ(features.distance, points.distance);
  EXPECT_EQ(features.point_a, points.point_a);
  EXPECT_EQ(features.point_b, points.point_b);
  EXPECT_EQ(features.feature_a, c.feature_a);
  EXPECT_EQ(features.feature_b, c.feature_b);
  EXPECT_EQ(features.weights_a, c.weights_a);
  EXPECT_EQ(features.weights_b, c.weights_b);

  EXPECT_NEAR(length(c.normal), 1, 0x1p-50);
  const TriangleContact swapped = contact(b, a);
  const bool is_swap = a.v0 != b.v0 || a.v1 != b.v1 || a.v2 != b.v2;
  const Triangle hull_a = hull_of(a, c.feature_a), hull_b = hull_of(b, c.feature_b);
  const std::string pair = name_of(c.feature_a) + " " + name_of(c.feature_b);
  if (c.distance > 0) {
    EXPECT_EQ(c.depth, 0);
    EXPECT_TRUE(is_pair_of_disjoint_triangles(c.feature_a, c.feature_b)) << pair;
    EXPECT_NEAR(closest_points(hull_a, hull_b).distance, c.distance, 0x1p-47 * extent) << pair;
    const double rounding = 0x1p-46 * extent + 0x1p-51 * largest_coordinate(a, b);
    expect_weights(a, c.weights_a, c.feature_a, c.point_a, rounding + 0x1p-1000);
    expect_weights(b, c.weights_b, c.feature_b, c.point_b, rounding + 0x1p-1000);
    // Points that are further apart than the closest by 8 u extent may be off sideways by the root of 16 u extent d.
    const double sideways = 2 * std::sqrt(16 * 0x1p-53 * extent * c.distance);
    const Vec3 between = points.point_b - points.point_a;
    EXPECT_LE(max_abs(between - c.distance * c.normal), rounding + sideways + 0x1p-1000);
    EXPECT_LE(max_abs(swapped.normal + c.normal) * c.distance, rounding + sideways);
    EXPECT_LE(overlap_along(rational(c.normal), a, b), Rational(0x1p-48 * extent + 0x1p-1000));
    EXPECT_LE(closest_points(points.point_a, hull_a).distance, rounding + 0x1p-1000) << pair;
    EXPECT_LE(closest_points(points.point_b, hull_b).distance, rounding + 0x1p-1000) << pair;
    return;
  }
  EXPECT_FALSE(c.feature_a.kind == FeatureKind::face && c.feature_b.kind == FeatureKind::face);
  // Touching features may be named within 2^-46 of the extent; and slivers have no point that fits better on both.
  const double height = std::min(smallest_height_of(a), smallest_height_of(b));
  const double of_slivers = height > 0 ? 32 * 0x1p-53 * extent / height * extent : extent;
  const double off = 0x1p-44 * extent + 0x1p-51 * largest_coordinate(a, b) + std::min(of_slivers, 0x1p-25 * extent);
  expect_weights(a, c.weights_a, c.feature_a, c.point_a, off + 0x1p-1000);
  expect_weights(b, c.weights_b, c.feature_b, c.point_b, off + 0x1p-1000);
  EXPECT_LE(closest_points(points.point_a, hull_a).distance, off + 0x1p-1000) << pair;
  EXPECT_LE(closest_points(points.point_b, hull_b).distance, off + 0x1p-1000) << pair;
  EXPECT_LE(closest_points(hull_a, hull_b).distance, 0x1p-26 * extent) << pair;
  EXPECT_GE(c.depth, 0);
  EXPECT_LE(c.depth, 2 * extent);
  EXPECT_EQ(swapped.depth, c.depth);
  EXPECT_EQ(swapped.normal, is_swap ? -c.normal : c.normal);
  // Moving b by the depth parts the two, without rounding.
  const RationalVec n = rational(c.normal);
  const Rational room = Rational(0x1p-1000 * (extent + 1));
  EXPECT_GE((Rational(c.depth) + room) * dot(n, n), overlap_along(n, a, b));
}

/// Checks that the depth exceeds the overlap along no axis by more than docs/algorithms/numerics.md says.
void expect_least_overlap(const Triangle& a, const Triangle& b) {
  const TriangleContact c = contact(a, b);
  if (c.distance > 0) return;
  const double extent = extent_of_pair(a, b), height = std::min(smallest_height_of(a), smallest_height_of(b));
  const double of_slivers = height > 0 ? 32 * 0x1p-53 * extent / height * extent : extent;
  const double tolerance = 0x1p-47 * extent + std::min(of_slivers, 0x1p-24 * extent) + 0x1p-1000;
  for (const RationalVec& axis : separating_axes(a, b)) {
    const Rational axis_sq = dot(axis, axis);
    if (axis_sq == 0) continue;
    for (const RationalVec& direction : {axis, negative(axis)}) {
      const Rational overlap = overlap_along(direction, a, b);
      EXPECT_TRUE(exact::is_at_most(c.depth, overlap * overlap / axis_sq, tolerance));
    }
  }
}

const Triangle ground{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
constexpr Feature on_vertex(std::uint8_t i) { return {FeatureKind::vertex, i}; }
constexpr Feature on_edge(std::uint8_t i) { return {FeatureKind::edge, i}; }
constexpr Feature on_face{FeatureKind::face, 0};

TEST(ClosestFeatures, KnownValues) {
  struct Known {
    const char* what;
    Triangle other;
    Feature of_ground, of_other;
  };
  const Known cases[] = {
      {"corner above a face", {{1, 5, 5}, {1, 1, 2}, {2, 1, 5}}, on_face, on_vertex(1)},
      {"corner beside a corner", {{7, -4, 0}, {9, -4, 0}, {7, -9, 0}}, on_vertex(1), on_vertex(0)},
      {"corner beside an edge", {{9, -9, 0}, {1, -9, 0}, {2, -1, 0}}, on_edge(0), on_vertex(2)},
      {"corner beside the slanted edge", {{3, 3, 0}, {9, 9, 0}, {9, 8, 0}}, on_edge(1), on_vertex(0)},
      {"edges that cross", {{-1, 1, -3}, {-1, 1, 3}, {-9, 1, 0}}, on_edge(2), on_edge(0)},
      {"face above a corner", {{3, -9, -9}, {7, 9, -9}, {5, 0, 9}}, on_vertex(1), on_face},
      {"pierced by a standing edge near an edge", {{0.25, 1, 3}, {0.25, 1, -1}, {3, 1, 9}}, on_face, on_edge(0)},
      {"corner on a face", {{1, 1, 0}, {1, 2, 3}, {2, 1, 3}}, on_face, on_vertex(0)},
      {"corner on a corner", {{9, 9, 9}, {4, 0, 0}, {9, -9, 9}}, on_vertex(1), on_vertex(1)},
      {"corner on an edge", {{2, 0, 0}, {2, -3, 1}, {3, -3, 1}}, on_edge(0), on_vertex(0)},
      {"edge on an edge", {{2, -1, -1}, {2, 1, 1}, {2, -5, 0}}, on_edge(0), on_edge(0)},
  };
  for (const Known& k : cases) {
    const ClosestFeatures found = closest_features(ground, k.other), swapped = closest_features(k.other, ground);
    EXPECT_EQ(found.feature_a, k.of_ground) << k.what << ": " << name_of(found.feature_a);
    EXPECT_EQ(found.feature_b, k.of_other) << k.what << ": " << name_of(found.feature_b);
    EXPECT_EQ(swapped.feature_b, k.of_ground) << k.what << ", swapped: " << name_of(swapped.feature_b);
    EXPECT_EQ(swapped.feature_a, k.of_other) << k.what << ", swapped: " << name_of(swapped.feature_a);
  }
}

TEST(ClosestFeatures, OfTrianglesThatTouchInOnePlaceAndCrossInAnotherAreThoseOfThePoint) {
  // Corner 0 is on the ground, and the edge opposite to it passes through.
  const Triangle other{{1, 1, 0}, {2, 1, 1}, {2, 1, -1}};
  const ClosestFeatures found = closest_features(ground, other);
  EXPECT_EQ(found.point_b, (Vec3{2, 1, 0}));
  EXPECT_EQ(found.feature_a, on_face);
  EXPECT_EQ(found.feature_b, on_edge(1));
  EXPECT_EQ(found.weights_a, (Vec3{0.25, 0.5, 0.25}));
  EXPECT_EQ(found.weights_b, (Vec3{0, 0.5, 0.5}));
}

TEST(TriangleContact, KnownValues) {
  const TriangleContact above = contact(ground, {{1, 1, 2}, {2, 1, 5}, {1, 2, 5}});
  EXPECT_EQ(above.distance, 2);
  EXPECT_EQ(above.normal, (Vec3{0, 0, 1}));
  const TriangleContact corner = contact(ground, {{7, -4, 0}, {9, -4, 0}, {7, -9, 0}});
  EXPECT_NEAR(max_abs(corner.normal - Vec3{0.6, -0.8, 0}), 0, 1e-15);

  // A corner a little below the face: b moves up.
  const TriangleContact pierced = contact(ground, {{1, 1, -0.25}, {1, 2, 5}, {2, 1, 5}});
  EXPECT_EQ(pierced.distance, 0);
  EXPECT_NEAR(pierced.depth, 0.25, 1e-14);
  EXPECT_EQ(pierced.normal, (Vec3{0, 0, 1}));
  EXPECT_EQ(contact({{1, 1, -0.25}, {1, 2, 5}, {2, 1, 5}}, ground).normal, (Vec3{0, 0, -1}));

  // A standing triangle that reaches over the edge x = 0 by less than it reaches below the face.
  const TriangleContact edges = contact(ground, {{0.5, 1, -3}, {0.5, 1, 3}, {-5, 1, 0}});
  EXPECT_NEAR(edges.depth, 0.5, 1e-14);
  EXPECT_EQ(edges.normal, (Vec3{-1, 0, 0}));

  // In one plane: the normal of the plane, and nothing to part.
  const TriangleContact coplanar = contact(ground, {{1, 1, 0}, {5, 1, 0}, {1, 5, 0}});
  EXPECT_EQ(coplanar.depth, 0);
  EXPECT_EQ(coplanar.normal.x, 0);
  EXPECT_EQ(coplanar.normal.y, 0);
}

TEST(TriangleContact, DegenerateTrianglesHaveNormals) {
  const Vec3 o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0}, m{1, 0, 0};
  const Triangle point{o, o, o}, segment{o, x, o}, long_segment{-x, x, x}, middle{m, m, m}, crossing{y, -y, y};
  const std::vector<Triangle> all{point, segment, long_segment, middle, crossing, ground, {o, {2, 2, 0}, {3, 1, 0}}};
  for (const Triangle& a : all) {
    for (const Triangle& b : all) {
      for (const double scale : {1.0, 1e-150, 1e55, max_coordinate / 16, 0x1p-1072}) {
        const Triangle t = scaled_triangle(a, scale), u = scaled_triangle(b, scale);
        expect_sound(t, u);
        EXPECT_LE(contact(t, u).depth, scale * 0x1p-49);  // all are in the plane z = 0
        expect_sound(t, {u.v0 + x * scale, u.v1 + x * scale, u.v2 + x * scale});
      }
    }
  }
  // Along one line: across it.
  EXPECT_NEAR(dot(contact(segment, long_segment).normal, x), 0, 1e-15);
  EXPECT_NEAR(dot(contact(middle, segment).normal, x), 0, 1e-15);
  EXPECT_EQ(abs(contact(segment, crossing).normal), (Vec3{0, 0, 1}));
}

TEST(TriangleContact, NeedlesOfAnyWidthHaveTheNormalOfTheirPlane) {
  for (const double width : {1e-5, 1e-20, 1e-110, 1e-250}) {
    const Triangle a{{0, 0, 0}, {1, 0, 0}, {0.5, width, 2 * width}};
    const Triangle b{{0.25, 0, 0}, {0.75, width, 2 * width}, {2, 0, 0}};
    const TriangleContact c = contact(a, b);
    EXPECT_EQ(c.distance, 0);
    EXPECT_LE(c.depth, 4e-15 * width);
    EXPECT_NEAR(c.normal.y, -2 * c.normal.z, 1e-15) << width;
    EXPECT_EQ(c.normal.x, 0) << width;
  }
}

TEST(TriangleContact, ACornerNextToTheCrossingEdgeIsTheSmallerFeature) {
  const Triangle face{{-4, -4, 0}, {4, -4, 0}, {0, 4, 0}};
  for (const double width : {0.0, 0x1p-60}) {
    const Triangle sliver{{0, 0, -1}, {0, 0, 1}, {width, 0, 0}};
    EXPECT_EQ(checked_contact(face, sliver).feature_b, (Feature{FeatureKind::vertex, 2})) << width;
    EXPECT_EQ(checked_contact(sliver, face).feature_a, (Feature{FeatureKind::vertex, 2})) << width;
  }
}

TEST(TriangleContact, TheSmallestGapHasANormal) {
  for (const double gap : {0x1p-1074, 0x1p-1022, 1e-200, 1e-30}) {
    const TriangleContact above = contact(ground, {{1, 1, gap}, {2, 1, 5}, {1, 2, 5}});
    EXPECT_GT(above.distance, 0);
    EXPECT_EQ(above.depth, 0);
    EXPECT_EQ(above.normal, (Vec3{0, 0, 1})) << gap;
    // Two corners, of which only the connecting line is known.
    const TriangleContact corners =
        contact({{0, 0, 0}, {-4, -1, 0}, {-1, -4, 0}}, {{3 * gap, 0, 4 * gap}, {5, 1, 5}, {5, -1, 5}});
    EXPECT_NEAR(max_abs(corners.normal - Vec3{0.6, 0, 0.8}), 0, 1e-15) << gap;
  }
}

TEST(TriangleContact, OfPiercedSliversIsSound) {
  Rng rng(402);
  const auto direction = [&] {
    const Vec3 v = uniform_point(rng);
    return v * (1 / std::max(length(v), 1e-3));
  };
  for (int i = 0; i < 600 && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const Vec3 side = direction(), at = rng.below(2) == 0 ? Vec3{} : direction(), inside = at + rng.uniform() * side;
    const double width = std::ldexp(rng.uniform(1, 2), -static_cast<int>(rng.below(60)));
    const Triangle a{at, at + side, inside + width * cross(side, direction())};
    const Vec3 out = std::ldexp(1.0, -static_cast<int>(rng.below(50))) * direction();
    const Vec3 off = i % 3 == 0 ? Vec3{} : std::ldexp(1.0, -static_cast<int>(rng.below(50))) * direction();
    const Triangle b{inside - out, inside + rng.uniform() * out + off, inside + out};
    expect_sound(a, b);
    expect_least_overlap(a, b);
  }
}

TEST(TriangleContact, OfNearlyMeetingSegmentsKeepsThemApart) {
  // Two segments that pass each other by less than rounding, at an angle of a few degrees.
  const Vec3 p{0x1.c02e209da2226p+0, 0x1.c71b266260a25p+0, 0x1.1f9d5ba3e159p-5};
  const Vec3 q{0x1.fff7907ec1e07p+0, 0x1.0004fcc8aea5dp+0, 0x1.0003d5681a8a2p+1};
  const Vec3 r{0x1.c02e209da2226p+0, 0x1.c71b266260a25p+0, 0x1.1f9d5ba3e158p-5}, s{2, 1, 2};
  expect_sound({p, p, q}, {r, s, s});
  EXPECT_GT(contact({p, p, q}, {r, s, s}).distance, 0);
  Rng rng(404);
  int apart = 0;
  for (int i = 0; i < 20'000 && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    const auto [a, b] = random_pair(rng, PairKind::segment_like);
    const TriangleContact c = contact(a, b);
    if (c.distance == 0) continue;
    ++apart;
    const double extent = extent_of_pair(a, b);
    if (c.distance > 0x1p-30 * extent) continue;  // the other cases are easy
    EXPECT_LE(overlap_along(rational(c.normal), a, b), Rational(0x1p-48 * extent + 0x1p-1000));
  }
  EXPECT_GT(apart, 5000);
}

TEST(TriangleContact, OfEveryKindOfPairIsSoundAndHasTheLeastOverlap) {
  Rng rng(401);
  for (int i = 0; i < 5200 && !HasFailure(); ++i) {
    SCOPED_TRACE("case " + std::to_string(i));
    auto [a, b] = random_pair(rng, static_cast<PairKind>(i % static_cast<int>(PairKind::count)));
    if (i % 3 == 0) expect_least_overlap(a, b);
    if (rng.below(8) == 0) a.v2 = a.v1;
    if (rng.below(16) == 0) b.v0 = b.v2;
    expect_sound(a, b);
  }
}

}  // namespace
}  // namespace limber::testing

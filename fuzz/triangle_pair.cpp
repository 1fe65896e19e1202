// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Bytes as two triangles: predicates against exact arithmetic, closest points against the predicates.
#include <algorithm>
#include <cmath>
#include <tuple>

#include "fuzz/inputs.h"
#include "fuzz/property.h"
#include "limber/geometry.h"
#include "support/exact_intersection.h"
#include "support/right_answers.h"

namespace limber::fuzz {
namespace {

namespace exact = testing::exact;

/// The error that distances and points may have, as a part of the largest coordinate, and at least: distances that are
/// not 0 are at least 2^-1022.
constexpr double relative_tolerance = 1e-14, least_tolerance = 0x1p-1020;

struct Scene {
  std::uint8_t environment;
  Triangle a, b;
  double tolerance, contact_tolerance;
};

Triangle triangle(ByteReader& bytes, double factor) {
  const Vec3 v0 = scaled(point(bytes), factor), v1 = scaled(point(bytes), factor), v2 = scaled(point(bytes), factor);
  return {v0, v1, v2};
}

/// A point that rounding puts on or just beside the triangle.
Vec3 point_beside(ByteReader& bytes, const Triangle& t) {
  const double u = bytes.below(17) / 16.0, v = (1 - u) * bytes.below(17) / 16.0;
  Vec3 p{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    p[axis] = (1 - u - v) * t.v0[axis] + u * t.v1[axis] + v * t.v2[axis];
    p[axis] = made_valid(nudged(p[axis], static_cast<int>(bytes.below(5)) - 2));
  }
  return p;
}

Scene scene(ByteReader bytes) {
  const std::uint8_t environment = bytes.byte(), kind = bytes.byte();
  const double factor = scale(bytes), factor_b = kind % 4 == 1 ? scale(bytes) : factor;
  const Triangle a = triangle(bytes, factor);
  Triangle b = triangle(bytes, factor_b);
  if (kind % 4 == 2) b.v0 = point_beside(bytes, a);
  if (kind % 4 == 3) b = {point_beside(bytes, a), point_beside(bytes, a), b.v2};
  double size = 0;
  for (std::size_t i = 0; i < 3; ++i) size = std::max({size, max_abs(a[i]), max_abs(b[i])});
  const double tolerance = std::max(relative_tolerance * size, least_tolerance);
  return {environment, a, b, tolerance, tolerance + testing::sliver_tolerance(a, b, size)};
}

bool is_on(const Vec3& p, const Triangle& t, double tolerance) {
  return is_finite(p) && closest_points(p, t).distance <= tolerance;
}

/// As limber::orient3d() and limber::orient2d(), without rounding.
int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const exact::WholeCoordinates whole({a, b, c, d});
  return sgn(dot(cross(whole(b) - whole(a), whole(c) - whole(a)), whole(d) - whole(a)));
}
int exact_orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  const exact::WholeCoordinates whole({a, b, c});
  const exact::Vec normal = cross(whole(b) - whole(a), whole(c) - whole(a));
  return sgn(axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z);
}

/// Whether the triangles meet, after checks of the answer for both orders and other orders of corners.
bool check_predicates(const Scene& s) {
  const Triangle turned{s.b.v1, s.b.v2, s.b.v0}, flipped{s.a.v1, s.a.v0, s.a.v2};
  const auto [meet, swapped, permuted, by_edge, orientation] = in_environment(s.environment, [&] {
    bool crosses = false;
    for (std::size_t i = 0; i < 3; ++i) {
      crosses = intersects(Segment{s.a[i], s.a[(i + 1) % 3]}, s.b) || crosses;
      crosses = intersects(Segment{s.b[i], s.b[(i + 1) % 3]}, s.a) || crosses;
    }
    return std::tuple(intersects(s.a, s.b), intersects(s.b, s.a), intersects(flipped, turned), crosses,
                      orient3d(s.a.v0, s.a.v1, s.a.v2, s.b.v0));
  });
  require(meet == exact::intersect(s.a, s.b), "intersects() is exact");
  require(swapped == meet, "intersects() is symmetric");
  require(permuted == meet, "intersects() does not depend on the order of corners");
  require(by_edge == meet, "triangles meet exactly when an edge of one meets the other");
  require(orientation == exact_orient3d(s.a.v0, s.a.v1, s.a.v2, s.b.v0), "orient3d() is exact");
  const Segment edge{s.a.v0, s.b.v0};
  require(in_environment(s.environment, [&] { return intersects(edge, s.b); }),
          "a segment meets the triangle on which it ends");
  const Segment side{s.a.v0, s.a.v1};
  require(in_environment(s.environment, [&] { return intersects(side, s.b); }) ==
              exact::intersect({side.p0, side.p1, side.p1}, s.b),
          "intersects() of a segment and a triangle is exact");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int sign = in_environment(s.environment, [&] { return orient2d(s.a.v0, s.a.v1, s.b.v0, axis); });
    require(sign == exact_orient2d(s.a.v0, s.a.v1, s.b.v0, axis), "orient2d() is exact");
  }
  return meet;
}

void check_closest_points(const Scene& s, bool meet) {
  const ClosestPoints found = in_environment(s.environment, [&] { return closest_points(s.a, s.b); });
  const ClosestPoints swapped = in_environment(s.environment, [&] { return closest_points(s.b, s.a); });
  require(std::isfinite(found.distance) && found.distance >= 0, "a distance is finite and not negative");
  require((found.distance == 0) == meet, "the distance is 0 exactly when the triangles meet");
  require((swapped.distance == 0) == meet, "the distance is 0 exactly when the triangles meet, in the other order");
  require(std::abs(found.distance - swapped.distance) <= s.tolerance, "the distance is symmetric");
  require(!meet || found.point_a == found.point_b, "triangles that meet have one closest point");
  const Vec3 between = found.point_b - found.point_a;
  require(std::abs(std::hypot(between.x, between.y, between.z) - found.distance) <= s.tolerance,
          "the distance is that of the points");
  const double off = meet ? s.contact_tolerance : s.tolerance;
  require(is_on(found.point_a, s.a, off) && is_on(found.point_b, s.b, off), "closest points lie on their triangles");
  double nearest = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    nearest = std::min({nearest, closest_points(s.a[i], s.b).distance, closest_points(s.b[i], s.a).distance});
    for (std::size_t j = 0; j < 3; ++j) {
      const Segment edge_a{s.a[i], s.a[(i + 1) % 3]}, edge_b{s.b[j], s.b[(j + 1) % 3]};
      nearest = std::min(nearest, closest_points(edge_a, edge_b).distance);
    }
  }
  require(found.distance <= nearest + s.tolerance, "no edge or corner is closer than the triangles");
  require(meet || found.distance >= nearest - s.tolerance, "apart, an edge or corner is as close as the triangles");
}

bool is_same(const Triangle& a, const Triangle& b) { return a.v0 == b.v0 && a.v1 == b.v1 && a.v2 == b.v2; }

void check_contact(const Scene& s, bool meet, OrientedFaces oriented, OrientedFaces oriented_swapped) {
  const TriangleContact found = in_environment(s.environment, [&] { return contact(s.a, s.b, oriented); });
  const TriangleContact swapped = in_environment(s.environment, [&] { return contact(s.b, s.a, oriented_swapped); });
  require(oriented != OrientedFaces::none || found.normal_side == NormalSide::unknown, "a side needs an outside");
  require(!meet || found.normal_side != NormalSide::inward, "normals of triangles that meet are never inward");
  require((found.distance == 0) == meet, "a contact's distance is 0 exactly when the triangles meet");
  require(std::abs(length(found.normal) - 1) <= 0x1p-50, "a contact's normal has length 1");
  require(std::isfinite(found.depth) && found.depth >= 0, "a depth is finite and not negative");
  require(meet || found.depth == 0, "triangles that are apart have no depth");
  require(!meet || is_same(s.a, s.b) || swapped.normal == -found.normal,
          "swapping triangles that meet negates the normal");
  const TriangleContact plain = in_environment(s.environment, [&] { return contact(s.a, s.b); });
  require(found.depth == plain.depth, "a depth does not depend on outsides");
  double end = -HUGE_VAL, start = HUGE_VAL;
  for (std::size_t i = 0; i < 3; ++i) {
    end = std::max(end, dot(plain.normal, s.a[i])), start = std::min(start, dot(plain.normal, s.b[i]));
  }
  require(start + plain.depth >= end - s.tolerance, "the depth along the normal parts the triangles");
  const bool has_faces = found.feature_a.kind == FeatureKind::face && found.feature_b.kind == FeatureKind::face;
  require(!has_faces, "at most one feature of a contact is a face");
}

void check_contacts(const Scene& s, bool meet) {
  check_contact(s, meet, OrientedFaces::none, OrientedFaces::none);
  check_contact(s, meet, OrientedFaces::of_a, OrientedFaces::of_b);
  check_contact(s, meet, OrientedFaces::both, OrientedFaces::both);
}

}  // namespace
}  // namespace limber::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace limber::fuzz;
  const Scene s = scene(ByteReader({data, size}));
  const bool meet = check_predicates(s);
  check_closest_points(s, meet);
  check_contacts(s, meet);
  return 0;
}

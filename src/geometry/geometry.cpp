// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions: each puts the thread into the default floating-point environment, checks what it was given and
// calls the library's own. The result goes through computed_before_restore(), because a compiler may inline the call.
#include "limber/geometry.h"

#include "base/check.h"
#include "base/float_environment.h"
#include "geometry/primitives.h"

namespace limber {

using base::DefaultFloatEnvironment;

namespace {

template <typename... Points>
bool are_finite(const Points&... points) {
  return (... && is_finite(points));
}
bool are_finite(const Triangle& a, const Triangle& b) { return are_finite(a.v0, a.v1, a.v2, b.v0, b.v1, b.v2); }

/// False for NaN.
template <typename... Points>
bool are_in_range(const Points&... points) {
  return (... && (max_abs(points) <= max_coordinate && is_finite(points)));
}
constexpr const char* out_of_range = "limber::closest_points: a coordinate is not finite, or above 2^200";

}  // namespace

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_finite(a, b, c, d), "limber::orient3d: a coordinate is not finite");
  return environment.computed_before_restore(geometry::orient3d(a, b, c, d));
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_finite(a, b, c), "limber::orient2d: a coordinate is not finite");
  LIMBER_REQUIRE(axis < 3, "limber::orient2d: axis is not 0, 1 or 2");
  return environment.computed_before_restore(geometry::orient2d(a, b, c, axis));
}

bool intersects(const Triangle& a, const Triangle& b) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_finite(a, b), "limber::intersects: a coordinate is not finite");
  return environment.computed_before_restore(geometry::intersects(a, b));
}

bool intersects(const Segment& segment, const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_finite(segment.p0, segment.p1, triangle.v0, triangle.v1, triangle.v2),
                 "limber::intersects: a coordinate is not finite");
  return environment.computed_before_restore(geometry::intersects(segment, triangle));
}

ClosestPoints closest_points(const Segment& a, const Segment& b) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_in_range(a.p0, a.p1, b.p0, b.p1), out_of_range);
  return environment.computed_before_restore(geometry::closest_points(a, b));
}

ClosestPoints closest_points(const Vec3& point, const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_in_range(point, triangle.v0, triangle.v1, triangle.v2), out_of_range);
  return environment.computed_before_restore(geometry::closest_points(point, triangle));
}

ClosestPoints closest_points(const Triangle& a, const Triangle& b) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_in_range(a.v0, a.v1, a.v2, b.v0, b.v1, b.v2), out_of_range);
  return environment.computed_before_restore(geometry::closest_points(a, b));
}

ClosestFeatures closest_features(const Triangle& a, const Triangle& b) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_in_range(a.v0, a.v1, a.v2, b.v0, b.v1, b.v2),
                 "limber::closest_features: a coordinate is not finite, or above 2^200");
  return environment.computed_before_restore(geometry::closest_features(a, b));
}

TriangleContact contact(const Triangle& a, const Triangle& b) { return contact(a, b, OrientedFaces::none); }

TriangleContact contact(const Triangle& a, const Triangle& b, OrientedFaces oriented) {
  const DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(are_in_range(a.v0, a.v1, a.v2, b.v0, b.v1, b.v2),
                 "limber::contact: a coordinate is not finite, or above 2^200");
  return environment.computed_before_restore(geometry::contact(a, b, oriented));
}

}  // namespace limber

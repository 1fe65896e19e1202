// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions: each puts the thread into the default floating-point environment and calls the library's own.
#include "limber/geometry.h"

#include "core/float_environment.h"
#include "geometry/primitives.h"

namespace limber {

using core::DefaultFloatEnvironment;

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const DefaultFloatEnvironment environment;
  return geometry::orient3d(a, b, c, d);
}

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  const DefaultFloatEnvironment environment;
  return geometry::orient2d(a, b, c, axis);
}

bool intersects(const Triangle& a, const Triangle& b) {
  const DefaultFloatEnvironment environment;
  return geometry::intersects(a, b);
}

bool intersects(const Segment& segment, const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  return geometry::intersects(segment, triangle);
}

ClosestPoints closest_points(const Segment& a, const Segment& b) {
  const DefaultFloatEnvironment environment;
  return geometry::closest_points(a, b);
}

ClosestPoints closest_points(const Vec3& point, const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  return geometry::closest_points(point, triangle);
}

ClosestPoints closest_points(const Triangle& a, const Triangle& b) {
  const DefaultFloatEnvironment environment;
  return geometry::closest_points(a, b);
}

Sphere enclosing_sphere(const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  return geometry::enclosing_sphere(triangle);
}

Sphere enclosing_sphere(const Sphere& a, const Sphere& b) {
  const DefaultFloatEnvironment environment;
  return geometry::enclosing_sphere(a, b);
}

bool contains(const Sphere& outer, const Sphere& inner) {
  const DefaultFloatEnvironment environment;
  return geometry::contains(outer, inner);
}

bool contains(const Sphere& sphere, const Triangle& triangle) {
  const DefaultFloatEnvironment environment;
  return geometry::contains(sphere, triangle);
}

}  // namespace limber

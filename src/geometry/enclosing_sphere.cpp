// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  the textbook circumcenter; the center only decides how tight a sphere is, never whether it is valid.
// Differs   The radius is always recomputed from the stored center and rounded up, so an inaccurate center (slivers,
//           nearly concentric spheres) costs tightness at most.
#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "base/rounding.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

double radius_around(const Vec3& center, const Triangle& t) {
  return std::max({base::distance_up(center, t.v0), base::distance_up(center, t.v1), base::distance_up(center, t.v2)});
}

double radius_around(const Vec3& center, const Sphere& s) {
  return base::add_up(base::distance_up(center, s.center), s.radius);
}

// Center of the smallest sphere: the middle of the longest edge where the angle opposite to it is right or obtuse, else
// the circumcenter. Edges are divided by the longest first, so no scale can overflow or underflow their products.
Vec3 center_of(const Triangle& t) {
  // Rotate the corners so that (a, b) is the longest edge.
  const double l01 = base::distance_up(t.v0, t.v1);
  const double l12 = base::distance_up(t.v1, t.v2);
  const double l20 = base::distance_up(t.v2, t.v0);
  const double longest = std::max({l01, l12, l20});
  if (longest == 0) return t.v0;
  const Vec3& a = longest == l01 ? t.v0 : longest == l12 ? t.v1 : t.v2;
  const Vec3& b = longest == l01 ? t.v1 : longest == l12 ? t.v2 : t.v0;
  const Vec3& c = longest == l01 ? t.v2 : longest == l12 ? t.v0 : t.v1;

  const Vec3 to_a = (a - c) * (1 / longest);
  const Vec3 to_b = (b - c) * (1 / longest);
  const Vec3 n = cross(to_a, to_b);
  const double n_sq = length_sq(n);
  const bool acute = dot(to_a, to_b) > 0;
  // Below 2^-100 the middle is as good: c is within 2^-50 of an end. OfANeedleWithAVanishingSideIsFinite needs the
  // test.
  if (!acute || n_sq < 0x1p-100) return a + (b - a) * 0.5;
  const Vec3 offset = (length_sq(to_a) * cross(to_b, n) + length_sq(to_b) * cross(n, to_a)) * (0.5 / n_sq);
  return c + offset * longest;
}

}  // namespace

Sphere geometry::enclosing_sphere(const Triangle& triangle) {
  const Vec3 center = center_of(triangle);
  return {center, radius_around(center, triangle)};
}

Sphere geometry::enclosing_sphere(const Sphere& a, const Sphere& b) {
  LIMBER_ASSERT(a.radius >= 0 && b.radius >= 0);
  const Sphere& larger = a.radius >= b.radius ? a : b;
  const Sphere& smaller = a.radius >= b.radius ? b : a;
  const double gap = base::distance_up(larger.center, smaller.center);
  Vec3 center = larger.center;
  if (gap > larger.radius - smaller.radius) {
    const double shift = 0.5 * ((gap - larger.radius) + smaller.radius);  // from the larger center to the new one
    center += (smaller.center - larger.center) * std::clamp(shift / gap, 0.0, 1.0);
  }
  return {center, std::max(radius_around(center, a), radius_around(center, b))};
}

bool geometry::contains(const Sphere& outer, const Sphere& inner) {
  return radius_around(outer.center, inner) <= outer.radius;
}

bool geometry::contains(const Sphere& sphere, const Triangle& triangle) {
  return radius_around(sphere.center, triangle) <= sphere.radius;
}

}  // namespace limber

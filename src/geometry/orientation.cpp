// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Shewchuk1997]: the error bound of the first stage, (3 + 16 e) e for areas. Differs as plane_sides.h does.
#include <cmath>

#include "base/check.h"
#include "geometry/plane_sides.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

constexpr double epsilon = 0x1p-53;
constexpr double area_bound = (3 + 16 * epsilon) * epsilon;
constexpr double underflow_bound = 0x1p-760;  // as that of volumes

int sign(double x) { return x > 0 ? 1 : -1; }

}  // namespace

int geometry::orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return PlaneSides(a, b, c).of(d); }

int geometry::orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  LIMBER_ASSERT(axis < 3);
  LIMBER_ASSERT(is_finite(a) && is_finite(b) && is_finite(c));
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (b[i] - a[i]) * (c[j] - a[j]);
  const double right = (b[j] - a[j]) * (c[i] - a[i]);
  const double det = left - right;
  const double permanent = std::abs(left) + std::abs(right);
  const bool certain = std::abs(det) > area_bound * permanent + underflow_bound;
  if (certain && std::isfinite(permanent)) return sign(det);
  const auto are_equal = [i, j](const Vec3& p, const Vec3& q) { return p[i] == q[i] && p[j] == q[j]; };
  if (are_equal(a, b) || are_equal(b, c) || are_equal(c, a)) return 0;
  return geometry::exact_area_sign(a[i], a[j], b[i], b[j], c[i], c[j]);
}

}  // namespace limber

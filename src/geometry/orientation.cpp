// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  [Shewchuk1997]: the error bounds of the first stage, (7 + 56 e) e for volumes and (3 + 16 e) e for areas.
// Differs   The bounds get an absolute term for underflow, which the source excludes by assumption; inputs that
//           overflow make the comparisons false (inf, NaN) and so go to the exact stage like every other undecided
//           input.
#include <cmath>

#include "core/check.h"
#include "geometry/exact_sign.h"
#include "geometry/primitives.h"

namespace limber {
namespace {

constexpr double epsilon = 0x1p-53;
constexpr double volume_bound = (7 + 56 * epsilon) * epsilon;
constexpr double area_bound = (3 + 16 * epsilon) * epsilon;

// An underflowing product is off by at most 2^-1074; with factors below 2^300 that grows to 2^-770 in a triple product.
constexpr double largest_filtered = 0x1p300;
constexpr double underflow_bound = 0x1p-760;

int sign(double x) { return x > 0 ? 1 : -1; }

}  // namespace

int geometry::orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  LIMBER_ASSERT(is_finite(a) && is_finite(b) && is_finite(c) && is_finite(d));
  const Vec3 p = b - a, q = c - a, r = d - a;
  const double yz = p.y * q.z, zy = p.z * q.y;
  const double zx = p.z * q.x, xz = p.x * q.z;
  const double xy = p.x * q.y, yx = p.y * q.x;
  const double det = r.x * (yz - zy) + r.y * (zx - xz) + r.z * (xy - yx);
  const double permanent = std::abs(r.x) * (std::abs(yz) + std::abs(zy)) +
                           std::abs(r.y) * (std::abs(zx) + std::abs(xz)) +
                           std::abs(r.z) * (std::abs(xy) + std::abs(yx));
  const bool certain = std::abs(det) > volume_bound * permanent + underflow_bound && max_abs(r) < largest_filtered;
  return certain && std::isfinite(permanent) ? sign(det) : geometry::exact_volume_sign(a, b, c, d);
}

int geometry::orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  LIMBER_ASSERT(axis < 3);
  LIMBER_ASSERT(is_finite(a) && is_finite(b) && is_finite(c));
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (b[i] - a[i]) * (c[j] - a[j]);
  const double right = (b[j] - a[j]) * (c[i] - a[i]);
  const double det = left - right;
  const double permanent = std::abs(left) + std::abs(right);
  const bool certain = std::abs(det) > area_bound * permanent + underflow_bound;
  return certain && std::isfinite(permanent) ? sign(det)
                                             : geometry::exact_area_sign(a[i], a[j], b[i], b[j], c[i], c[j]);
}

}  // namespace limber

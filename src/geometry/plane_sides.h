// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>

#include "base/check.h"
#include "limber/math.h"

namespace limber::geometry {

/// Sign of the determinant with rows b - a, c - a, d - a, without any rounding: for where a filter cannot decide.
int exact_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// On which side of the plane through three points others are; what depends on the three alone is computed once.
///
/// Based on  [Shewchuk1997]: the error bound of the first stage, (7 + 56 e) e.
/// Differs   The bound gets an absolute term for underflow, which the source excludes by assumption; inputs that
///           overflow make the comparison false (inf, NaN) and so go to the exact stage like every other undecided
///           input.
class PlaneSides {
 public:
  PlaneSides(const Vec3& a, const Vec3& b, const Vec3& c) : a_(a), b_(b), c_(c) {
    LIMBER_ASSERT(is_finite(a) && is_finite(b) && is_finite(c));
    const Vec3 p = b - a, q = c - a;
    const double yz = p.y * q.z, zy = p.z * q.y;
    const double zx = p.z * q.x, xz = p.x * q.z;
    const double xy = p.x * q.y, yx = p.y * q.x;
    minors_ = {yz - zy, zx - xz, xy - yx};
    sizes_ = {std::abs(yz) + std::abs(zy), std::abs(zx) + std::abs(xz), std::abs(xy) + std::abs(yx)};
  }

  /// What orient3d(a, b, c, d) is.
  int of(const Vec3& d) const {
    LIMBER_ASSERT(is_finite(d));
    const Vec3 r = d - a_;
    const double det = r.x * minors_.x + r.y * minors_.y + r.z * minors_.z;
    const double permanent = std::abs(r.x) * sizes_.x + std::abs(r.y) * sizes_.y + std::abs(r.z) * sizes_.z;
    const bool is_certain = std::abs(det) > volume_bound * permanent + underflow_bound && max_abs(r) < largest_filtered;
    if (is_certain && std::isfinite(permanent)) [[likely]]
      return det > 0 ? 1 : -1;
    // Equal points are what fails the filter most often, in meshes that lie on each other.
    if (d == a_ || d == b_ || d == c_ || a_ == b_ || b_ == c_ || c_ == a_) return 0;
    return exact_volume_sign(a_, b_, c_, d);
  }

 private:
  static constexpr double epsilon = 0x1p-53;
  static constexpr double volume_bound = (7 + 56 * epsilon) * epsilon;
  // An underflowing product is off by at most 2^-1074; with factors below 2^300 that grows to 2^-770 in a triple
  // product.
  static constexpr double largest_filtered = 0x1p300;
  static constexpr double underflow_bound = 0x1p-760;

  const Vec3 &a_, &b_, &c_;
  Vec3 minors_, sizes_;  // of the plane's normal; sums of the sizes of what they are differences of
};

}  // namespace limber::geometry

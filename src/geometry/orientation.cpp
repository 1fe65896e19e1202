// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Signs of determinants. orient3d(a, b, c, d) is the sign of det(b - a, c - a, d - a), orient2d(a, b, c) that of
// det(b - a, c - a) in a plane of two axes. They are found in three steps, each for what the one before leaves open:
//
// 1. A filter: float64 with an error bound. That of orient3d() is in geometry/plane_sides.h.
// 2. Expansions: sums of doubles without rounding, of coordinates scaled by a power of two.
// 3. Integers of a fixed size, where coordinates differ so much in size that a product could leave the range of double.
//
// Based on  [Shewchuk1997]: the error bound of the first stage of orient2d(), (3 + 16 e) e; and a number as a sum of
//           non-overlapping doubles, added and multiplied without error. [Dekker1971]: exact products of two doubles.
// Differs   No adaptive stages in between: whoever comes to 2 already failed the filter, and zero terms are dropped, so
//           the integer-like inputs that fail it most often have short sums. No input leaves the sign inexact, and none
//           allocates.
#include "geometry/plane_sides.h"

#include <algorithm>
#include <array>
#include <bit>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "base/check.h"
#include "base/error_free.h"
#include "geometry/integers.h"
#include "geometry/primitives.h"

namespace limber::geometry {
namespace {

constexpr double epsilon = 0x1p-53;
constexpr double area_bound = (3 + 16 * epsilon) * epsilon;
constexpr double underflow_bound = 0x1p-760;  // as that of volumes; of an area 2^-1073 would be enough

/// A number as the sum of at most `capacity` non-overlapping doubles in increasing magnitude; none of them is zero.
template <std::size_t capacity>
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const base::DoublePair s = base::two_sum(value, terms_[i]);
      value = s.high;
      if (s.low != 0) terms_[kept++] = s.low;
    }
    if (value != 0) {
      LIMBER_ASSERT(kept < capacity);
      terms_[kept++] = value;
    }
    size_ = kept;
  }

  /// Adds a b, or with a sign of -1 its negative.
  template <std::size_t capacity_of_a, std::size_t capacity_of_b>
  void add_product(const Expansion<capacity_of_a>& a, const Expansion<capacity_of_b>& b, double with_sign = 1) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        const base::DoublePair p = base::two_product(a[i], b[j]);
        if (p.low != 0) add(with_sign * p.low);
        add(with_sign * p.high);
      }
    }
  }

  std::size_t size() const { return size_; }
  double operator[](std::size_t i) const { return terms_[i]; }
  int sign() const { return size_ == 0 ? 0 : terms_[size_ - 1] > 0 ? 1 : -1; }

 private:
  std::array<double, capacity> terms_;
  std::size_t size_ = 0;
};

/// a - b.
Expansion<2> difference(double a, double b) {
  Expansion<2> e;
  const base::DoublePair d = base::two_sum(a, -b);
  if (d.low != 0) e.add(d.low);
  e.add(d.high);
  return e;
}

using VectorOfExpansions = std::array<Expansion<2>, 3>;

/// p_i q_j - p_j q_i. Each of the two products of two terms by two has 8 terms at most.
Expansion<16> minor(const VectorOfExpansions& p, const VectorOfExpansions& q, std::size_t i, std::size_t j) {
  Expansion<16> m;
  m.add_product(p[i], q[j]);
  m.add_product(p[j], q[i], -1);
  return m;
}

/// How many binades the sizes of coordinates may span so that expansions of them are exact. Coordinates are scaled so
/// that the largest is in [1/2, 1), or up to 4 where that would take a subnormal scale. So the last bit of the smallest
/// is at 2^-323 or above, and that of a product of three above the smallest subnormal, 2^-1074. 305 binades would do;
/// 270 is a choice, as hardly any input spans more.
constexpr int most_binades = 270;

/// A power of two that makes expansions of scaled coordinates exact; 0 where there is none.
double scale_for_expansions(std::initializer_list<double> coordinates) {
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const double x : coordinates) {
    if (x == 0) continue;
    // A subnormal counts as 2^-1023: its last bit, 2^-1074, is above those of a number of that size.
    const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff) - 1023;
    lowest = std::min(lowest, exponent), highest = std::max(highest, exponent);
  }
  if (highest < lowest) return 1;
  if (highest - lowest > most_binades) return 0;
  return std::ldexp(1, std::max(-1 - highest, -1022));
}

// A coordinate is below 2^1024, and a multiple of 2^-1074, so it becomes an integer of 2098 bits at most. A determinant
// of three differences, six products, has 3 * 2099 + 3 = 6300 bits; two limbs are room. Only the limbs in use are
// worked on.
constexpr unsigned bits_of_integers = 6464;
using FixedInteger = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<bits_of_integers, bits_of_integers, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked, void>,
    boost::multiprecision::et_off>;

/// a - b as a multiple of 2^unit. Pre: both are multiples of it.
FixedInteger difference(double a, double b, int unit) {
  return base::Decoded(a).in<FixedInteger>(unit) - base::Decoded(b).in<FixedInteger>(unit);
}

/// Sign of (bx - ax) (cy - ay) - (by - ay) (cx - ax).
int exact_area_sign(double ax, double ay, double bx, double by, double cx, double cy) {
  const double scale = scale_for_expansions({ax, ay, bx, by, cx, cy});
  if (scale == 0) {
    const int unit = CommonUnit().include(Vec3{ax, ay, bx}).include(Vec3{by, cx, cy}).exponent();
    const auto between = [unit](double to, double from) { return difference(to, from, unit); };
    const FixedInteger det = between(bx, ax) * between(cy, ay) - between(by, ay) * between(cx, ax);
    return det.sign();
  }
  Expansion<16> det;
  const auto between = [scale](double to, double from) { return difference(scale * to, scale * from); };
  det.add_product(between(bx, ax), between(cy, ay));
  det.add_product(between(by, ay), between(cx, ax), -1);
  return det.sign();
}

}  // namespace

int exact_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double scale = scale_for_expansions({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z});
  if (scale == 0) {
    const int unit = CommonUnit().include(a).include(b).include(c).include(d).exponent();
    const auto minus_a = [&](const Vec3& v) {
      return std::array{difference(v.x, a.x, unit), difference(v.y, a.y, unit), difference(v.z, a.z, unit)};
    };
    const auto p = minus_a(b), q = minus_a(c), r = minus_a(d);
    const FixedInteger det =
        r[0] * (p[1] * q[2] - p[2] * q[1]) + r[1] * (p[2] * q[0] - p[0] * q[2]) + r[2] * (p[0] * q[1] - p[1] * q[0]);
    return det.sign();
  }
  const auto minus_a = [&](const Vec3& v) {
    return VectorOfExpansions{difference(scale * v.x, scale * a.x), difference(scale * v.y, scale * a.y),
                              difference(scale * v.z, scale * a.z)};
  };
  const auto p = minus_a(b), q = minus_a(c), r = minus_a(d);
  Expansion<192> det;  // three products of 16 terms by two, each of two doubles
  det.add_product(minor(p, q, 1, 2), r[0]);
  det.add_product(minor(p, q, 2, 0), r[1]);
  det.add_product(minor(p, q, 0, 1), r[2]);
  return det.sign();
}

int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) { return PlaneSides(a, b, c).of(d); }

int orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  LIMBER_ASSERT(axis < 3);
  LIMBER_ASSERT(is_finite(a) && is_finite(b) && is_finite(c));
  const std::size_t i = (axis + 1) % 3, j = (axis + 2) % 3;
  const double left = (b[i] - a[i]) * (c[j] - a[j]);
  const double right = (b[j] - a[j]) * (c[i] - a[i]);
  const double det = left - right;
  const double permanent = std::abs(left) + std::abs(right);
  const bool certain = std::abs(det) > area_bound * permanent + underflow_bound;
  if (certain && std::isfinite(permanent)) return det > 0 ? 1 : -1;
  const auto are_equal = [i, j](const Vec3& p, const Vec3& q) { return p[i] == q[i] && p[j] == q[j]; };
  if (are_equal(a, b) || are_equal(b, c) || are_equal(c, a)) return 0;
  return exact_area_sign(a[i], a[j], b[i], b[j], c[i], c[j]);
}

}  // namespace limber::geometry

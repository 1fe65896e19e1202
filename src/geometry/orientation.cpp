// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The filter of orient2d(), and the exact signs that it and that of orient3d() (geometry/plane_sides.h) fall back on.
//
// Based on  [Shewchuk1997]: the error bound of the first stage of orient2d(), (3 + 16 e) e; and a number as a sum of
//           non-overlapping doubles, added and multiplied without error. [Dekker1971]: the exact product of two doubles.
// Differs   No adaptive stages in between: whoever comes here already failed the filter, and zero terms are dropped, so
//           the integer-like inputs that fail it most often have short sums. Coordinates are scaled by a power of two
//           first; where they differ so much in size that a product could still leave the range of double, integers of
//           a fixed size decide, so there is no input for which the sign is not exact, and none that allocates.
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
#include "geometry/primitives.h"

namespace limber::geometry {
namespace {

constexpr double epsilon = 0x1p-53;
constexpr double area_bound = (3 + 16 * epsilon) * epsilon;
constexpr double underflow_bound = 0x1p-760;  // as that of volumes

int sign(double x) { return x > 0 ? 1 : -1; }

using base::DoublePair;

/// A sum of at most `capacity` non-overlapping doubles in increasing magnitude; none of them is zero.
template <std::size_t capacity>
class Expansion {
 public:
  void add(double value) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const DoublePair s = base::two_sum(value, terms_[i]);
      value = s.high;
      if (s.low != 0) terms_[kept++] = s.low;
    }
    if (value != 0) {
      LIMBER_ASSERT(kept < capacity);
      terms_[kept++] = value;
    }
    size_ = kept;
  }

  template <std::size_t other>
  void add(const Expansion<other>& e, double sign = 1) {
    for (std::size_t i = 0; i < e.size(); ++i) add(sign * e[i]);
  }

  template <std::size_t left, std::size_t right>
  void add_product(const Expansion<left>& a, const Expansion<right>& b, double sign = 1) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for (std::size_t j = 0; j < b.size(); ++j) {
        const DoublePair p = base::two_product(a[i], b[j]);
        if (p.low != 0) add(sign * p.low);
        add(sign * p.high);
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

Expansion<2> difference(double a, double b) {
  Expansion<2> e;
  const DoublePair d = base::two_sum(a, -b);
  if (d.low != 0) e.add(d.low);
  e.add(d.high);
  return e;
}

template <std::size_t terms>
Expansion<16> minor(const std::array<Expansion<terms>, 3>& p, const std::array<Expansion<terms>, 3>& q, std::size_t i,
                    std::size_t j) {
  Expansion<16> m;
  m.add_product(p[i], q[j]);
  m.add_product(p[j], q[i], -1);
  return m;
}

/// A power of two that makes expansions of scaled coordinates exact; 0 where there is none.
///
/// With coordinates of at most 1 and none but 0 below 2^-280, every product of three differences is a sum of doubles
/// whose last bit (2^-52 of the smallest coordinate, cubed) is above the smallest subnormal, 2^-1074.
double scale_for_expansions(std::initializer_list<double> coordinates) {
  int lowest = std::numeric_limits<int>::max(), highest = std::numeric_limits<int>::min();
  for (const double x : coordinates) {
    if (x == 0) continue;
    // Subnormal numbers count as 2^-1023: their last bit is that of the smallest normal ones.
    const int exponent = static_cast<int>(std::bit_cast<std::uint64_t>(x) >> 52 & 0x7ff) - 1023;
    lowest = std::min(lowest, exponent), highest = std::max(highest, exponent);
  }
  if (highest < lowest) return 1;
  if (highest - lowest > 270) return 0;
  return std::ldexp(1, std::clamp(-1 - highest, -1022, 1023));
}

// A coordinate becomes an integer of 53 bits, shifted left by as much as its exponent exceeds the smallest: by at most
// 1024 + 1073, which makes 2150 bits. A determinant of three differences has 3 * 2151 + 3. Of that size only the limbs
// in use are worked on.
constexpr unsigned bits_of_integers = 6464;
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<bits_of_integers, bits_of_integers, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked, void>,
    boost::multiprecision::et_off>;

/// Doubles as integers, all multiplied by one power of two that makes them whole.
class Integers {
 public:
  Integers(std::initializer_list<double> values) {
    for (const double value : values) lowest_ = std::min(lowest_, base::Decoded(value).exponent);
  }
  Integer operator()(double value) const { return base::Decoded(value).in<Integer>(lowest_); }

 private:
  int lowest_ = std::numeric_limits<int>::max();
};

}  // namespace

int exact_volume_sign(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const double scale = scale_for_expansions({a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z});
  if (scale == 0) {
    const Integers whole{a.x, a.y, a.z, b.x, b.y, b.z, c.x, c.y, c.z, d.x, d.y, d.z};
    const auto minus_a = [&](const Vec3& v) {
      return std::array<Integer, 3>{whole(v.x) - whole(a.x), whole(v.y) - whole(a.y), whole(v.z) - whole(a.z)};
    };
    const auto p = minus_a(b), q = minus_a(c), r = minus_a(d);
    const Integer det =
        r[0] * (p[1] * q[2] - p[2] * q[1]) + r[1] * (p[2] * q[0] - p[0] * q[2]) + r[2] * (p[0] * q[1] - p[1] * q[0]);
    return det.sign();
  }
  const auto minus_a = [&](const Vec3& v) {
    return std::array<Expansion<2>, 3>{difference(scale * v.x, scale * a.x), difference(scale * v.y, scale * a.y),
                                       difference(scale * v.z, scale * a.z)};
  };
  const auto p = minus_a(b), q = minus_a(c), r = minus_a(d);
  Expansion<192> det;
  det.add_product(minor(p, q, 1, 2), r[0]);
  det.add_product(minor(p, q, 2, 0), r[1]);
  det.add_product(minor(p, q, 0, 1), r[2]);
  return det.sign();
}

int exact_area_sign(double ax, double ay, double bx, double by, double cx, double cy) {
  const double scale = scale_for_expansions({ax, ay, bx, by, cx, cy});
  if (scale == 0) {
    const Integers whole{ax, ay, bx, by, cx, cy};
    const Integer det =
        (whole(bx) - whole(ax)) * (whole(cy) - whole(ay)) - (whole(by) - whole(ay)) * (whole(cx) - whole(ax));
    return det.sign();
  }
  Expansion<16> det;
  const auto between = [scale](double to, double from) { return difference(scale * to, scale * from); };
  det.add_product(between(bx, ax), between(cy, ay));
  det.add_product(between(by, ay), between(cx, ax), -1);
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
  if (certain && std::isfinite(permanent)) return sign(det);
  const auto are_equal = [i, j](const Vec3& p, const Vec3& q) { return p[i] == q[i] && p[j] == q[j]; };
  if (are_equal(a, b) || are_equal(b, c) || are_equal(c, a)) return 0;
  return exact_area_sign(a[i], a[j], b[i], b[j], c[i], c[j]);
}

}  // namespace limber::geometry

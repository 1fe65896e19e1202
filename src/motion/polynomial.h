// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include <boost/multiprecision/cpp_int.hpp>

/// Polynomials in time with integer coefficients: how many roots lie in an interval, and signs, all exact.
namespace limber::motion {

/// Up to 512 bits are stored in place; more are allocated. Coordinates of 60 bits make a determinant of 190, and some
/// 350 where that is multiplied by times.
using Integer = boost::multiprecision::number<
    boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                           boost::multiprecision::unchecked>,
    boost::multiprecision::et_off>;

/// A time n / 2^shift.
struct DyadicTime {
  Integer n;
  unsigned shift;

  /// n, if the time is written with a larger shift.
  Integer n_at(unsigned larger) const { return n << (larger - shift); }
  friend bool operator<(const DyadicTime& a, const DyadicTime& b) {
    const unsigned larger = std::max(a.shift, b.shift);
    return a.n_at(larger) < b.n_at(larger);
  }
};

/// The times after `low` up to `high`.
struct Interval {
  DyadicTime low, high;

  DyadicTime middle() const {
    const unsigned shift = std::max(low.shift, high.shift);
    return {low.n_at(shift) + high.n_at(shift), shift + 1};
  }
};

/// A polynomial of degree `most` or less, by its coefficients.
template <std::size_t most>
struct Polynomial {
  std::array<Integer, most + 1> c{};

  bool is_zero() const {
    return std::all_of(c.begin(), c.end(), [](const Integer& x) { return x.is_zero(); });
  }

  int sign_at(const DyadicTime& t) const {
    Integer sum = c[most];
    for (std::size_t k = most; k-- > 0;) sum = sum * t.n + (c[k] << (t.shift * static_cast<unsigned>(most - k)));
    return sum.sign();
  }

  friend Polynomial operator+(const Polynomial& p, const Polynomial& q) {
    Polynomial sum;
    for (std::size_t k = 0; k <= most; ++k) sum.c[k] = p.c[k] + q.c[k];
    return sum;
  }
  friend Polynomial operator-(const Polynomial& p, const Polynomial& q) {
    Polynomial difference;
    for (std::size_t k = 0; k <= most; ++k) difference.c[k] = p.c[k] - q.c[k];
    return difference;
  }
};

using Linear = Polynomial<1>;
using Quadratic = Polynomial<2>;
using Cubic = Polynomial<3>;

template <std::size_t m, std::size_t n>
Polynomial<m + n> operator*(const Polynomial<m>& p, const Polynomial<n>& q) {
  Polynomial<m + n> product;
  for (std::size_t i = 0; i <= m; ++i) {
    for (std::size_t k = 0; k <= n; ++k) product.c[i + k] += p.c[i] * q.c[k];
  }
  return product;
}

template <std::size_t most>
Cubic as_cubic(const Polynomial<most>& p) {
  Cubic cubic;
  std::copy(p.c.begin(), p.c.end(), cubic.c.begin());
  return cubic;
}

/// The sign of a polynomial in the interior of an interval, or 0 if its Bernstein form cannot tell.
int sign_within(const Quadratic& p, const Interval& interval);

/// At least the number of roots in an interval, with their multiplicities, but that of its end counts once; exact if it
/// is 0 or 1.
int most_roots(const Cubic& p, const Interval& interval);

/// A greatest common divisor: it has the common roots of both. Pre: neither is zero.
Cubic common_divisor(Cubic p, Cubic q);
/// A polynomial with the roots of p, each of them once. Pre: p is not zero.
Cubic squarefree(const Cubic& p);

/// The Sturm sequence of a polynomial. [BasuPollackRoy2006]
class SturmSequence {
 public:
  /// Pre: p is not zero, and none of its multiple roots is an end of an interval that count() is asked for.
  explicit SturmSequence(const Cubic& p);

  /// The number of different roots in an interval.
  int count(const Interval& i) const { return changes_at(i.low) - changes_at(i.high); }

 private:
  int changes_at(const DyadicTime& t) const;

  std::array<Cubic, 4> sequence_;
  std::size_t length_ = 0;
};

}  // namespace limber::motion

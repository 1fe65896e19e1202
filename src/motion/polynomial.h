// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "geometry/integers.h"

/// Polynomials in time with integer coefficients: how many roots lie in an interval, and signs, all exact.
namespace limber::motion {

/// Coordinates that are multiples of one unit, up to 2^60 of it, make a determinant of 190 bits, and of 350 where that
/// is multiplied by times of 53 bits. Remainders are longer.
using geometry::Integer;

/// A time n / 2^shift.
struct DyadicTime {
  Integer n;
  unsigned shift;

  /// The numerator over 2^larger. Pre: larger >= shift.
  Integer n_at(unsigned larger) const { return n << (larger - shift); }
  friend bool operator<(const DyadicTime& a, const DyadicTime& b) {
    const unsigned larger = std::max(a.shift, b.shift);
    return a.n_at(larger) < b.n_at(larger);
  }
};

/// The times after `low` up to `high`: (low, high].
struct Interval {
  DyadicTime low, high;

  DyadicTime middle() const {
    const unsigned shift = std::max(low.shift, high.shift);
    return {low.n_at(shift) + high.n_at(shift), shift + 1};
  }
};

/// A polynomial of degree `max_degree` or less, by its coefficients.
template <std::size_t max_degree>
struct Polynomial {
  std::array<Integer, max_degree + 1> c{};

  bool is_zero() const {
    return std::all_of(c.begin(), c.end(), [](const Integer& x) { return x.is_zero(); });
  }

  int sign_at(const DyadicTime& t) const {
    // Horner's scheme, times 2^(shift * max_degree).
    Integer sum = c[max_degree];
    for (std::size_t k = max_degree; k-- > 0;)
      sum = sum * t.n + (c[k] << (t.shift * static_cast<unsigned>(max_degree - k)));
    return sum.sign();
  }

  friend Polynomial operator+(const Polynomial& p, const Polynomial& q) {
    Polynomial sum;
    for (std::size_t k = 0; k <= max_degree; ++k) sum.c[k] = p.c[k] + q.c[k];
    return sum;
  }
  friend Polynomial operator-(const Polynomial& p, const Polynomial& q) {
    Polynomial difference;
    for (std::size_t k = 0; k <= max_degree; ++k) difference.c[k] = p.c[k] - q.c[k];
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

template <std::size_t max_degree>
Cubic as_cubic(const Polynomial<max_degree>& p) {
  Cubic cubic;
  std::copy(p.c.begin(), p.c.end(), cubic.c.begin());
  return cubic;
}

/// The sign of a polynomial in the interior of an interval; 0 if its Bernstein form cannot tell, or if it is zero.
int sign_within(const Quadratic& p, const Interval& interval);

/// An upper bound of the number of roots in an interval, by Descartes' rule. Roots inside count with multiplicity, a
/// root at its end once. 0 and 1 are exact.
int descartes_bound(const Cubic& p, const Interval& interval);

/// A greatest common divisor: it has the common roots of both. Pre: p or q is not zero.
Cubic common_divisor(Cubic p, Cubic q);
/// A polynomial with the roots of p, each of them once. Pre: p is not zero.
Cubic squarefree(const Cubic& p);

/// The Sturm sequence of a polynomial. [BasuPollackRoy2006]
class SturmSequence {
 public:
  /// Pre: p is not zero and has no multiple roots.
  explicit SturmSequence(const Cubic& p);

  /// The number of roots in an interval.
  int count(const Interval& interval) const { return changes_at(interval.low) - changes_at(interval.high); }

 private:
  int changes_at(const DyadicTime& t) const;

  std::array<Cubic, 4> sequence_;
  std::size_t length_ = 0;
};

}  // namespace limber::motion

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Coordinates become integers, so that everything below is a polynomial in time with integer coefficients. The
// Minkowski difference of the elements is a polygon whose corners move linearly, and they touch where it contains the
// origin: for a vertex and a face the triangle of the corners less the vertex, for two edges the parallelogram of the
// differences of their ends.
//
// The origin is in the polygon's plane at the roots of one cubic, so the first of them at which the polygon contains it
// is the answer. If the cubic vanishes at all times, the origin enters the polygon at the start, or through an edge, at
// a root of a quadratic; or if that vanishes too, at a corner.
#include "motion/element_impact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

#include "base/error_free.h"
#include "geometry/primitives.h"
#include "motion/polynomial.h"

namespace limber::motion {
namespace {

using base::Decoded;

DyadicTime dyadic(double t) {
  const Decoded d(t);
  const int unit = std::min(d.exponent, 0);
  return {d.in<Integer>(unit), static_cast<unsigned>(-unit)};
}

// Times are rounded to multiples of 2^-53.
constexpr unsigned time_bits = 53;

/// In multiples of 2^-53. Pre: 0 <= t <= 1.
std::int64_t rounded_down(const DyadicTime& t) {
  return static_cast<std::int64_t>(t.shift > time_bits ? Integer(t.n >> (t.shift - time_bits))
                                                       : Integer(t.n << (time_bits - t.shift)));
}
std::int64_t rounded_up(const DyadicTime& t) {
  const std::int64_t down = rounded_down(t);
  const bool is_exact = t.shift <= time_bits || (t.n & ((Integer(1) << (t.shift - time_bits)) - 1)) == 0;
  return is_exact ? down : down + 1;
}
double as_time(std::int64_t multiple) {
  return std::ldexp(static_cast<double>(multiple), -static_cast<int>(time_bits));
}

/// A root of a polynomial, and an interval in which there is no other. It is simple, or it is the end of the interval.
/// Refers to the polynomial.
class IsolatedRoot {
 public:
  IsolatedRoot(const Cubic& f, const Interval& interval)
      : f_(f), interval_(interval), sign_at_end_(f.sign_at(interval.high)) {}

  bool is_after(const DyadicTime& t) const {
    if (!(t < interval_.high)) return false;
    if (!(interval_.low < t)) return true;
    return is_end() || f_.sign_at(t) * sign_at_end_ < 0;
  }

  /// The sign of another polynomial at the root.
  int sign_of(const Quadratic& g) {
    if (const int sign = sign_here(g); sign != 0 || is_end() || g.is_zero()) return sign;
    // f has one root in the interval, so a common divisor has that one or none. If it has none, g is not 0 at the root,
    // so halving makes the signs agree.
    if (SturmSequence(squarefree(common_divisor(f_, as_cubic(g)))).count(interval_) > 0) return 0;
    for (;;) {
      split_at(interval_.middle());
      if (const int sign = sign_here(g); sign != 0 || is_end()) return sign;
    }
  }

  /// Narrows the interval to two neighboring multiples of 2^-53, or to the root if it is one. Stops early once its ends
  /// are at most `time_error` apart. Splits at a guess in float64, then beside it, by 1, 16, 256 ... on the side of the
  /// root; at last halves.
  void narrow(double time_error) {
    const auto most = static_cast<std::int64_t>(std::max(std::ldexp(std::min(time_error, 1.0), time_bits), 1.0));
    for (std::int64_t reach = 1;;) {
      const std::int64_t low = rounded_down(interval_.low), high = rounded_up(interval_.high);
      if (is_end() || high - low <= most) return;
      const bool is_near = reach < high - low;
      const std::int64_t at = is_near ? std::clamp(guess(low, high), low + 1, high - 1) : low + (high - low) / 2;
      split_at({at, time_bits});
      if (!is_near) continue;
      split_at({rounded_up(interval_.high) > at ? at + reach : at - reach, time_bits});
      reach *= 16;
    }
  }

  /// The root as time_of_impact() gives it.
  ElementImpact as_impact(double time_error) {
    narrow(time_error);
    const DyadicTime& earliest = is_end() ? interval_.high : interval_.low;
    return {ImpactStatus::contact, as_time(rounded_down(earliest)), as_time(rounded_up(interval_.high))};
  }

 private:
  /// Whether the root is the end of the interval; otherwise it is in the interior.
  bool is_end() const { return sign_at_end_ == 0; }

  /// The sign of another polynomial at the root, or 0 if the interval is too long to tell.
  int sign_here(const Quadratic& g) const { return is_end() ? g.sign_at(interval_.high) : sign_within(g, interval_); }

  /// Makes t an end of the interval, if it is inside.
  void split_at(const DyadicTime& t) {
    if (is_end() || !(interval_.low < t && t < interval_.high)) return;
    const int sign = f_.sign_at(t);
    if (sign * sign_at_end_ < 0) {
      interval_.low = t;
    } else {
      interval_.high = t, sign_at_end_ = sign;
    }
  }

  /// About where the root is between two times, all in multiples of 2^-53: by false position, the Illinois algorithm.
  std::int64_t guess(std::int64_t from, std::int64_t to) const {
    unsigned bits = 0;
    for (const Integer& x : f_.c) bits = std::max(bits, x.is_zero() ? 0U : static_cast<unsigned>(msb(abs(x))));
    const unsigned dropped = bits > 1000 ? bits - 1000 : 0;  // doubles end at 2^1024
    double c[4];
    for (std::size_t k = 0; k < 4; ++k) c[k] = static_cast<double>(Integer(f_.c[k] >> dropped));
    const auto f = [&](double t) { return c[0] + t * (c[1] + t * (c[2] + t * c[3])); };
    double low = as_time(from), high = as_time(to), at_low = f(low), at_high = f(high), t = low;
    for (int i = 0; i < 30 && at_low * at_high < 0; ++i) {
      t = high - at_high * (high - low) / (at_high - at_low);
      const double value = f(t);
      if (value == 0) break;
      if (value * at_high < 0) {
        low = high, at_low = at_high;
      } else {
        at_low *= 0.5;
      }
      high = t, at_high = value;
    }
    return std::llround(std::ldexp(t, time_bits));
  }

  const Cubic& f_;
  Interval interval_;
  int sign_at_end_;
};

using Vector = std::array<Linear, 3>;
Vector operator-(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

/// The corners of the polygon that contains the origin when the elements touch, in cyclic order, and the polynomials
/// that say when.
class OriginInPolygon {
 public:
  explicit OriginInPolygon(const MovingElements& elements) {
    Vector v[4];
    geometry::CommonUnit common(std::numeric_limits<int>::max());
    for (const auto& corners : elements.corners) {
      for (const Vec3& p : corners) common.include(p);
    }
    const int unit = common.exponent();
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto at = [&](std::size_t end) { return Decoded(elements.corners[end][i][axis]).in<Integer>(unit); };
        const Integer start = at(0);
        v[i][axis] = {{start, at(1) - start}};
      }
    }
    if (elements.kind == MovingElements::Kind::vertex_face) {
      size_ = 3;
      for (std::size_t i = 0; i < 3; ++i) corner_[i] = v[i + 1] - v[0];
    } else {
      size_ = 4;
      corner_[0] = v[0] - v[2], corner_[1] = v[1] - v[2], corner_[2] = v[1] - v[3], corner_[3] = v[0] - v[3];
    }
  }

  /// 0 where the origin is in the plane of the polygon. Three corners are in that plane, a parallelogram's fourth too.
  Cubic coplanarity() const {
    const Vector &a = corner_[0], &b = corner_[1], &c = corner_[size_ - 1];
    return a[0] * across(b, c, 0) + a[1] * across(b, c, 1) + a[2] * across(b, c, 2);
  }

  /// Whether the polygon contains the origin at a time at which both are in one plane. `sign_of` gives the sign of a
  /// polynomial at that time.
  template <typename SignOf>
  bool contains_origin(const SignOf& sign_of) const {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Vector &a = corner_[0], &b = corner_[1], &c = corner_[size_ - 1];
      const int side = sign_of(across(b - a, c - a, axis));
      if (side == 0) continue;
      for (std::size_t i = 0; i < size_; ++i) {
        if (sign_of(across(corner_[i], corner_[next(i)], axis)) * side < 0) return false;
      }
      return true;
    }
    // The polygon is a segment or a point.
    for (std::size_t i = 0; i < size_; ++i) {
      const Vector &a = corner_[i], &b = corner_[next(i)];
      bool is_on_line = true;
      for (std::size_t axis = 0; axis < 3 && is_on_line; ++axis) is_on_line = sign_of(across(a, b, axis)) == 0;
      if (is_on_line && sign_of(a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) <= 0) return true;
    }
    return false;
  }

  /// For a polygon that is always in one plane with the origin: calls visit() with polynomials such that the origin
  /// enters the polygon, if not at the start, at a root of one of them.
  template <typename Visit>
  void for_each_entry(const Visit& visit) const {
    for (std::size_t i = 0; i < size_; ++i) {
      const Vector &a = corner_[i], &b = corner_[next(i)];
      const std::array<Quadratic, 3> cross = {across(a, b, 0), across(a, b, 1), across(a, b, 2)};
      if (!visit_first(cross, visit)) {
        visit_first(a, visit), visit_first(b, visit);
      }
    }
  }

 private:
  /// A coordinate of the cross product.
  static Quadratic across(const Vector& a, const Vector& b, std::size_t axis) {
    const std::size_t i = (axis + 1) % 3, k = (axis + 2) % 3;
    return a[i] * b[k] - a[k] * b[i];
  }

  std::size_t next(std::size_t i) const { return i + 1 == size_ ? 0 : i + 1; }

  /// Visits the first polynomial that is not zero. False if there is none.
  template <std::size_t max_degree, typename Visit>
  static bool visit_first(const std::array<Polynomial<max_degree>, 3>& polynomials, const Visit& visit) {
    for (const Polynomial<max_degree>& p : polynomials) {
      if (p.is_zero()) continue;
      visit(as_cubic(p));
      return true;
    }
    return false;
  }

  std::size_t size_;
  Vector corner_[4];
};

/// Whether the elements touch at the start. A vertex is a segment whose ends are equal, an edge a triangle with two
/// equal corners: intersects() takes both.
bool touch_at_start(const MovingElements& e) {
  const auto& [a, b, c, d] = e.corners[0];
  if (e.kind == MovingElements::Kind::vertex_face) return geometry::intersects(Segment{a, a}, Triangle{b, c, d});
  return geometry::intersects(Segment{a, b}, Triangle{c, d, d});
}

/// Calls visit() with the roots of p in an interval, in order. Stops when visit() returns false, and then returns
/// false. Pre: p is not zero.
template <typename Visit>
bool visit_roots(const Cubic& p, const Interval& interval, int halvings, const Visit& visit) {
  const int at_most = descartes_bound(p, interval);
  if (at_most == 0) return true;
  if (at_most == 1) return visit(IsolatedRoot(p, interval));
  if (halvings > 0) {
    const DyadicTime middle = interval.middle();
    return visit_roots(p, {interval.low, middle}, halvings - 1, visit) &&
           visit_roots(p, {middle, interval.high}, halvings - 1, visit);
  }
  // Roots that are very near each other, or the same.
  const Cubic f = squarefree(p);
  const SturmSequence sturm(f);
  Interval rest = interval;
  for (int count = sturm.count(rest); count > 0; --count) {
    Interval first = rest;
    for (int count_in_first = count; count_in_first > 1;) {
      const DyadicTime middle = first.middle();
      const int in_half = sturm.count({first.low, middle});
      (in_half > 0 ? first.high : first.low) = middle;
      if (in_half > 0) count_in_first = in_half;
    }
    if (!visit(IsolatedRoot(f, first))) return false;
    rest.low = first.high;
  }
  return true;
}

/// The first root of p after the start, up to max_time, at which the polygon contains the origin. Pre: p is not zero.
ElementImpact first_contact(const OriginInPolygon& polygon, const Cubic& p, const ElementImpactOptions& options) {
  constexpr int halvings = 16;  // most roots that are not equal are farther apart
  const DyadicTime max_time = dyadic(options.max_time);
  ElementImpact found;
  visit_roots(p, {{0, 0}, {1, 0}}, halvings, [&](IsolatedRoot root) {
    if (root.is_after(max_time)) return false;
    root.narrow(options.time_error);  // afterwards signs at the root are rarely undecided
    if (!polygon.contains_origin([&](const Quadratic& g) { return root.sign_of(g); })) return true;
    found = root.as_impact(options.time_error);
    return false;
  });
  return found;
}

}  // namespace

ElementImpact exact_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  if (touch_at_start(elements)) return {ImpactStatus::initial_contact, 0, 0};
  const OriginInPolygon polygon(elements);
  const Cubic coplanarity = polygon.coplanarity();
  if (!coplanarity.is_zero()) return first_contact(polygon, coplanarity, options);
  ElementImpact first;
  polygon.for_each_entry([&](const Cubic& p) {
    const ElementImpact found = first_contact(polygon, p, options);
    if (found.status == ImpactStatus::clear) return;
    first = {ImpactStatus::contact, std::min(first.lower, found.lower), std::min(first.upper, found.upper)};
  });
  return first;
}

void narrow_exactly(const MovingElements& elements, double time_error, double& lower, double& upper) {
  const Cubic coplanarity = OriginInPolygon(elements).coplanarity();
  IsolatedRoot root(coplanarity, {dyadic(lower), dyadic(upper)});
  const ElementImpact narrowed = root.as_impact(time_error);
  lower = narrowed.lower, upper = narrowed.upper;
}

}  // namespace limber::motion

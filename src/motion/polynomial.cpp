// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

#include "motion/polynomial.h"

#include <utility>

#include "base/check.h"

namespace limber::motion {
namespace {

/// -1 for the zero polynomial.
int degree(const Cubic& p) {
  int d = 3;
  while (d >= 0 && p.c[static_cast<std::size_t>(d)].is_zero()) --d;
  return d;
}

Integer& at(Cubic& p, int k) { return p.c[static_cast<std::size_t>(k)]; }
const Integer& at(const Cubic& p, int k) { return p.c[static_cast<std::size_t>(k)]; }

Cubic derivative(const Cubic& p) { return {{p.c[1], 2 * p.c[2], 3 * p.c[3], 0}}; }

/// A positive multiple of the remainder of p divided by q. Pre: q is not zero.
Cubic remainder(const Cubic& p, const Cubic& q) {
  const int dq = degree(q);
  LIMBER_ASSERT(dq >= 0);
  const Integer& lead = at(q, dq);
  const Integer size = abs(lead);
  Cubic rest = p;
  for (int d = degree(rest); d >= dq; d = degree(rest)) {
    // |lead| rest - sign(lead) r t^(d - dq) q, where r is the leading coefficient of rest: the term of degree d
    // cancels.
    const Integer factor = lead.sign() > 0 ? at(rest, d) : Integer(-at(rest, d));
    for (int k = 0; k <= d; ++k) at(rest, k) *= size;
    for (int k = 0; k <= dq; ++k) at(rest, d - dq + k) -= factor * at(q, k);
    LIMBER_ASSERT(degree(rest) < d);
  }
  return rest;
}

/// p / q. Pre: q divides p, and its coefficients have no common factor, so that the quotient has integer coefficients
/// (Gauss's lemma).
Cubic quotient(const Cubic& p, const Cubic& q) {
  const int dq = degree(q);
  Cubic rest = p, result;
  for (int d = degree(rest); d >= dq; d = degree(rest)) {
    const Integer factor = at(rest, d) / at(q, dq);
    at(result, d - dq) = factor;
    for (int k = 0; k <= dq; ++k) at(rest, d - dq + k) -= factor * at(q, k);
    LIMBER_ASSERT(degree(rest) < d);
  }
  LIMBER_ASSERT(rest.is_zero());
  return result;
}

/// Counts the changes of sign in a sequence; zeros do not count.
class SignChanges {
 public:
  void add(int sign) {
    if (sign != 0 && before_ != 0 && sign != before_) ++count_;
    if (sign != 0) before_ = sign;
  }
  int count() const { return count_; }

 private:
  int count_ = 0, before_ = 0;
};

}  // namespace

int sign_within(const Quadratic& p, const Interval& interval) {
  // The coefficients in Bernstein form: p(low), p(high), and between them the blossom at (low, high), here doubled. In
  // the interior the polynomial has their sign if none is opposite and not all are 0.
  const int first = p.sign_at(interval.low), last = p.sign_at(interval.high);
  if (first * last < 0) return 0;
  const unsigned shift = std::max(interval.low.shift, interval.high.shift);
  const Integer low = interval.low.n_at(shift), high = interval.high.n_at(shift);
  const Integer polar = (p.c[0] << (2 * shift + 1)) + ((p.c[1] * (low + high)) << shift) + 2 * p.c[2] * low * high;
  const int sign = first != 0 ? first : last != 0 ? last : polar.sign();
  return sign * polar.sign() >= 0 ? sign : 0;
}

int descartes_bound(const Cubic& p, const Interval& interval) {
  // In Bernstein form there are inside as many roots as changes of sign, or an even number less. A root at the end is
  // added. The inner coefficients are the blossom at (a, a, b), here three times as large.
  const unsigned shift = std::max(interval.low.shift, interval.high.shift);
  const Integer low = interval.low.n_at(shift), high = interval.high.n_at(shift);
  const auto inner = [&](const Integer& a, const Integer& b) {
    const Integer square = a * a, product = a * b;
    return Integer(((3 * p.c[0]) << (3 * shift)) + ((p.c[1] * (2 * a + b)) << (2 * shift)) +
                   ((p.c[2] * (square + 2 * product)) << shift) + 3 * p.c[3] * square * b);
  };
  const int at_end = p.sign_at(interval.high);
  SignChanges changes;
  for (const int sign : {p.sign_at(interval.low), inner(low, high).sign(), inner(high, low).sign(), at_end}) {
    changes.add(sign);
  }
  return changes.count() + (at_end == 0 ? 1 : 0);
}

Cubic common_divisor(Cubic p, Cubic q) {
  while (!q.is_zero()) p = std::exchange(q, remainder(p, q));
  // Makes the result primitive.
  Integer common = 0;
  for (const Integer& x : p.c) common = gcd(common, x);
  for (Integer& x : p.c) x /= common;
  return p;
}

Cubic squarefree(const Cubic& p) {
  if (degree(p) < 2) return p;
  const Cubic common = common_divisor(p, derivative(p));
  return degree(common) == 0 ? p : quotient(p, common);
}

SturmSequence::SturmSequence(const Cubic& p) {
  LIMBER_ASSERT(!p.is_zero());
  sequence_[length_++] = p;
  Cubic next = derivative(p);
  while (!next.is_zero()) {
    LIMBER_ASSERT(length_ < sequence_.size());
    sequence_[length_++] = next;
    next = Cubic() - remainder(sequence_[length_ - 2], sequence_[length_ - 1]);
  }
}

int SturmSequence::changes_at(const DyadicTime& t) const {
  SignChanges changes;
  for (std::size_t i = 0; i < length_; ++i) changes.add(sequence_[i].sign_at(t));
  return changes.count();
}

}  // namespace limber::motion

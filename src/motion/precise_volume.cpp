// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Double-double arithmetic [Dekker1971].
//
// Differences of corners are exact. A product of two numbers, and a sum, are off by 2^-102 of the size of their terms.
// A coefficient is a sum of up to 18 products of three coordinates. So the polynomial is off by less than 2^-90 of the
// product of the largest coordinates of u, v and w.
#include "motion/precise_volume.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace limber::motion {
namespace {

using base::DoublePair;

constexpr double precise_volume_error = 0x1p-90;

DoublePair quick_sum(double larger, double smaller) {
  const double sum = larger + smaller;
  return {sum, smaller - (sum - larger)};
}
DoublePair operator+(const DoublePair& x, const DoublePair& y) {
  const DoublePair high = base::two_sum(x.high, y.high), low = base::two_sum(x.low, y.low);
  const DoublePair sum = quick_sum(high.high, high.low + low.high);
  return quick_sum(sum.high, sum.low + low.low);
}
DoublePair operator-(const DoublePair& x) { return {-x.high, -x.low}; }
DoublePair operator*(const DoublePair& x, const DoublePair& y) {
  const DoublePair p = base::two_product(x.high, y.high);
  return quick_sum(p.high, p.low + (x.high * y.low + x.low * y.high));
}

struct PreciseVector {
  DoublePair x, y, z;
};
PreciseVector cross(const PreciseVector& a, const PreciseVector& b) {
  return {a.y * b.z + -(a.z * b.y), a.z * b.x + -(a.x * b.z), a.x * b.y + -(a.y * b.x)};
}
PreciseVector operator+(const PreciseVector& a, const PreciseVector& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
DoublePair dot(const PreciseVector& a, const PreciseVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

double largest(const PreciseVector& v) {
  return std::max({std::abs(v.x.high), std::abs(v.y.high), std::abs(v.z.high)});
}

/// The three vectors of MovingElements at one end of the motion, without error.
struct ExactVectors {
  PreciseVector u, v, w;

  ExactVectors(MovingElements::Kind kind, const Vec3 (&p)[4]) {
    const bool is_face = kind == MovingElements::Kind::vertex_face;
    u = is_face ? difference(p[2], p[1]) : difference(p[1], p[0]);
    v = is_face ? difference(p[3], p[1]) : difference(p[2], p[3]);
    w = is_face ? difference(p[0], p[1]) : difference(p[2], p[0]);
  }
  static PreciseVector difference(const Vec3& a, const Vec3& b) {
    return {base::two_sum(a.x, -b.x), base::two_sum(a.y, -b.y), base::two_sum(a.z, -b.z)};
  }
  double largest_of_all() const { return std::max({largest(u), largest(v), largest(w)}); }
  /// Brings vectors to another unit.
  void scale(double factor) {
    for (PreciseVector* vector : {&u, &v, &w}) {
      for (DoublePair* x : {&vector->x, &vector->y, &vector->z}) x->high *= factor, x->low *= factor;
    }
  }
};

}  // namespace

PreciseVolume::PreciseVolume(const MovingElements& elements) : coefficient_{}, error_(0) {
  ExactVectors start(elements.kind, elements.corners[0]), end(elements.kind, elements.corners[1]);
  // So that the largest coordinate is about 1; in two steps, because one factor may be out of range.
  const double most = std::max(start.largest_of_all(), end.largest_of_all());
  if (most == 0) return;
  const int exponent = std::ilogb(most), half = exponent / 2;
  for (const double factor : {std::ldexp(1.0, -half), std::ldexp(1.0, half - exponent)}) {
    start.scale(factor), end.scale(factor);
  }
  const PreciseVector at_start = cross(start.v, start.w), at_end = cross(end.v, end.w);
  const PreciseVector mixed = cross(start.v, end.w) + cross(end.v, start.w);
  coefficient_[0] = dot(start.u, at_start), coefficient_[1] = dot(end.u, at_start) + dot(start.u, mixed);
  coefficient_[2] = dot(start.u, at_end) + dot(end.u, mixed), coefficient_[3] = dot(end.u, at_end);
  error_ = precise_volume_error;
  error_ *= std::max(largest(start.u), largest(end.u));
  error_ *= std::max(largest(start.v), largest(end.v)) * std::max(largest(start.w), largest(end.w));
}

double PreciseVolume::at(double time) const {
  const DoublePair t{time, 0}, rest = base::two_sum(1, -time);
  const DoublePair low = coefficient_[0] * rest + coefficient_[1] * t;
  const DoublePair high = coefficient_[2] * rest + coefficient_[3] * t;
  const double value = (low * (rest * rest) + high * (t * t)).high;
  return std::abs(value) > error_ ? value : 0;
}

}  // namespace limber::motion

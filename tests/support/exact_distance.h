// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <initializer_list>
#include <optional>

#include "limber/geometry.h"

/// Distance of two triangles without rounding, some 50 us a pair: an oracle that
/// shares no code with the library.
///
/// Coordinates become integers by one power of two. The distance is 0 if an edge of one triangle passes through the
/// other; otherwise it is the least of the distances of pairs of corners, corners and inner points of edges, inner
/// points of edges, corners and inner points of faces, each a fraction of integers.
namespace limber::testing::exact {

using Integer = mpz_class;
using Fraction = mpq_class;

struct Vec {
  Integer x, y, z;
};
inline Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Integer dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec cross(const Vec& a, const Vec& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline bool is_zero(const Vec& v) { return v.x == 0 && v.y == 0 && v.z == 0; }

/// A double is this integer times 2^exponent.
struct Whole {
  std::int64_t mantissa;
  int exponent;

  explicit Whole(double value) {
    int e = 0;
    mantissa = static_cast<std::int64_t>(std::ldexp(std::frexp(value, &e), 53));
    exponent = e - 53;
    if (mantissa == 0) return;
    const int zeros = std::countr_zero(static_cast<std::uint64_t>(std::abs(mantissa)));
    mantissa >>= zeros, exponent += zeros;
  }
};

inline Integer shifted(const Whole& w, int lowest_exponent) {
  Integer result = static_cast<long>(w.mantissa);
  if (w.mantissa != 0) result <<= static_cast<unsigned>(w.exponent - lowest_exponent);
  return result;
}

using Corners3 = std::array<Vec, 3>;

/// Points as integers, all multiplied by one power of two that makes them whole.
class WholeCoordinates {
 public:
  WholeCoordinates(std::initializer_list<Vec3> points) {
    for (const Vec3& p : points) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const Whole w(p[axis]);
        if (w.mantissa != 0) lowest_ = std::min(lowest_, w.exponent);
      }
    }
  }
  Vec operator()(const Vec3& v) const {
    return {shifted(Whole(v.x), lowest_), shifted(Whole(v.y), lowest_), shifted(Whole(v.z), lowest_)};
  }
  Corners3 operator()(const Triangle& t) const { return {(*this)(t.v0), (*this)(t.v1), (*this)(t.v2)}; }
  int lowest_exponent() const { return lowest_; }

 private:
  int lowest_ = 2000;
};

/// The least of some fractions, compared by cross-multiplication.
struct Least {
  std::optional<std::pair<Integer, Integer>> best;  // numerator, denominator > 0
  void put(const Integer& numerator, const Integer& denominator) {
    if (!best || numerator * best->second < best->first * denominator) best = {numerator, denominator};
  }
};

/// Whether a closed segment passes through the plane of a triangle inside it. Segments in the plane do not count.
inline bool pierces(const Vec& p, const Vec& q, const Corners3& t, const Vec& normal) {
  const Integer height_p = dot(normal, p - t[0]), height_q = dot(normal, q - t[0]);
  if (sgn(height_p) == sgn(height_q)) return false;
  // The crossing, times `weight`.
  Integer weight = height_q - height_p;
  Vec crossing{p.x * height_q - q.x * height_p, p.y * height_q - q.y * height_p, p.z * height_q - q.z * height_p};
  if (weight < 0) weight = -weight, crossing = {-crossing.x, -crossing.y, -crossing.z};
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec &from = t[i], &to = t[(i + 1) % 3];
    const Vec off{crossing.x - from.x * weight, crossing.y - from.y * weight, crossing.z - from.z * weight};
    if (dot(normal, cross(to - from, off)) < 0) return false;
  }
  return true;
}

inline void put_corner_and_edge(Least& least, const Vec& p, const Vec& from, const Vec& to) {
  const Vec edge = to - from, off = p - from;
  const Integer length_sq = dot(edge, edge), along = dot(off, edge);
  if (along <= 0 || along >= length_sq) return;
  const Vec across = cross(off, edge);
  least.put(dot(across, across), length_sq);
}

inline void put_edges(Least& least, const Vec& p, const Vec& q, const Vec& r, const Vec& s) {
  const Vec d = q - p, e = s - r, between = r - p, normal = cross(d, e);
  if (is_zero(normal)) return;
  const Integer normal_sq = dot(normal, normal);
  const Integer at_d = dot(cross(between, e), normal), at_e = dot(cross(between, d), normal);
  if (at_d < 0 || at_d > normal_sq || at_e < 0 || at_e > normal_sq) return;
  const Integer height = dot(between, normal);
  least.put(height * height, normal_sq);
}

inline void put_corner_and_face(Least& least, const Vec& p, const Corners3& t, const Vec& normal) {
  for (std::size_t i = 0; i < 3; ++i) {
    if (dot(normal, cross(t[(i + 1) % 3] - t[i], p - t[i])) < 0) return;
  }
  const Integer height = dot(normal, p - t[0]);
  least.put(height * height, dot(normal, normal));
}

/// The squared distance.
inline Fraction squared_distance(const Triangle& a, const Triangle& b) {
  const WholeCoordinates whole({a.v0, a.v1, a.v2, b.v0, b.v1, b.v2});
  const int lowest = whole.lowest_exponent();
  const Corners3 s = whole(a), t = whole(b);
  const Vec normal_s = cross(s[1] - s[0], s[2] - s[0]), normal_t = cross(t[1] - t[0], t[2] - t[0]);
  const bool has_face_s = !is_zero(normal_s), has_face_t = !is_zero(normal_t);
  Least least;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec &p = s[i], &q = s[(i + 1) % 3], &r = t[i], &u = t[(i + 1) % 3];
    if (has_face_t && pierces(p, q, t, normal_t)) return 0;
    if (has_face_s && pierces(r, u, s, normal_s)) return 0;
    if (has_face_t) put_corner_and_face(least, p, t, normal_t);
    if (has_face_s) put_corner_and_face(least, r, s, normal_s);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      const Vec off = s[i] - t[j];
      least.put(dot(off, off), 1);
      put_corner_and_edge(least, s[i], t[j], t[(j + 1) % 3]);
      put_corner_and_edge(least, t[j], s[i], s[(i + 1) % 3]);
      put_edges(least, s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]);
    }
  }
  Fraction result(least.best->first, least.best->second);
  result.canonicalize();
  const auto shift = static_cast<unsigned long>(2 * std::abs(lowest));
  if (lowest < 0) {
    mpq_div_2exp(result.get_mpq_t(), result.get_mpq_t(), shift);
  } else {
    mpq_mul_2exp(result.get_mpq_t(), result.get_mpq_t(), shift);
  }
  return result;
}

/// Whether a number is at most `tolerance` above the root of `squared`.
inline bool is_at_most(double number, const Fraction& squared, double tolerance) {
  const Fraction lowered = Fraction(number) - Fraction(tolerance);
  return lowered <= 0 || lowered * lowered <= squared;
}
/// Whether it is at most `tolerance` below.
inline bool is_at_least(double number, const Fraction& squared, double tolerance) {
  const Fraction raised = Fraction(number) + Fraction(tolerance);
  return raised >= 0 && raised * raised >= squared;
}

}  // namespace limber::testing::exact

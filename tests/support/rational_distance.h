// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <optional>

#include "limber/geometry.h"

/// Squared distances in exact rational arithmetic, by another route than the library's: every face, edge and corner of
/// one triangle against every one of the other as affine spaces, keeping the minimisers that lie inside.
namespace limber::testing {

using Rational = mpq_class;
using RationalVec = std::array<Rational, 3>;

inline RationalVec rational(const Vec3& v) { return {Rational(v.x), Rational(v.y), Rational(v.z)}; }
inline RationalVec minus(const RationalVec& a, const RationalVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
inline Rational dot(const RationalVec& a, const RationalVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Solves the symmetric positive semi-definite system m x = r of size n <= 4; nothing when it is singular.
inline std::optional<std::array<Rational, 4>> solve(std::array<std::array<Rational, 4>, 4> m, std::array<Rational, 4> r,
                                                    std::size_t n) {
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    while (pivot < n && m[pivot][k] == 0) ++pivot;
    if (pivot == n) return {};
    std::swap(m[k], m[pivot]);
    std::swap(r[k], r[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k || m[i][k] == 0) continue;
      const Rational f = m[i][k] / m[k][k];
      for (std::size_t j = k; j < n; ++j) m[i][j] -= f * m[k][j];
      r[i] -= f * r[k];
    }
  }
  for (std::size_t k = 0; k < n; ++k) r[k] /= m[k][k];
  return r;
}

/// The shortest vector from a point of one triangle to one of the other, without rounding. There is only one.
///
/// Every pair of sub-simplices is tried: if the closest points of their affine hulls are unique and have non-negative
/// weights, the distance is attained by points of the hulls; the minimum over all pairs is the true distance.
inline RationalVec closest_difference(const Triangle& a, const Triangle& b) {
  const std::array<RationalVec, 3> va{rational(a.v0), rational(a.v1), rational(a.v2)};
  const std::array<RationalVec, 3> vb{rational(b.v0), rational(b.v1), rational(b.v2)};
  std::optional<Rational> best;
  RationalVec best_between;
  for (unsigned mask_a = 1; mask_a < 8; ++mask_a) {
    for (unsigned mask_b = 1; mask_b < 8; ++mask_b) {
      std::array<RationalVec, 4> direction;  // towards a's points positive, b's negative
      std::size_t n = 0, n_a = 0;
      const auto first_of = [](unsigned mask) { return static_cast<std::size_t>((mask & 1) ? 0 : (mask & 2) ? 1 : 2); };
      const std::size_t a0 = first_of(mask_a), b0 = first_of(mask_b);
      for (std::size_t i = a0 + 1; i < 3; ++i) {
        if (mask_a & (1U << i)) direction[n++] = minus(va[i], va[a0]);
      }
      n_a = n;
      for (std::size_t i = b0 + 1; i < 3; ++i) {
        if (mask_b & (1U << i)) direction[n++] = minus(vb[b0], vb[i]);
      }
      const RationalVec start = minus(va[a0], vb[b0]);  // minimise |start + sum x_k direction_k|^2
      std::array<std::array<Rational, 4>, 4> m;
      std::array<Rational, 4> r;
      for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j < n; ++j) m[i][j] = dot(direction[i], direction[j]);
        r[i] = -dot(direction[i], start);
      }
      const auto x = solve(m, r, n);
      if (!x) continue;  // not unique: a smaller pair attains the same minimum
      Rational sum_a = 0, sum_b = 0;
      bool inside = true;
      RationalVec between = start;
      for (std::size_t k = 0; k < n; ++k) {
        inside = inside && (*x)[k] >= 0;
        (k < n_a ? sum_a : sum_b) += (*x)[k];
        for (std::size_t axis = 0; axis < 3; ++axis) between[axis] += (*x)[k] * direction[k][axis];
      }
      if (!inside || sum_a > 1 || sum_b > 1) continue;
      const Rational d_sq = dot(between, between);
      if (!best || d_sq < *best) best = d_sq, best_between = between;
    }
  }
  return {-best_between[0], -best_between[1], -best_between[2]};
}

inline Rational squared_distance(const Triangle& a, const Triangle& b) {
  const RationalVec between = closest_difference(a, b);
  return dot(between, between);
}

/// Whether a sphere holds a point, without rounding.
inline bool exactly_inside(const Sphere& sphere, const Vec3& p) {
  const RationalVec d = minus(rational(p), rational(sphere.center));
  return dot(d, d) <= Rational(sphere.radius) * Rational(sphere.radius);
}

/// The extent of geometry.h without rounding.
inline Rational rational_extent(const Triangle& a, const Triangle& b) {
  Rational extent = 0;
  for (const Triangle* t : {&a, &b}) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (const Rational& r : minus(rational((*t)[i]), rational(a.v0))) extent = std::max<Rational>(extent, abs(r));
    }
  }
  return extent;
}

}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>

#include "support/exact_distance.h"

/// How far two triangles overlap along an axis, without rounding.
namespace limber::testing {

/// The extent of geometry.h.
inline double extent_of_pair(const Triangle& a, const Triangle& b) {
  double extent = 0;
  for (std::size_t i = 0; i < 3; ++i) extent = std::max({extent, max_abs(a[i] - a.v0), max_abs(b[i] - a.v0)});
  return extent;
}

namespace exact {

using FractionVec = std::array<Fraction, 3>;

inline FractionVec exactly(const Vec3& v) { return {exact::fraction(v.x), exact::fraction(v.y), exact::fraction(v.z)}; }
inline Fraction exact_dot(const FractionVec& a, const FractionVec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
inline FractionVec exact_difference(const FractionVec& a, const FractionVec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
inline FractionVec exact_cross(const FractionVec& a, const FractionVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// How far b has to move along `axis`, in units of the axis, until it is not behind a. Exact.
inline Fraction overlap_along(const FractionVec& axis, const Triangle& a, const Triangle& b) {
  Fraction end = exact_dot(axis, exactly(a.v0)), start = exact_dot(axis, exactly(b.v0));
  for (std::size_t i = 1; i < 3; ++i) {
    end = std::max(end, exact_dot(axis, exactly(a[i])));
    start = std::min(start, exact_dot(axis, exactly(b[i])));
  }
  return end - start;
}

}  // namespace exact
}  // namespace limber::testing

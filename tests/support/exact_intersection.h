// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "support/exact_distance.h"

/// The intersection of two triangles without rounding, whatever their ranks: as the image of a polytope of weights, so
/// there is no distinction of cases that it could have in common with the library.
namespace limber::testing::exact {

/// The point numerator / weight; the weight is above 0.
struct WeightedPoint {
  Vec numerator;
  Integer weight;
};

/// Five equations in at most five unknowns: their columns, then the right side.
using Column = std::array<Integer, 5>;

/// The solution of sum x_k columns[k] = right if it is unique and not negative, all multiplied by the last number.
///
/// Elimination without fractions: every division is exact, and all pivots so far are one number.
inline std::optional<std::vector<Integer>> non_negative_solution(std::vector<Column> columns, const Column& right) {
  const std::size_t count = columns.size();
  columns.push_back(right);
  Integer pivot = 1;
  for (std::size_t k = 0; k < count; ++k) {
    std::size_t row = k;
    while (row < 5 && columns[k][row] == 0) ++row;
    if (row == 5) return {};
    for (Column& column : columns) std::swap(column[k], column[row]);
    const Integer previous = std::exchange(pivot, columns[k][k]);
    for (std::size_t i = 0; i < 5; ++i) {
      if (i == k) continue;
      const Integer factor = columns[k][i];
      for (std::size_t j = k; j <= count; ++j) {
        columns[j][i] = (pivot * columns[j][i] - factor * columns[j][k]) / previous;
      }
    }
  }
  for (std::size_t i = count; i < 5; ++i) {
    if (columns[count][i] != 0) return {};
  }
  std::vector<Integer> x(columns[count].begin(), columns[count].begin() + static_cast<std::ptrdiff_t>(count));
  x.push_back(pivot);
  for (Integer& number : x) {
    if (pivot < 0) number = -number;
    if (number < 0) return {};
  }
  return x;
}

/// Points whose convex hull is the intersection of two triangles; none if they do not intersect.
///
/// The weights (x, y) with A x = B y, each with sum 1 and not negative, form a polytope. At a corner of it the non-zero
/// weights are determined uniquely. The intersection is the hull of the images of these corners.
inline std::vector<WeightedPoint> intersection_corners(const Corners3& a, const Corners3& b) {
  std::vector<WeightedPoint> points;
  for (unsigned mask_a = 1; mask_a < 8; ++mask_a) {
    for (unsigned mask_b = 1; mask_b < 8; ++mask_b) {
      std::vector<Column> columns;
      std::vector<std::size_t> corners_a;
      for (std::size_t i = 0; i < 3; ++i) {
        if ((mask_a >> i & 1) == 0) continue;
        columns.push_back({a[i].x, a[i].y, a[i].z, 1, 0});
        corners_a.push_back(i);
      }
      for (std::size_t i = 0; i < 3; ++i) {
        if ((mask_b >> i & 1) != 0) columns.push_back({-b[i].x, -b[i].y, -b[i].z, 0, 1});
      }
      if (columns.size() > 5) continue;  // never unique
      const auto x = non_negative_solution(std::move(columns), {0, 0, 0, 1, 1});
      if (!x) continue;
      WeightedPoint p{{0, 0, 0}, x->back()};
      for (std::size_t k = 0; k < corners_a.size(); ++k) {
        const Vec& corner = a[corners_a[k]];
        p.numerator.x += (*x)[k] * corner.x, p.numerator.y += (*x)[k] * corner.y, p.numerator.z += (*x)[k] * corner.z;
      }
      points.push_back(std::move(p));
    }
  }
  return points;
}

/// Whether a point is on a closed segment, which may be a point.
inline bool is_on_segment(const WeightedPoint& p, const Vec& from, const Vec& to) {
  const Vec d = to - from;
  const Vec q = p.numerator - Vec{p.weight * from.x, p.weight * from.y, p.weight * from.z};
  const Integer d_sq = dot(d, d), along = dot(q, d);
  return along >= 0 && along <= p.weight * d_sq && is_zero(cross(q, d)) && (d_sq != 0 || is_zero(q));
}

/// Whether two triangles share a point that is not on the segment from v to w.
inline bool intersect_off_segment(const Triangle& a, const Triangle& b, const Vec3& v, const Vec3& w) {
  const WholeCoordinates whole({a.v0, a.v1, a.v2, b.v0, b.v1, b.v2, v, w});
  const Vec from = whole(v), to = whole(w);
  for (const WeightedPoint& p : intersection_corners(whole(a), whole(b))) {
    if (!is_on_segment(p, from, to)) return true;
  }
  return false;
}

inline bool intersect(const Triangle& a, const Triangle& b) {
  const WholeCoordinates whole({a.v0, a.v1, a.v2, b.v0, b.v1, b.v2});
  return !intersection_corners(whole(a), whole(b)).empty();
}

}  // namespace limber::testing::exact

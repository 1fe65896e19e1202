// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Separating directions. Two compact convex sets are disjoint exactly when some direction separates them strictly, and
// for convex hulls finitely many directions are enough. Within the smallest flat that holds the Minkowski difference D,
// they are perpendicular to D's faces; beside it, they point from the flat to the origin.
//  - D is solid: every face is parallel to two edges, of either hull.
//  - D is planar: its normal is perpendicular to two edges that are not parallel; its sides lie in the plane and are
//    parallel to an edge.
//  - D is straight: along an edge, or from the line to the origin.
//  - D is a point: the vector to it.
#include "fuzz/exact_intersection.h"

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

namespace limber::fuzz {
namespace {

using Integer = boost::multiprecision::cpp_int;
using IntegerVec = std::array<Integer, 3>;

IntegerVec minus(const IntegerVec& a, const IntegerVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Integer dot(const IntegerVec& a, const IntegerVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
IntegerVec cross(const IntegerVec& a, const IntegerVec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
bool is_zero(const IntegerVec& v) { return v[0] == 0 && v[1] == 0 && v[2] == 0; }

/// The points, all multiplied by the power of two that makes every coordinate an integer.
std::vector<IntegerVec> as_integers(std::span<const Vec3> points) {
  constexpr int digits = std::numeric_limits<double>::digits;
  int lowest = std::numeric_limits<int>::max();
  for (const Vec3& p : points) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      int exponent = 0;
      if (std::frexp(p[axis], &exponent) != 0) lowest = std::min(lowest, exponent - digits);
    }
  }
  std::vector<IntegerVec> integers;
  for (const Vec3& p : points) {
    IntegerVec& v = integers.emplace_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      int exponent = 0;
      const double fraction = std::frexp(p[axis], &exponent);
      if (fraction == 0) continue;
      v[axis] = static_cast<std::int64_t>(std::ldexp(fraction, digits));
      v[axis] <<= static_cast<unsigned>(exponent - digits - lowest);
    }
  }
  return integers;
}

bool separates(const IntegerVec& direction, std::span<const IntegerVec> a, std::span<const IntegerVec> b) {
  if (is_zero(direction)) return false;
  const auto range = [&](std::span<const IntegerVec> points) {
    const std::array<Integer, 3> heights{dot(direction, points[0]), dot(direction, points[1]),
                                         dot(direction, points[2])};
    return std::pair(std::min({heights[0], heights[1], heights[2]}), std::max({heights[0], heights[1], heights[2]}));
  };
  const auto [low_a, high_a] = range(a);
  const auto [low_b, high_b] = range(b);
  return high_a < low_b || high_b < low_a;
}

}  // namespace

bool exactly_intersect(const Triangle& a, const Triangle& b) {
  const std::array<Vec3, 6> corners{a.v0, a.v1, a.v2, b.v0, b.v1, b.v2};
  const std::vector<IntegerVec> points = as_integers(corners);
  const std::span<const IntegerVec> all(points);
  const auto is_separated_by = [&](const IntegerVec& direction) {
    return separates(direction, all.first(3), all.last(3));
  };
  std::vector<IntegerVec> edges;
  for (std::size_t first : {0U, 3U}) {
    for (const auto& [from, to] : {std::pair(0U, 1U), std::pair(1U, 2U), std::pair(2U, 0U)}) {
      IntegerVec edge = minus(points[first + to], points[first + from]);
      if (!is_zero(edge)) edges.push_back(std::move(edge));
    }
  }
  const IntegerVec between = minus(points[3], points[0]);
  if (edges.empty()) return is_zero(between);

  std::vector<IntegerVec> normals;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      IntegerVec normal = cross(edges[i], edges[j]);
      if (!is_zero(normal)) normals.push_back(std::move(normal));
    }
  }
  if (normals.empty()) {
    const IntegerVec& along = edges.front();
    return !is_separated_by(along) && !is_separated_by(cross(along, cross(between, along)));
  }
  if (std::any_of(normals.begin(), normals.end(), is_separated_by)) return false;
  const IntegerVec& normal = normals.front();
  const bool is_planar =
      std::all_of(edges.begin(), edges.end(), [&](const IntegerVec& edge) { return dot(normal, edge) == 0; });
  return !is_planar || std::none_of(edges.begin(), edges.end(),
                                    [&](const IntegerVec& edge) { return is_separated_by(cross(normal, edge)); });
}

int exact_orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const std::array<Vec3, 4> given{a, b, c, d};
  const std::vector<IntegerVec> p = as_integers(given);
  return dot(cross(minus(p[1], p[0]), minus(p[2], p[0])), minus(p[3], p[0])).sign();
}

int exact_orient2d(const Vec3& a, const Vec3& b, const Vec3& c, std::size_t axis) {
  const std::array<Vec3, 3> given{a, b, c};
  const std::vector<IntegerVec> p = as_integers(given);
  return cross(minus(p[1], p[0]), minus(p[2], p[0]))[axis].sign();
}

}  // namespace limber::fuzz

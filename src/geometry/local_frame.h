// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "base/check.h"
#include "base/rounding.h"
#include "geometry/primitives.h"

/// What distances of triangles are computed with.
namespace limber::geometry {

/// Moves coordinates near the origin and, if need be, near unit size: v -> (v - origin) * scale, scale a power of two.
class LocalFrame {
 public:
  LocalFrame(const Vec3& origin, std::initializer_list<Vec3> points) : origin_(origin) {
    for (const Vec3& p : points) extent_ = std::max(extent_, max_abs(p - origin));
    if (extent_ == 0 || (extent_ > 0x1p-100 && extent_ < 0x1p100)) return;
    int exponent = 0;
    std::frexp(extent_, &exponent);
    // Subnormal extents may need more than the largest power of two; what is lost then is below any double.
    scale_ = std::ldexp(1.0, -std::max(exponent, -1000));
    extent_ *= scale_;
  }
  Vec3 to_local(const Vec3& v) const { return (v - origin_) * scale_; }
  Triangle to_local(const Triangle& t) const { return {to_local(t.v0), to_local(t.v1), to_local(t.v2)}; }
  Segment to_local(const Segment& s) const { return {to_local(s.p0), to_local(s.p1)}; }
  Vec3 from_local(const Vec3& v) const { return origin_ + v * (1 / scale_); }
  double length_from_local(double length) const { return length / scale_; }
  double extent() const { return extent_; }  ///< largest local coordinate

 private:
  Vec3 origin_;
  double extent_ = 0;
  double scale_ = 1;
};

/// A vector times a power of two that brings its largest coordinate to [1, 2): its square neither overflows nor
/// vanishes.
///
/// Pre      v is finite and not 0, and below 2^1000 in size.
inline Vec3 near_unit(const Vec3& v) {
  const double size = max_abs(v);
  LIMBER_ASSERT(size > 0 && size < 0x1p1000);
  if (size < std::numeric_limits<double>::min()) return near_unit(v * 0x1p60);
  // With e the biased exponent of the size, the power of two with the biased exponent 2046 - e, as 1 has 1023.
  return v * std::bit_cast<double>((std::uint64_t{2046} - (std::bit_cast<std::uint64_t>(size) >> 52)) << 52);
}

/// The direction of a vector, of length 1. Pre: as near_unit().
inline Vec3 unit(const Vec3& v) {
  const Vec3 scaled = near_unit(v);
  return scaled * (1 / length(scaled));
}

/// A vector of length 1 perpendicular to a direction.
inline Vec3 perpendicular_to(const Vec3& direction) {
  const Vec3 a = abs(direction);
  const Vec3 axis = a.x <= a.y && a.x <= a.z ? Vec3{1, 0, 0} : a.y <= a.z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  return unit(cross(direction, axis));
}

/// Whether all three corners are one.
inline bool is_point(const Triangle& t) { return t.v0 == t.v1 && t.v0 == t.v2; }

/// Length that stays positive where the square underflows.
inline double safe_length(const Vec3& v) {
  const double v_sq = length_sq(v);
  if (v_sq > base::tiny_square) return std::sqrt(v_sq);
  const double size = max_abs(v);
  return size == 0 ? 0 : size * length(v * (1 / std::max(size, 0x1p-1000)));
}

/// The point of a triangle with the given weights; a corner is met exactly.
inline Vec3 point_at(const Triangle& t, const Vec3& weights) {
  const std::size_t k = weights.x >= weights.y ? (weights.x >= weights.z ? 0 : 2) : (weights.y >= weights.z ? 1 : 2);
  const std::size_t i = next_corner[k], j = next_corner[i];
  return t[k] + (weights[i] * (t[i] - t[k]) + weights[j] * (t[j] - t[k]));
}

/// The smallest feature that has a point of these weights: a weight of 0 leaves its corner out.
inline Feature feature_of(const Vec3& weights) {
  const auto named = [](FeatureKind kind, std::size_t index) {
    return Feature{kind, static_cast<std::uint8_t>(index)};
  };
  for (std::size_t i = 0; i < 3; ++i) {
    if (weights[i] != 0) continue;
    const std::size_t j = next_corner[i], k = next_corner[j];  // edge j goes from corner j to corner k
    return weights[j] == 0   ? named(FeatureKind::vertex, k)
           : weights[k] == 0 ? named(FeatureKind::vertex, j)
                             : named(FeatureKind::edge, j);
  }
  return named(FeatureKind::face, 0);
}

}  // namespace limber::geometry

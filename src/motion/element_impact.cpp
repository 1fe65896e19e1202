// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  Double-double arithmetic [Dekker1971].
//
// Let f(t) = det(u, v, w), and `size` the product of the largest coordinates of u, v and w at both ends of time. At a
// time t, differences of corners are exact, and a product of two numbers, and a sum, are off by 2^-102 of the size of
// their terms. So f(t) is off by less than 2^-90 of `size`. Its slope is computed in float64: 3 determinants, each of 6
// products of three coordinates, of which one is a motion, all with some 16 roundings: off by less than 2^-43. What a
// tangent neglects is less than 120 of `size`, times the square of the time from t: 3 determinants with two motions,
// and one with three.
#include "motion/element_impact.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "base/check.h"
#include "base/error_free.h"
#include "base/float_environment.h"

namespace limber::motion {
namespace {

using base::DoublePair;

constexpr double value_error = 0x1p-90, slope_error = 0x1p-43, higher_terms = 120;

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
/// Without error if s is a power of two and nothing underflows.
PreciseVector scaled(double s, const PreciseVector& a) {
  return {{s * a.x.high, s * a.x.low}, {s * a.y.high, s * a.y.low}, {s * a.z.high, s * a.z.low}};
}
PreciseVector operator*(double s, const PreciseVector& a) {
  const DoublePair factor{s, 0};
  return {factor * a.x, factor * a.y, factor * a.z};
}
DoublePair dot(const PreciseVector& a, const PreciseVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

double largest(const PreciseVector& v) {
  return std::max({std::abs(v.x.high), std::abs(v.y.high), std::abs(v.z.high)});
}
Vec3 rounded(const PreciseVector& v) { return {v.x.high, v.y.high, v.z.high}; }

/// The three vectors of MovingElements.
struct PreciseVectors {
  PreciseVector u, v, w;

  /// At one end of the motion, without error.
  static PreciseVectors of(MovingElements::Kind kind, const Vec3 (&p)[4]) {
    if (kind == MovingElements::Kind::vertex_face) {
      return {difference(p[2], p[1]), difference(p[3], p[1]), difference(p[0], p[1])};
    }
    return {difference(p[1], p[0]), difference(p[2], p[3]), difference(p[2], p[0])};
  }
  PreciseVectors scaled_by(double s) const { return {scaled(s, u), scaled(s, v), scaled(s, w)}; }
  double largest_size() const { return std::max({largest(u), largest(v), largest(w)}); }
  static PreciseVector difference(const Vec3& a, const Vec3& b) {
    return {base::two_sum(a.x, -b.x), base::two_sum(a.y, -b.y), base::two_sum(a.z, -b.z)};
  }
};
Vectors rounded(const PreciseVectors& x) { return {rounded(x.u), rounded(x.v), rounded(x.w)}; }

double volume(const Vec3& u, const Vec3& v, const Vec3& w) { return dot(u, cross(v, w)); }

}  // namespace

std::optional<ElementImpact> narrow_precisely(const MovingElements& elements, double lower, double upper) {
  PreciseVectors start = PreciseVectors::of(elements.kind, elements.corners[0]);
  PreciseVectors end = PreciseVectors::of(elements.kind, elements.corners[1]);
  // In a unit in which the largest number is from 1 to 2, so that all scales give the same bits. In two steps, because
  // one factor may be out of range.
  const double most = std::max(start.largest_size(), end.largest_size());
  if (most == 0) return std::nullopt;
  const int exponent = std::ilogb(most), half = exponent / 2;
  for (const double factor : {std::ldexp(1.0, -half), std::ldexp(1.0, half - exponent)}) {
    start = start.scaled_by(factor), end = end.scaled_by(factor);
  }
  const double u = std::max(largest(start.u), largest(end.u)), v = std::max(largest(start.v), largest(end.v));
  const double w = std::max(largest(start.w), largest(end.w)), size = u * v * w;
  if (!(std::min({u, v, w}) > 0x1p-200)) return std::nullopt;  // underflow might lose what counts
  const Vectors motion = rounded(end) - rounded(start);
  constexpr int most_steps = 3;  // one is enough nearly always
  for (int i = 0; i < most_steps; ++i) {
    const double time = std::round(0.5 * (lower + upper) / time_resolution) * time_resolution, rest = 1 - time;
    const PreciseVectors at{rest * start.u + time * end.u, rest * start.v + time * end.v,
                            rest * start.w + time * end.w};
    const double value = dot(at.u, cross(at.v, at.w)).high;
    const Vectors x = rounded(at);
    const double slope = volume(motion.u, x.v, x.w) + volume(x.u, motion.v, x.w) + volume(x.u, x.v, motion.w);
    const double length = upper - lower;
    const double error = size * (value_error + length * (slope_error + higher_terms * length));
    // From `time`, in multiples of 2^-53.
    const double step = -value / slope / time_resolution;
    const double reach = error / std::abs(slope) / time_resolution + 0x1p-50 * std::abs(step);
    const double before = std::floor(step - reach), after = before + 1;
    if (before < step - reach && step + reach < after) {
      return ElementImpact{ImpactStatus::contact, time + before * time_resolution, time + after * time_resolution};
    }
    lower = std::max(lower, time + (before - 1) * time_resolution);
    upper = std::min(upper, time + (std::ceil(step + reach) + 1) * time_resolution);
    if (!(upper - lower < 0.5 * length)) return std::nullopt;
  }
  return std::nullopt;
}

namespace {

bool are_in_range(const MovingElements& e) {
  const auto is_in_range = [](const Vec3& p) { return is_finite(p) && max_abs(p) <= max_coordinate; };
  return std::all_of(std::begin(e.corners[0]), std::end(e.corners[0]), is_in_range) &&
         std::all_of(std::begin(e.corners[1]), std::end(e.corners[1]), is_in_range);
}

}  // namespace

void check(const ElementImpactOptions& options, const char* function) {
  require(options.max_time >= 0 && options.max_time <= 1, function, "max_time is not in [0, 1]");
  require(options.time_error >= 0, function, "time_error is negative or not a number");
  require(options.min_separation >= 0 && options.min_separation <= max_coordinate, function,
          "min_separation is not in [0, 2^200]");
}

ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options) {
  if (options.min_separation > 0) return separation_impact(elements, options);
  FilterResult found = filter_impact(elements, options);
  switch (found.verdict) {
    case FilterResult::Verdict::clear:
      return {};
    case FilterResult::Verdict::contact:
      if (found.upper - found.lower > std::max(options.time_error, time_resolution)) {
        if (const auto root = narrow_precisely(elements, found.lower, found.upper)) return *root;
        narrow_exactly(elements, options.time_error, found.lower, found.upper);
      }
      return {ImpactStatus::contact, found.lower, found.upper};
    case FilterResult::Verdict::unknown:
      break;
  }
  // The filter looks at signs of volumes, which say nothing of elements that stay in one plane.
  if (are_certainly_apart(elements, options.max_time)) return {};
  return exact_impact(elements, options);
}

namespace {

ElementImpact checked_impact(const MovingElements& elements, const ElementImpactOptions& options) {
  LIMBER_REQUIRE(are_in_range(elements), "limber::time_of_impact: a coordinate is not finite, or above 2^200 in size");
  check(options, "limber::time_of_impact");
  return impact_of(elements, options);
}

}  // namespace
}  // namespace limber::motion

namespace limber {

ElementImpact time_of_impact(const MovingPoint& point, const MovingTriangle& triangle,
                             const ElementImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return environment.computed_before_restore(
      motion::checked_impact(motion::MovingElements::of(point, triangle), options));
}

ElementImpact time_of_impact(const MovingSegment& a, const MovingSegment& b, const ElementImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return environment.computed_before_restore(motion::checked_impact(motion::MovingElements::of(a, b), options));
}

}  // namespace limber

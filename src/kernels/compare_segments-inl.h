// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::compare_segments, and the closest points of segments, a pair in each lane.
//
// Based on  the clamped closest-point iteration of [Ericson2005], section 5.1.9.
// Differs   As geometry/segment_distance.h says; the arithmetic is the same, number by number.

#if defined(LIMBER_SIMD_COMPARE_SEGMENTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_COMPARE_SEGMENTS_INL_H
#undef LIMBER_SIMD_COMPARE_SEGMENTS_INL_H
#else
#define LIMBER_SIMD_COMPARE_SEGMENTS_INL_H
#endif

#include <cstdint>

#include "base/rounding.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

template <typename P>
LIMBER_KERNEL P clamped_quotient(P numerator, P denominator) {
  const P zero = P::set(0), one = P::set(1);
  const P quotient = select(numerator >= denominator, one, numerator / denominator);
  return select((denominator > zero) & (numerator > zero), quotient, zero);
}

/// Closest points of segments: parameters from 0 to 1, and what is between the points.
template <typename P>
struct ClosestOnSegments {
  P s, t;
  Triple<P> between;
  P distance_sq;
};

/// The closest points of segments with these edge vectors; `w` is from the start of a to that of b.
template <typename P>
LIMBER_KERNEL ClosestOnSegments<P> closest_on_segments(const Triple<P>& edge_a, const Triple<P>& edge_b,
                                                       const Triple<P>& w) {
  const Triple<P> n = cross(edge_a, edge_b);
  const P along = dot(edge_a, edge_b);
  const P start = clamped_quotient(dot(cross(w, edge_b), n), dot(n, n));
  const P t = clamped_quotient(start * along - dot(edge_b, w), dot(edge_b, edge_b));
  const P s = clamped_quotient(t * along + dot(edge_a, w), dot(edge_a, edge_a));
  const Triple<P> between = w + (edge_b * t - edge_a * s);
  return {s, t, between, dot(between, between)};
}

LIMBER_KERNEL Quad sum_of_sizes(const Triple<Quad>& a, const Triple<Quad>& b, const Triple<Quad>& c) {
  return (abs(a.x) + abs(b.x) + abs(c.x)) + (abs(a.y) + abs(b.y) + abs(c.y)) + (abs(a.z) + abs(b.z) + abs(c.z));
}

// In vectors of four: on some processors those of 512 bits slow down what comes after them.
LIMBER_KERNEL void compare_segments(const SegmentPairs& pairs, ClosestOfSegments& found) {
  found.are_ordinary = 0;
  for (std::uint32_t i = 0; i < SegmentPairs::room; i += Quad::lanes) {
    const auto load = [&](const Vec3* points) {
      Triple<Quad> p;
      load_points(&points[i].x, p.x, p.y, p.z);
      return p;
    };
    const Triple<Quad> origin = load(pairs.start_a);
    const Triple<Quad> edge_a = load(pairs.end_a) - origin, w = load(pairs.start_b) - origin;
    const Triple<Quad> end_b = load(pairs.end_b) - origin;
    const ClosestOnSegments<Quad> closest = closest_on_segments(edge_a, end_b - w, w);
    closest.s.store(found.s + i), closest.t.store(found.t + i);
    sqrt(closest.distance_sq).store(found.distance + i);
    const Quad size = sum_of_sizes(edge_a, w, end_b);
    found.are_ordinary |=
        bits((size > Quad::set(base::smallest_unscaled_size)) & (size < Quad::set(base::largest_unscaled_size)) &
             (closest.distance_sq > Quad::set(base::tiny_square)))
        << i;
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

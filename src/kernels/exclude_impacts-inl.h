// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::exclude_impacts: what motion::filter_impact() decides first of most pairs, a pair in each lane. Each keeps
// one piece of time, which is clipped and never halved. Numbers are not scaled: pairs of an extreme size stay.

#if defined(LIMBER_SIMD_EXCLUDE_IMPACTS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_EXCLUDE_IMPACTS_INL_H
#undef LIMBER_SIMD_EXCLUDE_IMPACTS_INL_H
#else
#define LIMBER_SIMD_EXCLUDE_IMPACTS_INL_H
#endif

#include <cstdint>

#include "base/error_bounds.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// A polynomial in Bernstein form over a piece of time, in each lane.
struct QuadCubic {
  Quad c[4];
};
struct QuadQuadratic {
  Quad c[3];
};

LIMBER_KERNEL QuadQuadratic operator-(const QuadQuadratic& a, const QuadQuadratic& b) {
  return {{a.c[0] - b.c[0], a.c[1] - b.c[1], a.c[2] - b.c[2]}};
}
LIMBER_KERNEL QuadQuadratic operator*(const QuadQuadratic& a, Quad s) { return {{a.c[0] * s, a.c[1] * s, a.c[2] * s}}; }
LIMBER_KERNEL Quad least(const QuadQuadratic& a) { return min(min(a.c[0], a.c[1]), a.c[2]); }
LIMBER_KERNEL Quad most(const QuadQuadratic& a) { return max(max(a.c[0], a.c[1]), a.c[2]); }

/// A vector without its coordinate along an axis, in the order in which cross products of the others lead along it.
struct PlaneVector {
  Quad p, q;
};
LIMBER_KERNEL Quad cross(const PlaneVector& a, const PlaneVector& b) { return a.p * b.q - a.q * b.p; }
/// The cross product of two vectors that move, from a0 to a1 and from b0 to b1.
LIMBER_KERNEL QuadQuadratic cross(const PlaneVector& a0, const PlaneVector& a1, const PlaneVector& b0,
                                  const PlaneVector& b1) {
  return {{cross(a0, b0), (cross(a0, b1) + cross(a1, b0)) * Quad::set(0.5), cross(a1, b1)}};
}

/// The vectors u, v and w of motion::MovingElements at a time.
struct VectorsAtTime {
  Triple<Quad> u, v, w;
};
LIMBER_KERNEL VectorsAtTime operator-(const VectorsAtTime& a, const VectorsAtTime& b) {
  return {a.u - b.u, a.v - b.v, a.w - b.w};
}
LIMBER_KERNEL Quad largest_abs(const Triple<Quad>& a) { return max(max(abs(a.x), abs(a.y)), abs(a.z)); }

/// det(u, v, w), as motion::BernsteinVolume.
LIMBER_KERNEL QuadCubic volume(const VectorsAtTime& a, const VectorsAtTime& b) {
  const Triple<Quad> at_begin = cross(a.v, a.w), at_end = cross(b.v, b.w), mixed = cross(a.v, b.w) + cross(b.v, a.w);
  const Quad three = Quad::set(3);
  return {{dot(a.u, at_begin), (dot(b.u, at_begin) + dot(a.u, mixed)) / three,
           (dot(a.u, at_end) + dot(b.u, mixed)) / three, dot(b.u, at_end)}};
}

/// As motion::first_fall(), for a cubic or the negative one, whichever begins above the level; 0 if neither does.
LIMBER_KERNEL Quad first_fall(Quad c0, Quad c1, Quad c2, Quad c3, Quad level) {
  const Quad zero = Quad::set(0), third = Quad::set(1.0 / 3);
  const Quad side = select(c0 < zero, Quad::set(-1), Quad::set(1));
  const Quad c[4] = {c0 * side, c1 * side, c2 * side, c3 * side};
  Quad first = Quad::set(1);
  for (int i = 0; i < 3; ++i) {
    const Quad above = c[i] - level;
    for (int k = i + 1; k < 4; ++k) {
      const Quad below = level - c[k];
      const Quad at = (Quad::set(i) + Quad::set(k - i) * (above / (above + below))) * third;
      first = select((above > zero) & (below >= zero) & (at < first), at, first);
    }
  }
  return select(c[0] > level, first, zero);
}

/// Whether the elements certainly do not touch while one of the conditions on s and r fails, as in the filter.
LIMBER_KERNEL unsigned are_outside(const VectorsAtTime& a, const VectorsAtTime& b, bool are_faces, Quad area_error) {
  const Triple<Quad> middle = cross(a.u + b.u, a.v + b.v);
  const Quad x = abs(middle.x), y = abs(middle.y), z = abs(middle.z);
  const QuadMask is_x = (x > y) & (x > z), is_y = y > z;
  const auto along_axis = [&](const Triple<Quad>& v) {
    return PlaneVector{select(is_x, v.y, select(is_y, v.z, v.x)), select(is_x, v.z, select(is_y, v.x, v.y))};
  };
  const Quad along = select(is_x, middle.x, select(is_y, middle.y, middle.z));
  const Quad side = select(along < Quad::set(0), Quad::set(-1), Quad::set(1));
  const PlaneVector u0 = along_axis(a.u), u1 = along_axis(b.u), v0 = along_axis(a.v), v1 = along_axis(b.v);
  const PlaneVector w0 = along_axis(a.w), w1 = along_axis(b.w);
  const QuadQuadratic normal = cross(u0, u1, v0, v1) * side;
  const QuadQuadratic s = cross(w0, w1, v0, v1) * side, r = cross(u0, u1, w0, w1) * side;
  Quad farthest = min(most(s), most(r));
  farthest = are_faces ? min(farthest, most(normal - s - r)) : min(farthest, min(most(normal - s), most(normal - r)));
  return bits((least(normal) > area_error) & (farthest < Quad::set(0) - area_error));
}

/// A bit mask of pairs that certainly do not touch.
LIMBER_KERNEL unsigned exclude(const VectorsAtTime& start, const VectorsAtTime& end, bool are_faces,
                               const MotionLimits& limits) {
  const Quad u = max(largest_abs(start.u), largest_abs(end.u)), v = max(largest_abs(start.v), largest_abs(end.v));
  const Quad w = max(largest_abs(start.w), largest_abs(end.w));
  // Products neither overflow nor lose anything to underflow that counts.
  const QuadMask is_ordinary = (min(min(u, v), w) > Quad::set(0x1p-200)) & (max(max(u, v), w) < Quad::set(0x1p200));
  const Quad volume_error = u * v * w * Quad::set(base::moving_volume_error);
  const Quad area_error = (u * v + v * w + w * u) * Quad::set(base::moving_area_error);
  const VectorsAtTime motion = end - start;
  const auto at = [&](Quad t) {
    return VectorsAtTime{start.u + motion.u * t, start.v + motion.v * t, start.w + motion.w * t};
  };
  unsigned open = bits(is_ordinary), excluded = 0;
  Quad piece_begin = Quad::set(limits.begin), piece_end = Quad::set(limits.end);
  constexpr int most_pieces = 4;
  for (int i = 0; i < most_pieces; ++i) {
    const VectorsAtTime a = at(piece_begin), b = at(piece_end);
    const QuadCubic f = volume(a, b);
    const Quad f_least = min(min(f.c[0], f.c[1]), min(f.c[2], f.c[3]));
    const Quad f_most = max(max(f.c[0], f.c[1]), max(f.c[2], f.c[3]));
    const Quad size = max(f_least, Quad::set(0) - f_most);
    excluded |= open & (bits(size > volume_error) | are_outside(a, b, are_faces, area_error));
    const Quad level = volume_error * Quad::set(8), length = piece_end - piece_begin;
    const Quad after = first_fall(f.c[0], f.c[1], f.c[2], f.c[3], level);
    const Quad before = first_fall(f.c[3], f.c[2], f.c[1], f.c[0], level);
    open &= ~excluded & bits(after + before > Quad::set(0.25));
    if (open == 0) break;
    piece_begin = piece_begin + after * length, piece_end = piece_end - before * length;
  }
  return excluded;
}

LIMBER_KERNEL unsigned exclude_impacts(const MovingPairs& pairs, bool are_faces, const MotionLimits& limits) {
  unsigned excluded = 0;
  for (std::uint32_t i = 0; i < MovingPairs::room; i += Quad::lanes) {
    const auto load = [&](const Vec3* vectors) {
      Triple<Quad> p;
      load_points(&vectors[i].x, p.x, p.y, p.z);
      return p;
    };
    const VectorsAtTime start{load(pairs.u[0]), load(pairs.v[0]), load(pairs.w[0])};
    const VectorsAtTime end{load(pairs.u[1]), load(pairs.v[1]), load(pairs.w[1])};
    excluded |= exclude(start, end, are_faces, limits) << i;
  }
  return excluded;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels of what moves: find_meeting_children, find_impact_candidates, exclude_impacts.

#if defined(LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#undef LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#else
#define LIMBER_SIMD_FIND_IMPACT_CANDIDATES_INL_H
#endif

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/error_bounds.h"
#include "base/rounding.h"
#include "kernels/close_elements-inl.h"
#include "kernels/project-inl.h"
#include "layout/node.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// At most what x was before one operation has rounded it.
LIMBER_KERNEL Doubles rounded_down(Doubles x) { return x - abs(x) * Doubles::set(base::rounding_error); }

/// The intervals of some boxes along one axis, at both ends of the motion.
struct MovingInterval {
  Doubles low[bvh::motion_ends], high[bvh::motion_ends];
};

/// From when until when two boxes are within a separation along one axis; from 2 on if they never are. Gaps are linear
/// in time, so they begin to be where the gap that is there at the start closes, and cease to be where the gap that is
/// there at the end opens. Quotients are rounded to the nearest number.
struct Meeting {
  Doubles first, last;
};
LIMBER_KERNEL Meeting meeting(const MovingInterval& a, const MovingInterval& b, Doubles separation) {
  Doubles above[bvh::motion_ends], below[bvh::motion_ends];
  for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
    above[end] = rounded_down(rounded_down(a.low[end] - b.high[end]) - separation);
    below[end] = rounded_down(rounded_down(b.low[end] - a.high[end]) - separation);
  }
  const Doubles none = Doubles::set(0), never = Doubles::set(2);
  // Of the gap that is open at a time, its sizes then and at the other end.
  const Doubles start = max(above[0], below[0]), start_later = select(above[0] > below[0], above[1], below[1]);
  const Doubles end = max(above[1], below[1]), end_earlier = select(above[1] > below[1], above[0], below[0]);
  return {select(start > none, select(start_later > none, never, start / (start - start_later)), none),
          select(end > none, end_earlier / (end_earlier - end), never)};
}

LIMBER_KERNEL unsigned find_meeting_children(const bvh::MovingNode& node, const bvh::MovingBox& other,
                                             const MotionLimits& limits, MeetingTimes& times) {
  const Doubles separation = Doubles::set(limits.separation), tiny = Doubles::set(base::tiny_time);
  unsigned found = 0;
  for (std::uint32_t i = 0; i < width; i += Doubles::lanes) {
    Doubles first = Doubles::set(0), last = Doubles::set(2);
    for (std::uint32_t axis = 0; axis < 3; ++axis) {
      MovingInterval child, whole;
      for (std::uint32_t end = 0; end < bvh::motion_ends; ++end) {
        child.low[end] = Doubles::load(node.low[end][axis] + i),
        child.high[end] = Doubles::load(node.high[end][axis] + i);
        whole.low[end] = Doubles::set(other.low[end][axis]), whole.high[end] = Doubles::set(other.high[end][axis]);
      }
      const Meeting along = meeting(child, whole, separation);
      first = max(first, along.first), last = min(last, along.last);
    }
    // Quotients have been rounded twice, and are once more; what may have underflowed becomes 0, or is made larger.
    first = max(first * Doubles::set(1 - 8 * base::rounding_error) - tiny, Doubles::set(limits.begin));
    last = min(last * Doubles::set(1 + 8 * base::rounding_error) + tiny, Doubles::set(limits.end));
    found |= bits(first <= last) << i;
    first.store(times.first + i), last.store(times.last + i);
  }
  return found;
}

// Kernels::find_impact_candidates.

/// The corners of a leaf relative to a point: those of the start times one factor, and those of the end times another.
LIMBER_KERNEL void combine(const bvh::MovingLeaf& leaf, double of_start, double of_end, const float* offset,
                           LeafCorners& corners) {
  const Packet from_start = Packet::set(static_cast<float>(of_start)),
               from_end = Packet::set(static_cast<float>(of_end));
  for (int k = 0; k < 9; ++k) {
    for (std::uint32_t i = 0; i < width; i += Packet::lanes) {
      const Packet start = Packet::load(leaf.corner[0][k] + i), end = Packet::load(leaf.corner[1][k] + i);
      (start * from_start + end * from_end + Packet::set(offset[k % 3])).store(corners.v[k] + i);
    }
  }
}

/// At any pace a direction has to keep elements apart in all combinations of starts and ends. All is relative to the
/// center of a at the start.
LIMBER_KERNEL void find_at_any_pace(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b, double separation,
                                    OwnedElements owned_by_a, OwnedElements owned_by_b, const SelfPair* self,
                                    ElementCandidates& found) {
  double offset[4][3], size = 0;  // of starts and ends, those of a first
  for (int k = 0; k < 12; ++k) {
    offset[k / 3][k % 3] = (k < 6 ? a : b).center[k / 3 % 2][k % 3] - a.center[0][k % 3];
    size = std::max(size, std::abs(offset[k / 3][k % 3]));
  }
  const double scale = scale_to_one(
      std::clamp(size + std::max(a.unit[0], a.unit[1]) + std::max(b.unit[0], b.unit[1]), 0x1p-900, 0x1p900));
  LeafCorners c[4];
  for (int k = 0; k < 4; ++k) {
    const bvh::MovingLeaf& leaf = k < 2 ? a : b;
    float shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = static_cast<float>(offset[k][axis] * scale);
    combine(leaf, k % 2 == 0 ? scale * leaf.unit[0] : 0, k % 2 == 0 ? 0 : scale * leaf.unit[1], shift, c[k]);
  }
  const LeafCorners ca[4] = {c[0], c[1], c[0], c[1]}, cb[4] = {c[2], c[3], c[3], c[2]};
  const float limit = base::float_up(std::min(separation * scale, base::max_units)) + base::leaf_pair_error;
  find_elements(ca, cb, limit, owned_by_a, owned_by_b, self, found);
}

LIMBER_KERNEL void find_impact_candidates(const bvh::MovingLeaf& a, const bvh::MovingLeaf& b,
                                          const MotionLimits& limits, OwnedElements owned_by_a,
                                          OwnedElements owned_by_b, const SelfPair* self, ElementCandidates& found) {
  found.vertex_face.count = found.face_vertex.count = found.edge_edge.count = 0;
  if (limits.at_any_pace) return find_at_any_pace(a, b, limits.separation, owned_by_a, owned_by_b, self, found);
  // From the center of a to that of b, and the size of the pair, at the first and at the last time that matters.
  // Centers are exact, so all rounding is in proportion to that size, or below 2^-26 of it.
  const double times[2] = {limits.begin, limits.end};
  const auto at = [](double time, double start, double end) { return (1 - time) * start + time * end; };
  double offset[2][3], size = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double start = b.center[0][axis] - a.center[0][axis], end = b.center[1][axis] - a.center[1][axis];
    for (int i = 0; i < 2; ++i) {
      offset[i][axis] = at(times[i], start, end);
      size = std::max({size, std::abs(offset[i][axis]), 0x1p-24 * std::abs(start), 0x1p-24 * std::abs(end)});
    }
  }
  const auto extent = [&](const bvh::MovingLeaf& leaf) {
    return std::max(at(times[0], leaf.unit[0], leaf.unit[1]), at(times[1], leaf.unit[0], leaf.unit[1]));
  };
  size += extent(a) + extent(b);
  const double scale = scale_to_one(std::clamp(size, 0x1p-900, 0x1p900));  // all numbers are about 1 or less
  constexpr float none[3] = {0, 0, 0};
  LeafCorners ca[2], cb[2];
  for (int i = 0; i < 2; ++i) {
    const double of_start = (1 - times[i]) * scale, of_end = times[i] * scale;
    float shift[3];
    for (int axis = 0; axis < 3; ++axis) shift[axis] = static_cast<float>(offset[i][axis] * scale);
    combine(a, of_start * a.unit[0], of_end * a.unit[1], none, ca[i]);
    combine(b, of_start * b.unit[0], of_end * b.unit[1], shift, cb[i]);
  }
  const float limit = base::float_up(std::min(limits.separation * scale, base::max_units)) + base::leaf_pair_error;
  find_elements(ca, cb, limit, owned_by_a, owned_by_b, self, found);
}

// Kernels::exclude_impacts: what motion::filter_impact() decides first of most pairs, a pair in each lane. Each keeps
// one piece of time, which is clipped and never halved. Numbers are not scaled: pairs of an extreme size stay.

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

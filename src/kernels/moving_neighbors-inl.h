// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Which triangles of two leaves that move may meet, but for what they share. Most near triangles of a mesh that is
// compared with itself are neighbors, and few of these meet elsewhere.
//
//   a direction  keeps two triangles apart if it does so at all times that are given, as in close_elements-inl.h;
//   a line       through a shared corner keeps two neighbors apart, seen along an axis, as separated_by_line() says. It
//                has one direction, or moves with an edge. Then a cross product tells on which side of it a corner is,
//                a quadratic in time, and the coefficients of its Bernstein form bound it.

#if defined(LIMBER_SIMD_MOVING_NEIGHBORS_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_MOVING_NEIGHBORS_INL_H
#undef LIMBER_SIMD_MOVING_NEIGHBORS_INL_H
#else
#define LIMBER_SIMD_MOVING_NEIGHBORS_INL_H
#endif

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/error_bounds.h"
#include "kernels/element_lists-inl.h"
#include "kernels/find_candidates-inl.h"
#include "kernels/separated_neighbors-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

/// Bounds of numbers that change with time.
struct Bounds {
  Packet low, high;

  /// Bounds of either of two numbers.
  friend LIMBER_KERNEL Bounds around(const Bounds& p, const Bounds& q) {
    return {min(p.low, q.low), max(p.high, q.high)};
  }
};

/// The cross product of edge i of one sector and edge k of another, while both go from their first to their last place.
LIMBER_KERNEL Bounds turn(const Sector (&p)[2], int i, const Sector (&q)[2], int k) {
  const auto at = [&](const Sector& of_p, const Sector& of_q) { return of_p.x[i] * of_q.y[k] - of_p.y[i] * of_q.x[k]; };
  const Packet first = at(p[0], q[0]), last = at(p[1], q[1]);
  const Packet middle = (at(p[0], q[1]) + at(p[1], q[0])) * Packet::set(0.5F);
  return {min(min(first, last), middle), max(max(first, last), middle)};
}

/// Lanes in which a line through the one shared corner, across the mean direction from a to b, has both at all times on
/// its two sides. The direction is fixed, so heights along it are linear in time.
LIMBER_KERNEL Mask separated_across(const Sector (&a)[2], const Sector (&b)[2], Packet error) {
  const auto sum = [](const Packet(&first)[2], const Packet(&last)[2]) {
    return (first[0] + first[1]) + (last[0] + last[1]);
  };
  const Packet x = sum(b[0].x, b[1].x) - sum(a[0].x, a[1].x), y = sum(b[0].y, b[1].y) - sum(a[0].y, a[1].y);
  Packet least = Packet::set(far_off);
  for (int time = 0; time < 2; ++time) {
    for (int k = 0; k < 2; ++k) {
      least = min(least, x * b[time].x[k] + y * b[time].y[k]);
      least = min(least, zero() - (x * a[time].x[k] + y * a[time].y[k]));
    }
  }
  return least > (abs(x) + abs(y)) * error;
}

/// The `wanted` lanes, without those in which a line separates two neighbors all the time: one across them, or one as
/// separated_by_line() has them.
LIMBER_KERNEL unsigned not_separated(const SharedCorners& shared, const Sector (&a)[2], const Sector (&b)[2],
                                     unsigned wanted) {
  const Packet error = Packet::set(base::moving_turn_error);
  const Bounds turn_a = turn(a, 0, a, 1), t01 = turn(a, 0, b, 1);
  const Mask a_turns_mask = max(turn_a.low, zero() - turn_a.high) > error, a_turns_right_mask = turn_a.high < zero();
  const Mask two_mask = a_turns_mask & (select(a_turns_right_mask, t01.low, zero() - t01.high) > error);
  const unsigned left =
      wanted & ~((bits(separated_across(a, b, error)) & shared.one_lanes) | (bits(two_mask) & shared.two_lanes));
  if (left == 0) return 0;
  const Bounds turn_b = turn(b, 0, b, 1), t00 = turn(a, 0, b, 0), t10 = turn(a, 1, b, 0), t11 = turn(a, 1, b, 1);
  const Mask b_turns_mask = max(turn_b.low, zero() - turn_b.high) > error, b_turns_right_mask = turn_b.high < zero();
  // How far both edges of one are beyond the first or the second edge of the other, which turns left or right.
  const auto beyond = [&](Mask turns_right_mask, const Bounds& first, const Bounds& second) {
    return select(turns_right_mask, max(first.low, zero() - second.high), max(zero() - first.high, second.low));
  };
  const Packet beyond_a = beyond(a_turns_right_mask, around(t00, t01), around(t10, t11));
  const Packet beyond_b = beyond(b_turns_right_mask, around(t01, t11), around(t00, t10));
  const Mask one_mask = (a_turns_mask & (beyond_a > error)) | (b_turns_mask & (beyond_b > error));
  return left & ~(bits(one_mask) & shared.one_lanes);
}

/// The axis along which the first triangle of a leaf looks largest. Any is right.
LIMBER_KERNEL int widest_axis(const LeafCorners& c) {
  const auto edge = [&](int corner, int axis) { return c.v[3 * corner + axis][0] - c.v[axis][0]; };
  float size[3];  // of the coordinates of its normal
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    size[k] = std::abs(edge(1, i) * edge(2, j) - edge(1, j) * edge(2, i));
  }
  return size[2] >= std::max(size[0], size[1]) ? 2 : size[1] >= size[0] ? 1 : 0;
}

/// The `wanted` lanes, without those in which one direction keeps two triangles apart at all times: the line of their
/// centroids or the normal of one of them, as these are in the mean.
template <std::uint32_t times>
LIMBER_KERNEL unsigned not_apart(const LeafCorners (&a)[times], const Slots& in_a, const LeafCorners (&b)[times],
                                 const Slots& in_b, unsigned wanted, Packet limit_sq) {
  Packet3 p[times][3], q[times][3], sum_a[3], sum_b[3];
  for (int k = 0; k < 3; ++k) {
    sum_a[k] = sum_b[k] = {zero(), zero(), zero()};
    for (std::uint32_t time = 0; time < times; ++time) {
      p[time][k] = corners(a[time], k, in_a), q[time][k] = corners(b[time], k, in_b);
      sum_a[k] = sum_a[k] + p[time][k], sum_b[k] = sum_b[k] + q[time][k];
    }
  }
  const auto apart_along = [&](const Packet3& w) {
    Packet above = Packet::set(far_off), below = above;
    for (std::uint32_t time = 0; time < times; ++time) {
      const Interval of_a = interval(dot(w, p[time][0]), dot(w, p[time][1]), dot(w, p[time][2]));
      const Interval of_b = interval(dot(w, q[time][0]), dot(w, q[time][1]), dot(w, q[time][2]));
      above = min(above, of_b.low - of_a.high), below = min(below, of_a.low - of_b.high);
    }
    const Packet gap = max(max(above, below), zero());
    return bits(is_pruned(gap * gap, dot(w, w), limit_sq));
  };
  unsigned left = wanted & ~apart_along((sum_b[0] + sum_b[1] + sum_b[2]) - (sum_a[0] + sum_a[1] + sum_a[2]));
  if (left != 0) left &= ~apart_along(cross(sum_a[1] - sum_a[0], sum_a[2] - sum_a[0]));
  if (left != 0) left &= ~apart_along(cross(sum_b[1] - sum_b[0], sum_b[2] - sum_b[0]));
  return left;
}

/// Returns the pairs of triangles, of those in `near`, that may have more in common than what they share: bit
/// width * i + k is slot i of the first leaf and slot k of the second. With `have_neighbors` both leaves are of one
/// mesh, and the limit is 0, but for rounding.
template <std::uint32_t times>
LIMBER_KERNEL std::uint64_t may_meet(const LeafCorners (&a)[times], const LeafVertices& vertices_a,
                                     const LeafCorners (&b)[times], const LeafVertices& vertices_b,
                                     [[maybe_unused]] bool have_neighbors, Packet limit_sq, std::uint64_t near) {
  PairList pairs;
  pairs.add(near);
  pairs.fill_last_packet();
  [[maybe_unused]] const int widest = widest_axis(a[0]);
  std::uint64_t found = 0;
  for (std::uint32_t i = 0; i < pairs.count; i += Packet::lanes) {
    const Slots in_a = Slots::first_of(pairs.pair + i), in_b = Slots::second_of(pairs.pair + i);
    unsigned others = pairs.lanes_at(i), left = 0;
    // With four places of each corner, vertices move at paces of their own, and a line that moves with an edge proves
    // nothing.
    if constexpr (times == 2) {
      if (have_neighbors) {
        const SharedCorners shared = shared_corners(vertices_a, in_a, vertices_b, in_b);
        left = others & (shared.one_lanes | shared.two_lanes);
        others &= ~left;
        for (int k = 0; k < 3 && left != 0; ++k) {
          const int axes[2] = {(widest + k + 1) % 3, (widest + k + 2) % 3};
          const Sector of_a[2] = {Sector(shared.a, a[0], in_a, axes), Sector(shared.a, a[1], in_a, axes)};
          const Sector of_b[2] = {Sector(shared.b, b[0], in_b, axes), Sector(shared.b, b[1], in_b, axes)};
          left = not_separated(shared, of_a, of_b, left);
        }
      }
    }
    if (others != 0) left |= not_apart(a, in_a, b, in_b, others, limit_sq);
    for (; left != 0; left &= left - 1) {
      found |= std::uint64_t{1} << pairs.pair[i + static_cast<std::uint32_t>(std::countr_zero(left))];
    }
  }
  return found;
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

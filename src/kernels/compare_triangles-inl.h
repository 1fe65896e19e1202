// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Kernels::compare_triangles.

#if defined(LIMBER_SIMD_COMPARE_TRIANGLES_INL_H) == defined(HWY_TARGET_TOGGLE)  // once per instruction set
#ifdef LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#undef LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#else
#define LIMBER_SIMD_COMPARE_TRIANGLES_INL_H
#endif

#include <cstdint>
#include <limits>

#include "kernels/compare_segments-inl.h"
#include "simd/kernels.h"
#include "simd/packets-inl.h"

LIMBER_BEFORE_KERNELS;
namespace limber::simd::LIMBER_TARGET {
namespace {

using Quad3 = Triple<Quad>;

LIMBER_KERNEL Quad3 broadcast(const Vec3& v) { return {Quad::set(v.x), Quad::set(v.y), Quad::set(v.z)}; }

/// The corners of a triangle, [axis][corner]: the first two again after the last, so that edges can be loaded.
struct CornersInTurn {
  double v[3][5];

  LIMBER_KERNEL explicit CornersInTurn(const Triangle& t) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 5; ++k) v[axis][k] = t[k % 3][axis];
    }
  }
  LIMBER_KERNEL Quad3 from(std::uint32_t k) const {
    return {Quad::load(v[0] + k), Quad::load(v[1] + k), Quad::load(v[2] + k)};
  }
};

/// The corners, of those given by turns, whose foot is inside of a face, as a bit mask.
LIMBER_KERNEL unsigned find_feet(const FaceVectors& face, const CornersInTurn& corners) {
  const Quad zero = Quad::set(0);
  unsigned found = 0;
  for (std::uint32_t k = 0; k < 3; k += Quad::lanes) {
    const Quad3 p = corners.from(k);
    const Quad w2 = dot(broadcast(face.inward[0]), p - broadcast(face.corner.v0));
    const Quad w0 = dot(broadcast(face.inward[1]), p - broadcast(face.corner.v1));
    const Quad w1 = dot(broadcast(face.inward[2]), p - broadcast(face.corner.v2));
    const Quad sum = w0 + w1 + w2;
    found |= bits((w0 >= zero) & (w1 >= zero) & (w2 >= zero) & (sum > zero)) << k;
  }
  return found & 7;
}

LIMBER_KERNEL void compare_triangles(const FaceVectors& a, const FaceVectors& b, TriangleFeatures& found) {
  const CornersInTurn corners_a(a.corner), corners_b(b.corner);
  found.feet_of_a = find_feet(b, corners_a);
  found.feet_of_b = find_feet(a, corners_b);
  found.distance_sq = std::numeric_limits<double>::infinity();
  found.edge_a = found.edge_b = 0;
  found.at_a = found.at_b = 0;
  for (std::uint32_t j = 0; j < 3; j += Quad::lanes) {
    const Quad3 start_b = corners_b.from(j), edge_b = corners_b.from(j + 1) - start_b;
    Quad least_sq = Quad::set(std::numeric_limits<double>::infinity());
    Quad at_a = Quad::set(0), at_b = at_a, of_a = at_a;
    for (std::size_t i = 0; i < 3; ++i) {
      const Quad3 edge_a = broadcast(a.edge[i]), w = start_b - broadcast(a.corner[i]);
      const ClosestOnSegments<Quad> closest = closest_on_segments(edge_a, edge_b, w);
      const QuadMask is_better = least_sq > closest.distance_sq;
      least_sq = select(is_better, closest.distance_sq, least_sq);
      at_a = select(is_better, closest.s, at_a), at_b = select(is_better, closest.t, at_b);
      of_a = select(is_better, Quad::set(static_cast<double>(i)), of_a);
    }
    double least[Quad::lanes], s[Quad::lanes], t[Quad::lanes], edge[Quad::lanes];
    least_sq.store(least), at_a.store(s), at_b.store(t), of_a.store(edge);
    for (std::uint32_t lane = 0; lane < Quad::lanes && j + lane < 3; ++lane) {
      const auto edge_a = static_cast<std::uint32_t>(edge[lane]), edge_b_index = j + lane;
      // Of equally close pairs the first, edges of a being counted first.
      const bool is_first = 3 * edge_a + edge_b_index < 3 * found.edge_a + found.edge_b;
      if (least[lane] < found.distance_sq || (least[lane] == found.distance_sq && is_first)) {
        found.distance_sq = least[lane], found.at_a = s[lane], found.at_b = t[lane];
        found.edge_a = edge_a, found.edge_b = edge_b_index;
      }
    }
  }
}

}  // namespace
}  // namespace limber::simd::LIMBER_TARGET
LIMBER_AFTER_KERNELS;

#endif

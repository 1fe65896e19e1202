// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "bvh/partition.h"

namespace limber::bvh {

/// Centers as kernels take points: four floats each. They do not use the fourth, which is the triangle's id.
inline const float* as_points(const PrimitiveRef* primitives) {
  static_assert(sizeof(PrimitiveRef) == 4 * sizeof(float));
  return primitives->center.data();
}

/// The `n` primitives with the least coordinates along an axis, as a bit mask; of equal coordinates, the smaller
/// triangle ids are less. Pre: there are at most simd::few_points primitives.
std::uint64_t least_of_few(std::span<const PrimitiveRef> primitives, std::size_t axis, std::size_t n);

/// Partitions a range of few primitives down to leaves, those of a lowest node or of a part of it.
///
/// Based on  The surface area heuristic [MacDonaldBooth1990]: a split is as good as the boxes of its halves are small.
/// Differs   The sizes of the halves are given. So there are four candidates: the median along each axis, and the
///           median of the triangles' sizes, which keeps a few large triangles from making all boxes large.
///
/// Cost     O(n log n); about as much for each triangle as partitioning it down to here.
/// Pre      There are at most simd::few_points primitives in the range.
void partition_few(std::span<PrimitiveRef> primitives, const BuildRange& range, std::span<const HalfSides> half_sides);

}  // namespace limber::bvh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "simd/packets.h"

/// The SIMD kernels: bounds, and what they rule out. Numbers that reach the user come from float64 routines.
///
/// Every operation is an IEEE one, none is fused, and lanes do not mix except in minima and maxima of numbers, so all
/// instruction sets give the same bits.
namespace limber::simd {

/// One node, or leaf, of the tree that is seen, by its block and lane there, as seen from the other tree.
struct Seen {
  const Block* block;
  std::uint32_t lane;
  const LeafTriangles* corners;  ///< nullptr unless it is a leaf
};

/// Lower bounds of the distance between the lanes of a block and one node of the other tree, which the block's tree
/// sees through `view`.
///
/// Returns the lanes whose squared bound is below `limit_sq` and that view.toward, if there is one, does not rule out.
/// Writes to order[lane] the squared bound where that is above 0, otherwise how deep the balls overlap, as a fraction
/// of the sum of the radii, negative. Writes to bound_sq[lane], unless that is nullptr, the best squared bound there
/// is, the one along view.toward included. Both for all lanes, those without a node included.
using BoundLanes = KeptLanes (*)(const Block& lanes, const Seen& seen, const View& view, float limit_sq, float* order,
                                 float* bound_sq);

/// Pairs of triangles of two leaves that cannot be ruled out, in lane order; `a` sees `b` through `view`.
using LeafCandidates = void (*)(const Seen& a, const Seen& b, const View& view, Candidates& candidates);

/// Fits a block to the triangles of its leaves, the first block.count of `leaves`: origin, reach and all bounds of the
/// block, the corners in the leaves. `unit` is that of the tree; the leaves behind are those that will be fitted next.
/// Returns a bound of all the triangles.
using FitLeaves = WholeBound (*)(const Vec3* positions, double unit, Block& block, std::span<Leaf> leaves);

/// A bound around the lanes of a block, relative to its origin, in units.
using Enclose = WholeBound (*)(const Block& block);

/// How far points have gone.
struct Motion {
  double furthest_sq;  ///< the longest way, squared; 0 unless is_bounded
  bool is_bounded;     ///< whether all new coordinates are numbers of at most a given size
};
using MeasureMotion = Motion (*)(const Vec3* from, const Vec3* to, std::size_t count, double most);

/// The kernels for one instruction set.
struct Kernels {
  const char* name;
  BoundLanes bound_lanes;
  LeafCandidates leaf_candidates;
  FitLeaves fit_leaves;
  Enclose enclose;
  MeasureMotion measure_motion;
};

/// The best set this processor runs.
///
/// Threads  Safe; chosen once.
const Kernels& kernels();

/// The same arithmetic in plain C++, one lane at a time.
extern const Kernels scalar_kernels;

/// Every set this processor runs, best first, the scalar one last. For tests.
std::span<const Kernels> all_kernels();

/// Makes kernels() return `chosen` from now on; nullptr returns to the best. For tests.
void use_kernels(const Kernels* chosen);

}  // namespace limber::simd

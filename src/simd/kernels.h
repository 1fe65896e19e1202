// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "simd/packets.h"

/// The SIMD kernels. They only ever say "this cannot matter"; numbers that reach the user come from float64 routines.
///
/// Every operation is an IEEE one, none is fused, and lanes do not mix except in minima and maxima of numbers, so all
/// instruction sets give the same bits.
namespace limber::simd {

/// Lower bounds of the distance between the first `count` lanes and a facing node.
///
/// Returns the lanes, as bits, whose squared bound is below `limit_sq` and that `toward`, if given, does not rule out.
/// Writes to order[lane] the squared bound where that is above 0, otherwise how deep the balls overlap, as a fraction
/// of the sum of the radii, negative; to all lanes, those without a node included.
using BoundLanes = unsigned (*)(const NodeBounds& lanes, std::uint32_t count, const Facing& facing,
                                const Toward* toward, float limit_sq, float* order);

/// The largest n . q over the corners of a leaf, in steps.
using LeafSupport = float (*)(const LeafTriangles& leaf, const float* normal);

/// Pairs of triangles of two leaves that cannot be ruled out; at most width * width, in lane order. Returns how many.
using LeafCandidates = std::uint32_t (*)(const LeafTriangles& a, const LeafTriangles& b, const LeafPair& pair,
                                         Candidate* candidates);

/// The kernels for one instruction set.
struct Kernels {
  const char* name;
  BoundLanes bound_lanes;
  LeafSupport leaf_support;
  LeafCandidates leaf_candidates;
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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "layout/wide_node.h"

/// The SIMD kernels: bounds, and what they prune. Numbers that reach the user come from float64 routines.
///
/// Every operation is an IEEE one, none is fused, and SIMD lanes do not mix except in minima and maxima of numbers, so
/// all instruction sets give the same bits.
namespace limber::simd {

using bvh::width;

// --- inputs and outputs of the query kernels ---

/// How to get from the other model's frame and unit to this one's. Matrices are stored by columns and padded, so that
/// four numbers are worked on at once.
struct FrameTransform {
  alignas(32) double from_other[4][4];  ///< the columns of the rotation, then the translation
  alignas(16) float rotation[3][4];     ///< the same rotation, rounded
  float rotation_abs[3][4];
  double unit, per_unit, other_unit;
  float ratio;        ///< other_unit / unit; infinite where float32 could not square it
  float error_units;  ///< `error` in units; infinite where float32 could not square it
  double error;       ///< most that rounding of placed points and the drift of both models change a length by
};

/// What a query prunes: pairs at least `distance` apart. It measures that along a search direction too, if there is
/// one: the direction in which the closest pair so far is apart.
struct PruneLimits {
  double distance;
  bool has_direction;
  double direction[3];    ///< from this model to the other, in this frame, of length 1
  float normal[3];        ///< the same, rounded
  float other_normal[3];  ///< the opposite direction, in the other's frame
};

/// A child slot of a tree, or its leaf, to be compared with slots of the other tree.
struct OtherNode {
  const bvh::WideNode* node;
  std::uint32_t slot;
  const bvh::QuantizedTriangles* triangles;  ///< nullptr unless it is a leaf
};

/// Child slots, as bit masks.
struct KeptSlots {
  unsigned all;          ///< those that are not pruned
  unsigned overlapping;  ///< of these, those whose bound is 0
};

/// Two triangles of two leaves that are not pruned.
struct Candidate {
  float bound_sq;  ///< at most (their distance * Candidates::scale + Candidates::error)^2
  std::uint8_t slot_a, slot_b;
};

struct Candidates {
  std::uint32_t count;
  float error;   ///< more than rounding and quantization can change any gap by
  double scale;  ///< from lengths to those of bounds and error, a power of two
  float apart;   ///< at most distance * scale of every pair that is not a candidate
  Candidate pairs[width * width];
};

// --- kernels ---

/// Lower bounds of the distances between the children of a wide node and one slot of the other tree.
///
/// `transform` and `pruning` are those of the tree of `node`. Returns the children whose squared bound is below
/// `limit_sq` and that the search direction does not prune. Writes to order[slot] the squared bound where that is above
/// 0, otherwise how deep the spheres overlap, as a fraction of the sum of their radii, negative. Writes to
/// bound_sq[slot], unless that is nullptr, the best squared bound, the one along the search direction included. Both
/// are written for all slots, those without a child included.
using BoundChildren = KeptSlots (*)(const bvh::WideNode& node, const OtherNode& other, const FrameTransform& transform,
                                    const PruneLimits& pruning, float limit_sq, float* order, float* bound_sq);

/// The pairs of triangles of two leaves that are not pruned, in the order of slots. `transform` and `pruning` are those
/// of the tree of `a`. Candidates::apart is written if `bounds_rest`.
using FindCandidates = void (*)(const OtherNode& a, const OtherNode& b, const FrameTransform& transform,
                                const PruneLimits& pruning, bool bounds_rest, Candidates& candidates);

/// Fits a wide node of the lowest level to the triangles of its leaves, the first node.child_count of `leaves`: origin,
/// radius and bounds of the node, and the quantized corners of the leaves. `unit` is that of the tree. The leaves that
/// follow are those that will be fitted next. Returns a bound of all the triangles.
using FitLeaves = bvh::MergedBounds (*)(const Vec3* positions, double unit, bvh::WideNode& node,
                                        std::span<bvh::Leaf> leaves);

/// A bound around the children of a wide node.
using MergeBounds = bvh::MergedBounds (*)(const bvh::WideNode& node);

struct Displacement {
  double farthest_sq;  ///< the longest displacement of a point, squared; 0 unless is_bounded
  bool is_bounded;     ///< whether all new coordinates are numbers of at most a given size
};
/// The displacements of points from `from` to `to`, and whether all coordinates of `to` are at most `most` in size.
using MaxDisplacement = Displacement (*)(const Vec3* from, const Vec3* to, std::size_t count, double most);

/// The kernels for one instruction set.
struct Kernels {
  const char* name;
  BoundChildren bound_children;
  FindCandidates find_candidates;
  FitLeaves fit_leaves;
  MergeBounds merge_bounds;
  MaxDisplacement max_displacement;
};

/// The best set this processor runs.
///
/// Threads  Safe; chosen once.
const Kernels& kernels();

/// The same arithmetic in plain C++, one SIMD lane at a time.
extern const Kernels scalar_kernels;

/// Every set this processor runs, best first, the scalar one last. For tests.
std::span<const Kernels> all_kernels();

/// Makes kernels() return `chosen` from now on; nullptr returns to the best. For tests.
void use_kernels(const Kernels* chosen);

}  // namespace limber::simd

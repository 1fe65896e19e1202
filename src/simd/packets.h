// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

/// Data as the kernels read it: structures of arrays, float32, `width` lanes wide. Lengths are in the unit of the tree
/// they belong to, a power of two, and positions are relative to a local origin, so float32 resolves what matters.
namespace limber::simd {

/// Children of a node, and triangles of a leaf.
inline constexpr std::uint32_t width = 8;

/// Bounding volumes of up to `width` sibling nodes. Each lane is a ball, a box along the model's axes and a slab, all
/// about one centre; what the node contains lies in all three. Numbers are rounded outward.
struct alignas(64) NodeBounds {
  float center_x[width], center_y[width], center_z[width];  // 96 bytes
  float radius[width];                                      // 32
  float half_x[width], half_y[width], half_z[width];        // 96   of the box
  float normal_x[width], normal_y[width], normal_z[width];  // 96   of the slab, length 1 up to rounding
  float low[width], high[width];                            // 64   low <= normal . (p - centre) <= high
};
static_assert(sizeof(NodeBounds) == 12 * 4 * width);

/// Corners of the triangles of a leaf as fractions of its ball: p = centre + radius * q / quantum, each coordinate to
/// within half a step. corner[3 * k + axis] holds coordinate `axis` of corner k.
struct alignas(16) LeafTriangles {
  std::int16_t corner[9][width];  // 144 bytes
};
static_assert(sizeof(LeafTriangles) == 18 * width);
inline constexpr float quantum = 32767;

/// One node of the other tree, expressed in frame, unit and origin of the lanes it is compared with. Everything that
/// bounds it is enlarged by the rounding errors of that expression and of the comparison itself.
struct Facing {
  float center[3];
  float radius;
  float half[3];  ///< along the axes of the lanes' frame
  float normal[3];
  float low, high;
};

/// A direction in which lanes may be told apart from a facing node: the way to the other model, unit length. A lane
/// whose reach along it is at most `gap`, measured from the lanes' origin, cannot improve the answer.
struct Toward {
  float normal[3];
  float gap;
  float cut;  ///< how far apart lanes and node must be for that
};

/// Two leaves, expressed in the frame of a, origin at the centre of a, scaled so that all numbers are about 1 or less.
struct LeafPair {
  float step_a, step_b;  ///< length of one quantum
  float a_from_b[9];     ///< rotation by rows
  float offset[3];       ///< from the centre of a to that of b
  float error;           ///< exceeds what rounding and quantisation can change any gap by
  float cut;             ///< pairs of triangles at least this far apart cannot improve the answer
  bool has_toward;       ///< whether the three fields below mean anything
  float toward_a[3];     ///< the best witness's direction, from a to b, in the frame of a
  float toward_b[3];     ///< the same direction in the frame of b
  float gap;             ///< reach of a triangle of a minus that of one of b that cannot improve the answer
};

/// Two triangles that may matter, by lane; their squared distance is at least `bound_sq` in the leaf pair's scale, less
/// what `error` stands for.
struct Candidate {
  float bound_sq;
  std::uint8_t lane_a, lane_b;
};

}  // namespace limber::simd

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "limber/base.h"
#include "limber/math.h"

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

/// Up to `width` sibling nodes.
struct alignas(64) Block {
  NodeBounds bounds;          // 384 bytes   in units, relative to origin
  Vec3 origin;                //  24         model frame
  float reach;                //   4         in units
  std::uint32_t first_child;  //   4         block, or leaf on the lowest level, of lane 0; lane k has the k-th after it
  std::uint32_t count;        //   4         lanes in use, the first ones
  std::uint32_t parent;       //   4         block * width + lane of the node whose children these are; 0 for block 0
  std::uint32_t coincident;   //   4         bits of lanes all of whose triangles are at one place, corner by corner
};
static_assert(sizeof(Block) == 448);

/// Up to `width` triangles; lanes beyond them repeat the last one.
struct Leaf {
  LeafTriangles corners;                    // 144 bytes   about the centre of the leaf's lane
  TriangleId triangle[width];               //  32
  std::array<VertexId, 3> vertices[width];  //  96         of the triangles
};
static_assert(sizeof(Leaf) == 272);

/// A ball, a box and a slab about one centre, as NodeBounds, in units; rounded outward.
struct WholeBound {
  float center[3];  // relative to the origin of the block it bounds
  float radius, half[3], normal[3], low, high;
};

/// Beyond this many units a node is treated as if it were everywhere: float32 could not square the numbers.
inline constexpr double furthest = 0x1p60;

/// How the other model looks from this one. Matrices go by columns and are padded, so that four numbers are worked on
/// at once.
struct View {
  alignas(32) double from_other[4][4];  ///< this model's frame from the other's, the shift last
  alignas(16) float rotation[3][4];     ///< its rotation
  float rotation_abs[3][4];
  double unit, per_unit, other_unit;
  float ratio;        ///< other_unit / unit; infinite where float32 could not square it
  float error_units;  ///< what rounding of placed points can change a length by; infinite where ratio would be
  double error;       ///< the same, not in units

  double cut;             ///< what is at least this far apart cannot improve the answer
  bool has_toward;        ///< whether the three fields below mean anything
  double toward[3];       ///< the way to the other model along which they were last closest: unit length, this frame
  float normal[3];        ///< the same, rounded
  float other_normal[3];  ///< the opposite way in the other's frame
};

/// Lanes, as bits.
struct KeptLanes {
  unsigned all;      ///< those that matter
  unsigned meeting;  ///< of these, those whose bound is 0
};

/// Two triangles that may matter, by lane.
struct Candidate {
  float bound_sq;  ///< their squared distance is at least that, less what Candidates::error stands for
  std::uint8_t lane_a, lane_b;
};

/// What two leaves are left with.
struct Candidates {
  std::uint32_t count;
  float error;   ///< exceeds what rounding and quantisation can change any gap by
  double scale;  ///< from lengths to those of bounds and error, a power of two
  Candidate pairs[width * width];
};

}  // namespace limber::simd

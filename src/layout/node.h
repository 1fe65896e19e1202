// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>

#include "limber/base.h"
#include "limber/math.h"

/// Memory layout of 8-wide trees, as structures of arrays: the hierarchy of a mesh; the bounds of one that moves, over
/// the same hierarchy; trees of boxes.
///
/// Unit     Float32 numbers of the hierarchy are multiples of Tree::unit, a power of two. They are relative to a place
///          nearby, so float32 resolves them wherever the mesh lies. Float64 numbers are in the mesh's length unit.
namespace limber::bvh {

/// Child slots of a node, and triangle slots of a leaf.
inline constexpr std::uint32_t width = 8;

/// A mask of pairs of slots: bit width * i + k stands for slots i and k, so byte i for slot i. Set are the pairs with
/// k > i, from 0xfe in the lowest byte on, so that a node or leaf is compared with itself without repeats.
inline constexpr std::uint64_t each_pair_once = 0x0080c0e0f0f8fcfe;

/// Bounding volumes of the children of a node, one child slot each. A volume is the intersection of a sphere, an
/// axis-aligned box in the model frame and a slab, all about one center; SlabSides adds a second box. Numbers are
/// rounded outward. Slots without a child hold numbers that mean nothing.
struct alignas(64) ChildBounds {
  float center_x[width], center_y[width], center_z[width];  // 96 bytes   relative to Node::origin
  float radius[width];                                      // 32   of the sphere
  float half_x[width], half_y[width], half_z[width];        // 96   half extents of the box
  float normal_x[width], normal_y[width], normal_z[width];  // 96   of the slab, length 1 up to rounding
  float low[width], high[width];                            // 64   low <= normal . (p - center) <= high
};
static_assert(sizeof(ChildBounds) == 12 * 4 * width);

/// For an elongated child, the intervals of its content along two directions in the plane of its slab, perpendicular to
/// each other: with the slab they make a box. The first direction is turned by the angle asin(turn / max_quantized), at
/// most 45 degrees, from a direction that follows from the normal (in_plane() in bvh/tree.h). Heights over the center
/// are fractions of the sphere's radius, h = radius * low / max_side, rounded outward by more than a step. A child that
/// is not elongated has the intervals of the sphere.
struct alignas(16) SlabSides {
  std::int16_t turn[width];                    // 16 bytes
  std::int16_t low[2][width], high[2][width];  // 64
};
static_assert(sizeof(SlabSides) == 10 * width);
inline constexpr float max_side = 32760;  // less than 32767, so that what has the radius's size can be rounded outward

/// Corners of the triangles of a leaf as fractions of the radius of its sphere: p = center + q * step, where step is
/// radius / max_quantized. A coordinate is off by at most 0.52 steps: half a step, and float32 (invariant I5 of
/// bvh/tree.h). corner[3 * c + axis][slot] holds coordinate `axis` of corner c.
struct alignas(16) QuantizedTriangles {
  std::int16_t corner[9][width];  // 144 bytes
};
static_assert(sizeof(QuantizedTriangles) == 18 * width);
inline constexpr float max_quantized = 32767;

/// A node with up to `width` children.
struct alignas(64) Node {
  ChildBounds bounds;              // 384 bytes
  SlabSides sides;                 //  80
  Vec3 origin;                     //  24         model frame, float64
  float radius;                    //   4         of a sphere about the origin that holds the spheres of all children
  std::uint32_t first_child;       //   4         slot k holds node first_child + k; on the lowest level that leaf
  std::uint32_t child_count;       //   4         slots in use, the first ones
  std::uint32_t parent;            //   4         slot whose child this is, 8 * node + slot; the header, node 0, has 0
  std::uint32_t coincident_slots;  //   4         mask: all triangles below have the same positions, corner by corner
  std::uint32_t elongated_slots;   //   4         mask: children that are elongated; before the first fit all
};
static_assert(sizeof(Node) == 512);

/// The slots in use, as a mask.
inline std::uint32_t used_slots(const Node& node) { return (1U << node.child_count) - 1; }

/// Up to `width` triangles in ascending order; slots beyond them repeat the last one.
struct Leaf {
  QuantizedTriangles corners;               // 144 bytes   about the center of the leaf's slot
  TriangleId triangle[width];               //  32
  std::array<VertexId, 3> vertices[width];  //  96         of the triangles

  /// Whether a slot holds a triangle of its own: none that is repeated.
  bool is_in_use(std::size_t slot) const { return slot == 0 || triangle[slot] != triangle[slot - 1]; }
};
static_assert(sizeof(Leaf) == 272);

/// One bounding volume like those of ChildBounds, around all children of a node and relative to its origin.
struct MergedBounds {
  float center[3];
  float radius, half[3], normal[3], low, high;
  float turn;                       // a whole number, as SlabSides::turn
  float side_low[2], side_high[2];  // the intervals that SlabSides has, as lengths
  std::uint32_t is_elongated;       // 1, or 0: Node::elongated_slots
};

// --- bounds of a moving model: one MovingNode for each node of its tree, one MovingLeaf for each leaf ---

/// Start and end of a motion. Bounds are stored for both; in between they are interpolated linearly, as vertices are.
inline constexpr std::uint32_t motion_ends = 2;

/// A box, along the axes of the world, at both ends: [end][axis]. In float64, without rounding.
struct MovingBox {
  double low[motion_ends][3], high[motion_ends][3];
};

/// The boxes of the children of a node, one child slot each. Slots beyond them repeat the last one.
struct alignas(64) MovingNode {
  double low[motion_ends][3][width], high[motion_ends][3][width];

  MovingBox box(std::uint32_t slot) const {
    MovingBox box;
    for (std::uint32_t end = 0; end < motion_ends; ++end) {
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        box.low[end][axis] = low[end][axis][slot], box.high[end][axis] = high[end][axis][slot];
      }
    }
    return box;
  }
};
static_assert(sizeof(MovingNode) == 768);

/// The corners of the triangles of a leaf at both ends, relative to a center, in multiples of a power of two, rounded
/// to float32. Each end has its own center and unit, because a leaf may grow by any factor. Coordinates are at most 1
/// in size.
struct alignas(64) MovingLeaf {
  float corner[motion_ends][9][width];  // 576 bytes   [end][3 * corner + axis][slot]
  double center[motion_ends][3];        //  48         world
  double unit[motion_ends];             //  16         the length that 1 stands for
};
static_assert(sizeof(MovingLeaf) == 640);

// --- trees of boxes ---

/// Up to `width` boxes along the axes, as a structure of arrays in float64. Slots beyond them are empty: low is
/// +infinity, high -infinity.
struct alignas(64) BoxNode {
  double low[3][width], high[3][width];
};
static_assert(sizeof(BoxNode) == 48 * width);

}  // namespace limber::bvh

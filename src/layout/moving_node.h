// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "layout/node.h"

/// Memory layout of the bounds of a moving model: one node for each node of its tree, one leaf for each leaf. All is
/// stored twice, for the start and for the end of the motion; in between it is interpolated linearly, as vertices are.
namespace limber::bvh {

/// Start and end of a motion.
inline constexpr std::uint32_t motion_ends = 2;

/// A box, along the axes of the world, at both ends: [end][axis]. In the mesh's length unit, without rounding.
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
  double center[motion_ends][3];        //  48         world, in the mesh's length unit
  double unit[motion_ends];             //  16         the length that 1 stands for
};
static_assert(sizeof(MovingLeaf) == 640);

}  // namespace limber::bvh

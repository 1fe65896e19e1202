// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>

#include "limber/base.h"
#include "limber/math.h"
#include "limber/mesh.h"

/// The unit of a tree: the length that 1 stands for in the float32 numbers of its nodes. A power of two near the
/// model's size, so that dividing by it is exact.
///
/// Too small a unit brings numbers near base::max_units = 2^60, beyond which float32 cannot square them. Too large a
/// unit costs speed only: bounds have an absolute error of 2^-60 units (base::smallest_corner_error), which prunes
/// nothing where gaps are smaller. Between the two there is room, so the unit follows the model's size late.
namespace limber::bvh {

/// By which factor the unit may be too large or too small before the next rebuild chooses another, which costs nothing.
inline constexpr double unit_ratio_until_rebuild = 0x1p10;

/// By which factor it may be too large or too small after a refit before the whole tree is fitted in another unit.
inline constexpr double unit_ratio_until_fit = 0x1p20;

/// How many units vertices may move between two refits before the unit is chosen anew ahead of the refit: 2^20 and this
/// many together stay far below base::max_units.
inline constexpr double units_moved_until_fit = 0x1p40;

/// The smallest power of two that is at least `size`, the size of a mesh whose coordinates are about `magnitude`; but
/// at least 2^-50 of the magnitude, since float64 resolves only 2^-53 of it, and at least 2^-900.
double unit_for(double size, double magnitude);

/// The bounding box of some triangles.
class BoundingBox {
 public:
  void add(const Triangle& t) {
    low_ = min(low_, min(min(t.v0, t.v1), t.v2));
    high_ = max(high_, max(max(t.v0, t.v1), t.v2));
  }
  void add(const BoundingBox& other) {
    low_ = min(low_, other.low_);
    high_ = max(high_, other.high_);
  }
  Vec3 center() const { return low_ * 0.5 + high_ * 0.5; }
  /// The unit of a tree over these triangles.
  double unit() const {
    const double size = length(high_ - low_);
    // Squares of very small sides underflow; twice the longest side is at least the diagonal.
    return unit_for(size > 0x1p-450 ? size : 2 * max_abs(high_ - low_), max_abs(low_));
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low_{infinity, infinity, infinity}, high_{-infinity, -infinity, -infinity};
};

/// The bounding box of a mesh, on the threads of the calling oneTBB arena; equal on any number of them. Allocates
/// nothing.
BoundingBox bounding_box_of(MeshView mesh);

}  // namespace limber::bvh

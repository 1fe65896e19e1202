// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "base/work_budget.h"
#include "bvh/tree.h"
#include "simd/kernels.h"

/// Partitions triangles into the leaves of a tree.
///
/// Based on  [Quinlan1994]: a median split across the longest side of the bounding box of the centers.
/// Differs   Up to eight children instead of two: halves of halves. The number of triangles alone decides the topology:
///           every subtree gets whole leaves, as few levels as possible, and children of nearly equal size, so
///           leaves and nodes are full nearly everywhere and all leaves are on one level. An odd number of children is
///           split into halves that differ by one child; what is called the median is where that is.
namespace limber::bvh {

/// A triangle to be put into a leaf.
struct PrimitiveRef {
  std::array<float, 3> center;  // of its bounding box, in units, relative to an origin that all share
  TriangleId triangle;
};

std::uint32_t leaf_count(std::size_t triangles);

/// The number of children of a node over that many leaves, with as few levels below it as possible.
std::uint32_t child_count(std::uint32_t leaves);

/// How many of `leaves` leaves the first half of the children gets.
std::uint32_t first_half_leaves(std::uint32_t leaves, std::uint32_t children);

/// A range of primitives, in the order of the leaves, still to be partitioned among `children` nodes.
struct BuildRange {
  std::size_t begin, end;
  std::uint32_t children;
};

/// Splits a range: moves the primitives of the first half of the children before those of the second. Does so step by
/// step, with the same result whatever the steps.
///
/// Cost     O(primitives in the range), a few passes over them.
class Split {
 public:
  /// Pre: range.children > 1.
  explicit Split(const BuildRange& range);

  /// Goes on within a budget, always with the same primitives. Returns whether the range is split.
  bool work(std::span<PrimitiveRef> primitives, base::WorkBudget& budget);
  /// Pre: it is split.
  std::array<BuildRange, 2> halves() const;

 private:
  // The median is found by its key: the coordinate, then the triangle, as one number. A sample tells two limits between
  // which it is likely to be: the primitives below the lower one are moved before the others, and of these the ones
  // below the upper one before the rest. This is repeated where the median is until few primitives are left. Limits are
  // compared with coordinates, which is faster, or with keys where that has left too many primitives.
  enum class Step { measuring, sampling, moving_below, moving_between, finishing, done };

  struct Limit {
    std::uint64_t key;
    float coordinate;
  };

  std::uint64_t key(const PrimitiveRef& primitive) const;
  void choose_axis();
  void search(std::size_t begin, std::size_t end);
  void sample(std::span<const PrimitiveRef> primitives);
  /// Of the primitives from done_ on, moves those below a limit to where those end that have been moved there.
  std::size_t move_below(std::span<PrimitiveRef> primitives, std::size_t first_end, std::size_t end,
                         const Limit& limit) const;
  void finish(std::span<PrimitiveRef> primitives);

  BuildRange range_;
  std::size_t middle_;       // where the second half begins
  std::size_t begin_, end_;  // what may still have to be moved across the middle
  Step step_ = Step::measuring;
  std::size_t done_;    // the next primitive of the present step
  simd::PointBox box_;  // of the centers
  std::size_t axis_ = 0;
  std::uint64_t random_;  // changes with every number that is drawn
  Limit lower_{}, upper_{};
  bool moves_by_key_ = false;
  std::size_t below_ = 0, between_ = 0;  // while moving: where primitives below the lower limit end, and the upper one
};

/// Splits a range at once.
std::array<BuildRange, 2> split(std::span<PrimitiveRef> primitives, const BuildRange& range);

/// The range of a node over these primitives.
BuildRange build_range(std::size_t begin, std::size_t end);

/// Partitions a range down to leaves, on the threads of the calling oneTBB arena.
///
/// Cost     O(n log n).
void partition_into_leaves(std::span<PrimitiveRef> primitives, const BuildRange& range);

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
    return unit_for(size > 0x1p-450 ? size : 2 * max_abs(high_ - low_), max_abs(low_));  // squares may vanish
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low_{infinity, infinity, infinity}, high_{-infinity, -infinity, -infinity};
};
/// The same on any number of threads. Allocates nothing.
BoundingBox bounding_box_of(MeshView mesh);

/// The primitive of a triangle, its center relative to `origin` in units. `half_per_unit` is 0.5 / unit.
inline PrimitiveRef primitive_of(MeshView mesh, TriangleId triangle, const Vec3& origin, double half_per_unit) {
  const Corners& corners = mesh.triangles[triangle];
  const Vec3 &u = mesh.positions[corners[0]], &v = mesh.positions[corners[1]], &w = mesh.positions[corners[2]];
  const auto center = [&](double a, double b, double c, double from) {
    const double low = std::min(std::min(a, b), c), high = std::max(std::max(a, b), c);
    return static_cast<float>(((low - from) + (high - from)) * half_per_unit);
  };
  return {{center(u.x, v.x, w.x, origin.x), center(u.y, v.y, w.y, origin.y), center(u.z, v.z, w.z, origin.z)},
          triangle};
}

/// Writes primitives, one to `width`, into a leaf, the triangles in ascending order; slots beyond the last repeat it.
void write_leaf(Leaf& leaf, MeshView mesh, std::span<const PrimitiveRef> primitives);

/// The primitives of leaf `i`, where each leaf takes the next `width` of them.
std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i);

/// An assignment id that no tree has had.
std::uint64_t new_build_id();

}  // namespace limber::bvh

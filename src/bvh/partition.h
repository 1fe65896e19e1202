// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "base/work_budget.h"
#include "bvh/tree.h"
#include "simd/kernels.h"

/// Partitions triangles into the leaves of a tree.
///
/// Based on  [Quinlan1994]: a median split perpendicular to the longest side of the bounding box of the centers; and
///           [FloydRivest1975] to find the median. Few triangles, those of a lowest node, are split along the best of
///           several axes (partition_few()).
/// Differs   Up to eight children instead of two: halves of halves. The number of triangles alone decides the topology:
///           every subtree gets whole leaves, as few levels as possible, and children of nearly equal size, so
///           leaves and nodes are full nearly everywhere and all leaves are on one level. An odd number of children is
///           split into halves that differ by one child, so the "median" is at the rank where the second half begins.
namespace limber::bvh {

/// A triangle to be put into a leaf.
struct PrimitiveRef {
  std::array<float, 3> center;  // of its bounding box, in units, relative to one origin for all primitives
  TriangleId triangle;
};

/// Half the sides of the bounding box of a triangle, in units.
using HalfSides = std::array<float, 3>;

/// What primitives are made from: the triangles of a mesh, relative to `origin`, in units. `half_per_unit` is 0.5 /
/// unit, the factor from the sum of two coordinates to their middle in units.
struct PrimitiveSource {
  MeshView mesh;
  Vec3 origin;
  double half_per_unit;

  /// The primitive of a triangle. Sets the half sides of its box.
  PrimitiveRef primitive_of(TriangleId triangle, HalfSides& half_sides) const {
    const Corners& corners = mesh.triangles[triangle];
    const Vec3 &u = mesh.positions[corners[0]], &v = mesh.positions[corners[1]], &w = mesh.positions[corners[2]];
    PrimitiveRef primitive{{}, triangle};
    const auto set = [&](std::size_t axis, double a, double b, double c, double from) {
      const double low = std::min(std::min(a, b), c), high = std::max(std::max(a, b), c);
      primitive.center[axis] = static_cast<float>(((low - from) + (high - from)) * half_per_unit);
      half_sides[axis] = static_cast<float>((high - low) * half_per_unit);
    };
    set(0, u.x, v.x, w.x, origin.x), set(1, u.y, v.y, w.y, origin.y), set(2, u.z, v.z, w.z, origin.z);
    return primitive;
  }
};

/// How many leaves hold that many triangles; all but the last are full.
std::uint32_t leaf_count(std::size_t triangles);

/// The number of children of a node over that many leaves, with as few levels below it as possible.
std::uint32_t child_count(std::uint32_t leaves);

/// How many of `leaves` leaves the first half of the children gets: its share, rounded down. If all children
/// together can hold the leaves in as few levels as possible, each half then can, too: a child that holds at most
/// `full` leaves has an average share of at most `full`, so c children get at most c * full.
std::uint32_t first_half_leaves(std::uint32_t leaves, std::uint32_t children);

/// A range of primitives, in the order of the leaves, still to be partitioned among `children` children of one node. If
/// that is 1, the range is a single leaf.
struct BuildRange {
  std::size_t begin, end;
  std::uint32_t children;
};

/// Where the second half of the children of a range begins. Pre: it has several.
std::size_t middle_of(const BuildRange& range);
/// Both halves of a range.
std::array<BuildRange, 2> halves_of(const BuildRange& range, std::size_t middle);

/// Splits a range: moves the primitives of the first half of the children before those of the second. A budget may
/// interrupt it many times, which does not change the result.
///
/// Cost     O(primitives in the range), a few passes over them.
class Split {
 public:
  /// Pre: range.children > 1.
  explicit Split(const BuildRange& range);

  /// Goes on within a budget; every call takes the same primitives. Returns whether the range is split.
  bool work(std::span<PrimitiveRef> primitives, base::WorkBudget& budget);
  /// Pre: work() has returned true.
  std::array<BuildRange, 2> halves() const;

 private:
  // The algorithm is at the head of partition.cpp.
  enum class Phase { measuring, sampling, moving_below, moving_between, finishing, done };

  /// What primitives are compared with: those below it are moved. As a key, and as a coordinate.
  struct Limit {
    std::uint64_t key;
    float coordinate;
  };

  std::uint64_t key(const PrimitiveRef& primitive) const;
  void choose_axis();
  void continue_within(std::size_t begin, std::size_t end);
  void narrow_to(std::size_t begin, std::size_t end);
  void draw_limits(std::span<const PrimitiveRef> primitives);
  std::size_t move_below(std::span<PrimitiveRef> primitives, std::size_t below_end, std::size_t end,
                         const Limit& limit) const;
  void finish(std::span<PrimitiveRef> primitives);

  BuildRange range_;
  std::size_t middle_;       // where the second half begins: the rank of the median
  std::size_t begin_, end_;  // the window: the primitives from begin_ to end_ may still have to change halves
  Phase phase_ = Phase::measuring;
  std::size_t next_;    // the next primitive of the present pass over the window
  simd::PointBox box_;  // of the centers
  std::size_t axis_ = 0;
  std::uint64_t random_;  // the last random number
  Limit lower_{}, upper_{};
  bool compares_keys_ = false;           // else coordinates, which is faster
  std::size_t below_ = 0, between_ = 0;  // ends of what has been moved below the lower limit, and below the upper one
};

/// Splits a range without interruption.
std::array<BuildRange, 2> split(std::span<PrimitiveRef> primitives, const BuildRange& range);

/// A range of primitives that are all those below one node, to be partitioned among its children; or a single leaf.
BuildRange build_range(std::size_t begin, std::size_t end);

/// Partitions a range down to leaves, on the threads of the calling oneTBB arena. `half_sides` are those of all
/// triangles of the mesh, by id.
///
/// Cost     O(n log n).
void partition_into_leaves(std::span<PrimitiveRef> primitives, const BuildRange& range,
                           std::span<const HalfSides> half_sides);

/// Writes primitives, one to `width`, into a leaf, the triangles in ascending order; slots beyond the last repeat it.
void write_leaf(Leaf& leaf, MeshView mesh, std::span<const PrimitiveRef> primitives);

/// The primitives of leaf `i`, where each leaf takes the next `width` of them.
std::span<const PrimitiveRef> primitives_of_leaf(std::span<const PrimitiveRef> primitives, std::size_t i);

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "tree/node.h"

/// Who comes to lie next to whom in a tree.
///
/// Based on  [Quinlan1994]'s division into equal halves across the longest side.
/// Differs   Eight children instead of two: halves of halves. The number of triangles alone decides the shape: every
///           subtree gets whole leaves, as few levels as will do, and children of equal size, so leaves and blocks are
///           full nearly everywhere and all leaves are on one level.
namespace limber::tree {

/// A triangle as it is moved around.
struct Item {
  std::array<float, 3> middle;
  TriangleId triangle;
};

std::uint32_t leaf_count(std::size_t triangles);

/// How many children a node over that many leaves has: as few full ones as will do.
std::uint32_t child_count(std::uint32_t leaves);

/// Of `leaves` to be shared by `children`, those of the first half of the children.
std::uint32_t first_share(std::uint32_t leaves, std::uint32_t children);

/// Items that lie next to each other in the order of the leaves, still to be divided among `children` nodes.
struct Part {
  std::size_t begin, end;
  std::uint32_t children;
};

/// Puts the items of the first half of the children before those of the second; two parts are left. Pre: children > 1.
///
/// Cost     O(items).
std::array<Part, 2> halve(std::span<Item> items, const Part& part);

/// The part of a node over these items.
Part part_of(std::size_t begin, std::size_t end);

/// Divides all the way down to leaves, on the threads of the calling oneTBB arena.
///
/// Cost     O(n log n).
void sort_into_leaves(std::span<Item> items, const Part& part);

/// The box around some triangles.
class Extent {
 public:
  void put(const Triangle& t) {
    low_ = min(low_, min(min(t.v0, t.v1), t.v2));
    high_ = max(high_, max(max(t.v0, t.v1), t.v2));
  }
  Vec3 middle() const { return low_ * 0.5 + high_ * 0.5; }
  /// Length of 1 that suits it.
  double unit() const {
    const double size = length(high_ - low_);
    return unit_for(size > 0x1p-450 ? size : 2 * max_abs(high_ - low_), max_abs(low_));  // squares may vanish
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec3 low_{infinity, infinity, infinity}, high_{-infinity, -infinity, -infinity};
};
Extent extent_of(MeshView mesh);

/// A triangle; its middle is relative to `origin`, as a multiple of `unit`.
Item item_of(MeshView mesh, TriangleId triangle, const Vec3& origin, double unit);

/// Writes the items into leaves, from leaf `first` on; lanes beyond the last item repeat it.
void write_leaves(Tree& tree, MeshView mesh, std::uint32_t first, std::span<const Item> items);

/// Another identity, which no tree has had.
std::uint64_t new_id();

}  // namespace limber::tree

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "query/placed_models.h"

namespace limber::query {

/// A triangle in the world.
struct PlacedTriangle {
  TriangleId id;
  Triangle corners;
};

/// The triangles of a leaf in the world, each placed when it is first asked for.
class PlacedLeaf {
 public:
  PlacedLeaf(const PlacedModels& placed, Side side, const bvh::Leaf& leaf)
      : placed_(placed), side_(side), leaf_(leaf) {}

  TriangleId id(std::uint32_t slot) const { return leaf_.triangle[slot]; }
  /// Whether a slot is not in use: it repeats the triangle of the one before.
  bool is_repeated(std::uint32_t slot) const { return slot > 0 && leaf_.triangle[slot] == leaf_.triangle[slot - 1]; }
  const PlacedTriangle& at(std::uint32_t slot) {
    PlacedTriangle& triangle = triangles[slot];
    if ((placed_slots_ >> slot & 1) == 0) {
      placed_slots_ |= 1U << slot;
      triangle = {leaf_.triangle[slot], placed_.triangle(side_, leaf_.triangle[slot])};
    }
    return triangle;
  }

 private:
  const PlacedModels& placed_;
  Side side_;
  const bvh::Leaf& leaf_;
  unsigned placed_slots_ = 0;  // bit mask
  union {
    PlacedTriangle triangles[bvh::width];  // uninitialized until they are placed
  };
};

}  // namespace limber::query

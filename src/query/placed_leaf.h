// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "query/placed_pair.h"

namespace limber::query {

/// A triangle in the world.
struct PlacedTriangle {
  TriangleId id;
  Triangle corners;
};

/// The triangles of a leaf in the world, each placed when it is first asked for.
class PlacedLeaf {
 public:
  PlacedLeaf(const PlacedPair& placed, Side side, const tree::Leaf& leaf) : placed_(placed), side_(side), leaf_(leaf) {}

  TriangleId id(std::uint32_t lane) const { return leaf_.triangle[lane]; }
  const PlacedTriangle& at(std::uint32_t lane) {
    PlacedTriangle& triangle = placed_triangles[lane];
    if ((placed_lanes_ >> lane & 1) == 0) {
      placed_lanes_ |= 1U << lane;
      triangle = {leaf_.triangle[lane], placed_.triangle(side_, leaf_.triangle[lane])};
    }
    return triangle;
  }

 private:
  const PlacedPair& placed_;
  Side side_;
  const tree::Leaf& leaf_;
  unsigned placed_lanes_ = 0;  // bits
  union {
    PlacedTriangle placed_triangles[simd::width];  // left as they are until they are placed
  };
};

}  // namespace limber::query

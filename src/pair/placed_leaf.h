// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>

#include "pair/placed_pair.h"

namespace limber::pair {

/// A triangle in the world.
struct PlacedTriangle {
  TriangleId id;
  Triangle corners;
};

/// Pre: placed.has_triangle(s, t).
inline PlacedTriangle placed_triangle(const PlacedPair& placed, Side s, TriangleId t) {
  return {t, placed.triangle(s, t)};
}

/// The triangles of a leaf in the world, each placed when it is first asked for.
class PlacedLeaf {
 public:
  PlacedLeaf(const PlacedPair& placed, Side side) : placed_(placed), side_(side) {}

  /// Goes on to a leaf. What is known of it stays if it is the same as before. Pre of all that follows: there is one.
  void take(const bvh::Leaf& leaf) {
    if (&leaf == leaf_) return;
    leaf_ = &leaf;
    placed_slots_ = supported_slots_ = 0;
    has_support_ = false;
  }

  TriangleId id(std::uint32_t slot) const { return leaf_->triangle[slot]; }
  /// The support of a triangle along a direction of its model's frame, computed when it is first asked for, until
  /// another direction comes: each has its own number.
  double support(std::uint32_t slot, const Vec3& direction, std::uint32_t number) {
    if (number != direction_number_) direction_number_ = number, supported_slots_ = 0, has_support_ = false;
    if ((supported_slots_ >> slot & 1) == 0) {
      supported_slots_ |= 1U << slot;
      supports_[slot] = support_of(slot, direction);
    }
    return supports_[slot];
  }
  /// The support of the whole leaf, which is the largest of its triangles' supports.
  double support(const Vec3& direction, std::uint32_t number) {
    if (number == direction_number_ && has_support_) return support_;
    direction_number_ = number, supported_slots_ = (1U << bvh::width) - 1, has_support_ = true;
    for (std::uint32_t slot = 0; slot < bvh::width; ++slot) supports_[slot] = support_of(slot, direction);
    support_ = *std::max_element(supports_, supports_ + bvh::width);
    return support_;
  }
  const PlacedTriangle& at(std::uint32_t slot) {
    PlacedTriangle& triangle = triangles[slot];
    if ((placed_slots_ >> slot & 1) == 0) {
      placed_slots_ |= 1U << slot;
      triangle = {leaf_->triangle[slot], placed_.triangle(side_, leaf_->vertices[slot])};
    }
    return triangle;
  }

 private:
  double support_of(std::uint32_t slot, const Vec3& direction) const {
    // Vertices where they are: copies would go through memory.
    const auto height = [&](VertexId v) { return dot(direction, placed_.local_position(side_, v)); };
    const std::array<VertexId, 3>& v = leaf_->vertices[slot];
    return std::max(std::max(height(v[0]), height(v[1])), height(v[2]));
  }

  const PlacedPair& placed_;
  Side side_;
  const bvh::Leaf* leaf_ = nullptr;
  unsigned placed_slots_ = 0, supported_slots_ = 0;  // bit masks
  std::uint32_t direction_number_ = 0;
  bool has_support_ = false;
  double support_ = 0;
  double supports_[bvh::width];
  union {
    PlacedTriangle triangles[bvh::width];  // uninitialized until they are placed
  };
};

}  // namespace limber::pair

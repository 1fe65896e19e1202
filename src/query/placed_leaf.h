// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
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
  PlacedLeaf(const PlacedModels& placed, Side side) : placed_(placed), side_(side) {}

  /// Goes on to a leaf. What is known of it stays if it is the same as before. Pre of all that follows: there is one.
  void take(const bvh::Leaf& leaf) {
    if (&leaf == leaf_) return;
    leaf_ = &leaf;
    placed_slots_ = supported_slots_ = 0;
    has_support_ = false;
  }

  TriangleId id(std::uint32_t slot) const { return leaf_->triangle[slot]; }
  /// Whether a slot is not in use: it repeats the triangle of the one before.
  bool is_repeated(std::uint32_t slot) const { return slot > 0 && id(slot) == id(slot - 1); }
  /// The support of a triangle along a direction of its model's frame, computed when it is first asked for, until
  /// another direction comes: each has its own number.
  double support(std::uint32_t slot, const Vec3& direction, std::uint32_t number) {
    if (number != direction_number_) direction_number_ = number, supported_slots_ = 0, has_support_ = false;
    if ((supported_slots_ >> slot & 1) == 0) {
      supported_slots_ |= 1U << slot;
      const Triangle t = placed_.local_triangle(side_, leaf_->vertices[slot]);
      supports_[slot] = std::max({dot(direction, t.v0), dot(direction, t.v1), dot(direction, t.v2)});
    }
    return supports_[slot];
  }
  /// The same for all triangles.
  double support(const Vec3& direction, std::uint32_t number) {
    if (number == direction_number_ && has_support_) return support_;
    support_ = support(0, direction, number);
    for (std::uint32_t slot = 1; slot < bvh::width; ++slot) {
      support_ = std::max(support_, support(slot, direction, number));
    }
    has_support_ = true;
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
  const PlacedModels& placed_;
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

}  // namespace limber::query

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

#include "base/check.h"
#include "geometry/primitives.h"
#include "simd/kernels.h"

namespace limber::geometry {

/// Closest features, and what a normal is made of.
struct FeaturesAndDirection {
  ClosestFeatures closest;
  Vec3 a_to_b;  ///< from point_a to point_b in a frame of any scale, with digits that the points may not have
  bool are_proven_apart = false;  ///< `a_to_b` is the normal of a plane that separates the triangles, beyond rounding
};

FeaturesAndDirection features_and_direction(const Triangle& a, const Triangle& b);

/// A few pairs of triangles whose contacts are found together. What a pair gets does not depend on the others.
class ContactBatch {
 public:
  static constexpr std::uint32_t room = simd::TrianglePairs::room;

  std::uint32_t size() const { return size_; }
  void clear() { size_ = crossings_.are_certain = 0, has_overlaps_ = false; }
  /// Pre: size() < room, and nothing has been found since clear().
  void add(const Triangle& a, const Triangle& b, OrientedFaces oriented) {
    LIMBER_ASSERT(size_ < room && !has_overlaps_);
    for (std::size_t k = 0; k < 3; ++k) pairs_.a[k][size_] = a[k], pairs_.b[k][size_] = b[k];
    pairs_.has_outside_a[size_] = oriented == OrientedFaces::both || oriented == OrientedFaces::of_a ? 1 : 0;
    pairs_.has_outside_b[size_] = oriented == OrientedFaces::both || oriented == OrientedFaces::of_b ? 1 : 0;
    oriented_[size_++] = oriented;
  }
  /// Finds all pairs that cross for certain, if some pair seems to cross: contact() is faster for these.
  void find_crossings();
  /// The contact of pair i, to the bit that of geometry::contact(). Pre: i < size().
  TriangleContact contact(std::uint32_t i, double farthest);

 private:
  Triangle a(std::uint32_t i) const { return {pairs_.a[0][i], pairs_.a[1][i], pairs_.a[2][i]}; }
  Triangle b(std::uint32_t i) const { return {pairs_.b[0][i], pairs_.b[1][i], pairs_.b[2][i]}; }
  /// The points and features of pair i, which crosses for certain.
  ClosestFeatures crossing(std::uint32_t i) const;
  /// Sets normal, side and depth of pair i, which intersects.
  void separate(std::uint32_t i, TriangleContact& contact);

  simd::TrianglePairs pairs_;
  OrientedFaces oriented_[room]{};
  simd::Crossings crossings_;
  simd::LeastOverlaps overlaps_;
  bool has_overlaps_ = false;
  std::uint32_t size_ = 0;
};

}  // namespace limber::geometry

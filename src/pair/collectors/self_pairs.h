// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "limber/distance.h"
#include "pair/collectors/closest_pair.h"
#include "pair/collectors/pairs.h"

namespace limber::pair {

/// The collector of self_collide(): any two triangles of a model that meet.
class AnySelfContact {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = true;

  explicit AnySelfContact(const PairsOfOne& pairs) : pairs_(pairs) {}

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return witness.has_value(); }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (b.id < a.id) return compare(b, a);
    if (pairs_.counts(a, b) && pairs_.meet(a, b)) {
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      witness = Witness{shared, shared, a.id, b.id};
    }
  }

  std::optional<Witness> witness;

 private:
  PairsOfOne pairs_;
};

/// The collector of self_distance(): the closest triangles of a model that are no neighbors, or that meet.
class ClosestSelfPair {
 public:
  static constexpr Hits hits = Hits::k_closest;
  static constexpr bool is_self = true;

  ClosestSelfPair(const PairsOfOne& pairs, const DistanceOptions& options) : closest(options, 0), pairs_(pairs) {}

  double initial_cutoff() const { return closest.initial_cutoff(); }
  bool is_done() const { return closest.is_done(); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b) || (pairs_.are_neighbors(a, b) && !pairs_.meet(a, b))) return std::nullopt;
    return closest.compare(a, b);
  }

  ClosestPair closest;

 private:
  PairsOfOne pairs_;
};

}  // namespace limber::pair

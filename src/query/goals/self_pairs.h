// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "query/goals/closest_pair.h"
#include "query/goals/pairs.h"

namespace limber::query {

/// The goal of self_collide(): any two triangles of a model that meet.
class AnySelfContact {
 public:
  static constexpr bool takes_any = true;
  static constexpr bool needs_all = true;
  static constexpr bool is_self = true;

  explicit AnySelfContact(const PairsOfOne& pairs) : pairs_(pairs) {}

  double initial_prune_distance() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return witness.has_value(); }

  std::optional<Improvement> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (b.id < a.id) return compare(b, a);
    if (pairs_.counts(a, b) && pairs_.meet(a, b)) {
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      witness = Witness{shared, shared, a.id, b.id};
    }
    return std::nullopt;
  }

  std::optional<Witness> witness;

 private:
  PairsOfOne pairs_;
};

/// The goal of self_distance(): the closest triangles of a model that are no neighbors, or that meet.
class ClosestSelfPair {
 public:
  static constexpr bool takes_any = false;
  static constexpr bool needs_all = true;
  static constexpr bool is_self = true;

  ClosestSelfPair(const PairsOfOne& pairs, const DistanceOptions& options) : closest(options, 0), pairs_(pairs) {}

  double initial_prune_distance() const { return closest.initial_prune_distance(); }
  bool is_done() const { return closest.is_done(); }

  std::optional<Improvement> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b) || (pairs_.are_neighbors(a, b) && !pairs_.meet(a, b))) return std::nullopt;
    return closest.compare(a, b);
  }

  ClosestPair closest;

 private:
  PairsOfOne pairs_;
};

}  // namespace limber::query

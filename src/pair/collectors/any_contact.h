// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <limits>
#include <optional>

#include "geometry/primitives.h"
#include "limber/distance.h"
#include "pair/collectors/collector.h"

namespace limber::pair {

/// The collector of collide(): any pair of triangles that intersects.
class AnyContact {
 public:
  static constexpr Hits hits = Hits::any;
  static constexpr bool is_self = false;

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return witness.has_value(); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (geometry::intersects(a.corners, b.corners)) {
      const Vec3 shared = geometry::shared_point(a.corners, b.corners);
      witness = Witness{shared, shared, a.id, b.id};
    }
    return std::nullopt;
  }

  std::optional<Witness> witness;
};

}  // namespace limber::pair

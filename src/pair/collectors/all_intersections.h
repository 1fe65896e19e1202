// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <optional>

#include "limber/contacts.h"
#include "pair/collectors/collector.h"

namespace limber::pair {

/// The collector of visit_intersections(): all pairs of triangles that meet. `Pairs` is PairsOfTwo or PairsOfOne.
template <typename Pairs>
class AllIntersections {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  AllIntersections(const Pairs& pairs, TrianglePairVisitor visit) : pairs_(pairs), visit_(visit) {}

  double initial_cutoff() const { return std::numeric_limits<double>::min(); }
  bool is_done() const { return is_stopped_; }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (pairs_.counts(a, b) && pairs_.meet(a, b)) ++count, is_stopped_ = !visit_({a.id, b.id});
  }

  std::size_t count = 0;

 private:
  Pairs pairs_;
  TrianglePairVisitor visit_;
  bool is_stopped_ = false;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "base/error_bounds.h"
#include "pair/bucket_queue.h"
#include "pair/placed_pair.h"
#include "simd/kernels.h"

namespace limber::pair {

/// The distance from which on pairs are pruned, squared and in the units of each tree, as bounds of nodes are.
class SquaredLimits {
 public:
  explicit SquaredLimits(const PlacedPair& placed) : placed_(placed) {
    const double ratio = placed.tree(Side::b).unit / placed.tree(Side::a).unit;
    to_a_sq_[1] = static_cast<float>(std::min(ratio * ratio, largest_unit_ratio_sq));
  }

  /// Takes another distance. False if it is the same as before.
  bool update(double distance) {
    LIMBER_ASSERT(distance > 0);
    if (distance == distance_) return false;
    distance_ = distance;
    for (const Side s : {Side::a, Side::b}) {
      const double units = distance / placed_.tree(s).unit;
      const double limit = std::min(units * units * (1 + base::storage_error), double{BucketQueue::no_limit_sq});
      // A positive limit never prunes a pair whose bound is 0.
      limit_sq_[index(s)] = std::max(static_cast<float>(limit), std::numeric_limits<float>::min());
    }
    return true;
  }

  /// In squared units of the tree of that side.
  float of(Side s) const { return limit_sq_[index(s)]; }
  /// In those of the bounds of pairs, which are the units of a.
  float of_pairs() const { return of(Side::a); }

  /// Converts the bound of a child from squared units of its tree to those of a, and raises it to that of its parent.
  float bound_of_child(Side s, float order, float parent) const {
    // Stays below `no_limit_sq` even where the product overflows, so that an infinite limit prunes nothing.
    return std::min(std::max(order * to_a_sq_[index(s)], parent), BucketQueue::largest_bound);
  }
  /// A bound in squared units of the tree of that side as a length, rounded down.
  double length_of(Side s, float bound_sq) const {
    return std::sqrt(static_cast<double>(bound_sq)) * placed_.tree(s).unit * double{base::squares_down};
  }
  /// The bound of a pair as a length, rounded down.
  double length_of_pair(float bound_sq) const { return length_of(Side::a, bound_sq); }
  /// A length as a bound of a pair, rounded down.
  float bound_of(double length) const {
    const double units = length / placed_.tree(Side::a).unit;
    return static_cast<float>(std::min(units * units * double{base::squares_down}, double{BucketQueue::largest_bound}));
  }

 private:
  // Larger squared ratios of units leave the range of float32.
  static constexpr double largest_unit_ratio_sq = 0x1p126;

  const PlacedPair& placed_;
  double distance_ = -1;
  float limit_sq_[2] = {0, 0};
  float to_a_sq_[2] = {1, 1};  // squared units of either tree in those of a
};

/// Candidates with a bound of at least this are pruned: their triangles are at least `distance` apart.
inline double limit_sq_of(const simd::Candidates& found, double distance) {
  const double limit = distance * found.scale + static_cast<double>(found.error);
  return limit * limit * double{base::squares_up};
}

}  // namespace limber::pair

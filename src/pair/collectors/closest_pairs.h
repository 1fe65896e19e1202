// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <tuple>

#include "base/check.h"
#include "pair/collectors/pairs_within.h"

namespace limber::pair {

/// The collector of closest_pairs(): the closest pairs of triangles at most a distance apart, as many as there is room
/// for.
template <typename Pairs>
class ClosestPairs {
 public:
  static constexpr Hits hits = Hits::k_closest;
  static constexpr bool is_self = Pairs::is_self;

  ClosestPairs(const Pairs& pairs, std::span<Contact> closest, double max_distance)
      : pairs_(pairs), closest_(closest), max_distance_(max_distance) {}

  /// Just above the limit: a pair exactly that far apart counts.
  double initial_cutoff() const { return std::nextafter(pairs_.core_limit(max_distance_), infinity); }
  /// Nothing is closer than a contact.
  bool is_done() const { return count == closest_.size() && (count == 0 || closest_.front().distance == 0); }

  std::optional<BoundUpdate> compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b)) return std::nullopt;
    const bool are_neighbors = pairs_.are_neighbors(a, b);
    if (are_neighbors && !pairs_.meet(a, b)) return std::nullopt;
    const bool is_full = count == closest_.size();
    const double farthest = is_full ? closest_.front().distance : max_distance_;
    const Contact contact = pairs_.of_bodies(
        {geometry::contact(a.corners, b.corners, pairs_.oriented(are_neighbors), pairs_.core_limit(farthest)), a.id,
         b.id});
    if (is_full ? contact.distance >= farthest : contact.distance > farthest) return std::nullopt;
    LIMBER_ASSERT(count <= closest_.size());
    // A heap with the farthest pair first.
    if (is_full) {
      std::pop_heap(closest_.begin(), closest_.end(), is_closer);
      closest_.back() = contact;
    } else {
      closest_[count++] = contact;
    }
    std::push_heap(closest_.begin(), closest_.begin() + static_cast<std::ptrdiff_t>(count), is_closer);
    if (count < closest_.size()) return std::nullopt;
    const double cutoff = pairs_.core_limit(closest_.front().distance);
    return BoundUpdate{cutoff, cutoff, contact.point_b - contact.point_a};
  }

  /// Puts the nearest first.
  void sort() { std::sort_heap(closest_.begin(), closest_.begin() + static_cast<std::ptrdiff_t>(count), is_closer); }

  std::size_t count = 0;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  static bool is_closer(const Contact& a, const Contact& b) {
    return std::tie(a.distance, a.triangle_a, a.triangle_b) < std::tie(b.distance, b.triangle_a, b.triangle_b);
  }

  Pairs pairs_;
  std::span<Contact> closest_;
  double max_distance_;
};

}  // namespace limber::pair

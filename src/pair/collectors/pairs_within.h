// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/check.h"
#include "geometry/triangle_contact.h"
#include "limber/contacts.h"
#include "pair/collectors/collector.h"

namespace limber::pair {

/// The collector of visit_contacts(): all pairs of triangles that meet or are at most a margin apart. `Pairs` is
/// PairsOfTwo or PairsOfOne.
template <typename Pairs>
class PairsWithin {
 public:
  static constexpr Hits hits = Hits::all;
  static constexpr bool is_self = Pairs::is_self;

  PairsWithin(const Pairs& pairs, double margin, ContactVisitor visit)
      : pairs_(pairs), margin_(margin), visit_(visit) {}

  /// Just above the margin: a pair exactly that far apart counts.
  double initial_cutoff() const { return std::nextafter(pairs_.core_limit(margin_), infinity); }
  bool is_done() const { return is_stopped_; }

  void compare(const PlacedTriangle& a, const PlacedTriangle& b) {
    if (is_self && b.id < a.id) return compare(b, a);
    if (!pairs_.counts(a, b)) return;
    const bool are_neighbors = pairs_.are_neighbors(a, b);
    if (are_neighbors && !pairs_.meet(a, b)) return;
    ids_[batch_.size()] = {a.id, b.id};
    batch_.add(a.corners, b.corners, pairs_.oriented(are_neighbors));
    if (batch_.size() == geometry::ContactBatch::room) finish();
  }
  /// Visits what has been compared since the last time.
  void finish() {
    if (batch_.size() == 0) return;
    batch_.find_crossings();
    const double limit = pairs_.core_limit(margin_);
    for (std::uint32_t i = 0; i < batch_.size() && !is_stopped_; ++i) {
      const Contact contact = pairs_.of_bodies({batch_.contact(i, limit), ids_[i].a, ids_[i].b});
      LIMBER_ASSERT(contact.distance >= 0 && contact.depth >= 0);
      if (contact.distance <= margin_) ++count, is_stopped_ = !visit_(contact);
    }
    batch_.clear();
  }

  std::size_t count = 0;

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();

  Pairs pairs_;
  double margin_;
  ContactVisitor visit_;
  geometry::ContactBatch batch_;
  TrianglePair ids_[geometry::ContactBatch::room];
  bool is_stopped_ = false;
};

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "geometry/triangle_contact.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "pair/collectors/collector.h"
#include "pair/placed_pair.h"

namespace limber::pair {

/// The pairs of triangles of two models, as collectors that need several see them.
class PairsOfTwo {
 public:
  static constexpr bool is_self = false;

  PairsOfTwo(const Placed& a, const Placed& b, const PairOptions& options)
      : filter_(options.filter),
        oriented_(options.oriented_faces.value_or(closed(a.model().mesh(), b.model().mesh()))),
        radii_(a, b) {}

  /// How far apart the triangles of a pair are at most whose distance is at most `distance`.
  double core_limit(double distance) const { return radii_.core_limit(distance); }

  bool counts(const PlacedTriangle& a, const PlacedTriangle& b) const { return !filter_ || (*filter_)(a.id, b.id); }
  /// Whether the pair shares a vertex, so that only what it has in common beyond that matters.
  bool are_neighbors(const PlacedTriangle&, const PlacedTriangle&) const { return false; }
  bool meet(const PlacedTriangle& a, const PlacedTriangle& b) const {
    return geometry::intersects(a.corners, b.corners);
  }
  /// Which triangles of a pair have an outside.
  OrientedFaces oriented(bool /*are_neighbors*/) const { return oriented_; }
  /// The contact of the bodies, given that of two of their triangles.
  Contact of_bodies(const Contact& contact) const { return radii_.contact(contact); }

 private:
  static OrientedFaces closed(const Mesh& a, const Mesh& b) {
    if (a.is_closed()) return b.is_closed() ? OrientedFaces::both : OrientedFaces::of_a;
    return b.is_closed() ? OrientedFaces::of_b : OrientedFaces::none;
  }

  std::optional<TrianglePairFilter> filter_;
  OrientedFaces oriented_;
  Radii radii_;
};

/// The pairs of triangles of one model.
class PairsOfOne {
 public:
  static constexpr bool is_self = true;

  PairsOfOne(const Mesh& mesh, const PairOptions& options)
      : mesh_(mesh),
        filter_(options.filter),
        is_oriented_(options.oriented_faces ? *options.oriented_faces != OrientedFaces::none : mesh.is_closed()) {}

  double core_limit(double distance) const { return distance; }
  bool counts(const PlacedTriangle& a, const PlacedTriangle& b) const { return !filter_ || (*filter_)(a.id, b.id); }
  bool are_neighbors(const PlacedTriangle& a, const PlacedTriangle& b) const {
    LIMBER_ASSERT(a.id != b.id);
    const Corners &ids_a = mesh_.triangles[a.id], &ids_b = mesh_.triangles[b.id];
    for (const VertexId v : ids_a) {
      if (v == ids_b[0] || v == ids_b[1] || v == ids_b[2]) return true;
    }
    return false;
  }
  bool meet(const PlacedTriangle& a, const PlacedTriangle& b) const {
    return geometry::meets_elsewhere(a.corners, mesh_.triangles[a.id], b.corners, mesh_.triangles[b.id]);
  }
  /// Neighbors that meet have been folded, so their outsides do not tell how to part them.
  OrientedFaces oriented(bool are_neighbors) const {
    return is_oriented_ && !are_neighbors ? OrientedFaces::both : OrientedFaces::none;
  }
  Contact of_bodies(const Contact& contact) const { return contact; }

 private:
  MeshView mesh_;
  std::optional<TrianglePairFilter> filter_;
  bool is_oriented_;
};

/// The collector of visit_intersections() and self_collide(): all pairs of triangles that meet. `Pairs` is PairsOfTwo
/// or PairsOfOne.
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
  Pairs pairs_;
  double margin_;
  ContactVisitor visit_;
  geometry::ContactBatch batch_;
  TrianglePair ids_[geometry::ContactBatch::room];
  bool is_stopped_ = false;
};

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
  static bool is_closer(const Contact& a, const Contact& b) {
    return std::tie(a.distance, a.triangle_a, a.triangle_b) < std::tie(b.distance, b.triangle_a, b.triangle_b);
  }

  Pairs pairs_;
  std::span<Contact> closest_;
  double max_distance_;
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

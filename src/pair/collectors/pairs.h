// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/check.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "limber/contacts.h"
#include "pair/placed_leaf.h"
#include "pair/radii.h"

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

}  // namespace limber::pair

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/check.h"
#include "geometry/primitives.h"
#include "geometry/shared_corners.h"
#include "limber/contacts.h"
#include "query/placed_leaf.h"

namespace limber::query {

/// The pairs of triangles of two models, as goals that need all of them see them.
class PairsOfTwo {
 public:
  static constexpr bool is_self = false;

  explicit PairsOfTwo(const PairOptions& options) : filter_(options.filter) {}

  bool counts(const PlacedTriangle& a, const PlacedTriangle& b) const { return !filter_ || (*filter_)(a.id, b.id); }
  /// Whether the pair shares a vertex, so that only what it has in common beyond that matters.
  bool are_neighbors(const PlacedTriangle&, const PlacedTriangle&) const { return false; }
  bool meet(const PlacedTriangle& a, const PlacedTriangle& b) const {
    return geometry::intersects(a.corners, b.corners);
  }

 private:
  const std::optional<TrianglePairFilter>& filter_;
};

/// The pairs of triangles of one model.
class PairsOfOne {
 public:
  static constexpr bool is_self = true;

  PairsOfOne(MeshView mesh, const PairOptions& options) : mesh_(mesh), filter_(options.filter) {}

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

 private:
  MeshView mesh_;
  const std::optional<TrianglePairFilter>& filter_;
};

}  // namespace limber::query

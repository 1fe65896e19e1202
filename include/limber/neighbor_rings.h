// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "limber/base.h"
#include "limber/mesh.h"

namespace limber {

/// Which triangles of a mesh are near each other along the surface: a TrianglePairFilter for self-queries, which widens
/// the exclusion of neighbors.
///
///   const limber::NeighborRings rings(cloth.mesh(), 2);
///   limber::self_contacts(cloth, 0.002, found, {.filter = rings});
///
/// Two triangles are near if a vertex of one and a vertex of the other are joined by a path of at most `edges` edges of
/// triangles; with 0 edges, if they share a vertex. Vertices are told apart by their ids. Near triangles do not count,
/// not even where they intersect.
///
/// Threads  Const functions may run concurrently.
class NeighborRings {
 public:
  /// Connectivity alone matters, so one object serves all shapes that a model takes.
  ///
  /// Throws   std::invalid_argument if the mesh has been moved from; std::bad_alloc.
  /// Cost     Time in proportion to the pairs of near triangles, 4 bytes for each of them: about 80 bytes a triangle of
  ///          a regular mesh with 1 edge, 150 with 2, 250 with 3. O(n^2) where a vertex belongs to many triangles.
  LIMBER_API NeighborRings(const Mesh& mesh, std::uint32_t edges);

  /// Whether two triangles are near. Every triangle is near itself.
  ///
  /// Throws   std::invalid_argument unless the mesh had both triangles.
  /// Cost     O(log of the triangles near one).
  LIMBER_API bool are_near(TriangleId a, TriangleId b) const;

  /// Whether a pair counts: the filter.
  bool operator()(TriangleId a, TriangleId b) const { return !are_near(a, b); }

  /// Of the mesh; 0 if the object has been moved from.
  std::size_t triangle_count() const { return begin_.empty() ? 0 : begin_.size() - 1; }
  /// Pairs of different triangles that are near, each once.
  std::size_t pair_count() const { return near_.size(); }

 private:
  std::vector<std::size_t> begin_;  // of each triangle's part of near_, and the end
  std::vector<TriangleId> near_;    // those with larger ids, ascending
};

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/refit.h"
#include "bvh/tree.h"
#include "limber/mesh.h"

namespace limber::model {

/// Squared displacements below this may have lost digits to underflow, or have become 0.
inline constexpr double smallest_square = 0x1p-960;

/// Lets vertices move a little before the bounds that contain them are refitted.
///
/// Based on  the source (docs/notation.md), whose loose bounds absorb small motions.
/// Differs   The bounds are not enlarged. They contain each vertex at its position at the last refit, of which this
///           class keeps a copy. Vertices may be a given margin away from there; queries allow for the slack, the
///           largest distance that occurs.
///
/// States   Off: the bounds contain the vertices where they are. On, from start() to stop(): where they were at the
///          last refit. A vertex within the margin is absorbed: it needs no refit. A vertex beyond it is marked: the
///          copy takes its present position at once, and its nodes become dirty, so that the next refit fits them.
class MotionMargin {
 public:
  bool is_on() const { return !fitted_.empty(); }

  /// Takes the present positions as those at the last refit. Throws std::bad_alloc; the margin is then off.
  void start(std::span<const Vec3> positions);
  void stop() { fitted_.clear(); }

  /// The mesh that the bounds contain, or will contain after the next refit.
  MeshView fitted_mesh(const Mesh& mesh) const { return is_on() ? MeshView{fitted_, mesh.triangles()} : mesh.view(); }

  /// An upper bound of the distance of any vertex from its position at the last refit.
  double slack() const;

  /// Marks those of some moved vertices that are beyond the margin, and counts the others as absorbed.
  ///
  /// Pre      is_on(), dirty.has_vertex_index().
  void mark_beyond(const Mesh& mesh, std::span<const VertexId> ids, double margin, bvh::DirtySet& dirty);

  /// Marks all vertices beyond the margin, or every vertex once most of the tree is dirty. Afterwards slack() is exact
  /// up to rounding. Returns how many were marked; counts none as absorbed, because not all vertices may have moved.
  ///
  /// Pre      is_on().
  std::size_t mark_all_beyond(const Mesh& mesh, double margin, const bvh::Tree& tree, bvh::DirtySet& dirty);

  /// Marks every vertex, while it is off too: makes the whole tree dirty.
  void mark_everything(const Mesh& mesh, bvh::DirtySet& dirty);

  /// Whether slack(), still an upper bound, may be far too large: vertices may have moved back since it was exact.
  bool is_stale() const { return is_on() && moves_since_exact_ > fitted_.size(); }

  /// Moves that were absorbed since the last call of clear_counts().
  std::uint64_t absorbed_count() const { return absorbed_; }
  void count_absorbed(std::size_t moves) { absorbed_ += moves; }
  void clear_counts() { absorbed_ = 0; }

 private:
  void mark(const Mesh& mesh, VertexId vertex, bvh::DirtySet& dirty);

  std::vector<Vec3> fitted_;  // positions at the last refit, of marked vertices at the next; empty while it is off
  double farthest_sq_ = 0;    // at least the squared distance of any vertex from there; vertices may come back
  std::size_t moves_since_exact_ = 0;  // moves that mark_beyond() has looked at since farthest_sq_ was exact
  std::uint64_t absorbed_ = 0;
};

}  // namespace limber::model

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "bvh/dirty_set.h"
#include "bvh/tree.h"
#include "limber/mesh.h"

namespace limber::model {

/// Squared displacements below this have lost digits, or have become 0.
inline constexpr double smallest_square = 0x1p-960;

/// Lets vertices move a little before the bounds that hold them are refitted, like the margin of a fat bounding box.
///
/// Based on  the thesis this engine follows: loose bounds absorb small motions.
/// Differs   The bounds are not enlarged. They hold the positions at the last refit, one for each vertex. A vertex may
///           be a given margin away from its own; queries allow for the largest distance that occurs.
///
/// States   Off: the bounds hold the vertices themselves. On, from start() to stop(): they hold the positions at the
///          last refit. A vertex that is absorbed is within the margin and needs no refit; one that is refitted gets
///          its present position as the one at the last refit, and its nodes become dirty.
class MotionMargin {
 public:
  bool is_on() const { return !fitted_.empty(); }

  /// Takes the present positions as fitted. Throws std::bad_alloc; the margin is then off.
  void start(std::span<const Vec3> positions);
  void stop() { fitted_.clear(); }

  /// The mesh that the bounds are computed for.
  MeshView fitted(const Mesh& mesh) const { return is_on() ? MeshView{fitted_, mesh.triangles()} : mesh.view(); }

  /// At least the distance of any vertex from its position at the last refit.
  double largest_displacement() const;

  /// Absorbs or refits vertices that have moved.
  ///
  /// Pre      is_on(), dirty.has_vertex_index().
  void absorb(const Mesh& mesh, std::span<const VertexId> ids, double margin, bvh::DirtySet& dirty);

  /// Absorbs or refits every vertex. If all can be absorbed, none is refitted; once refits have made most of the tree
  /// dirty, all are. Afterwards largest_displacement() is exact up to rounding. Returns how many were refitted.
  ///
  /// Pre      is_on().
  std::size_t absorb_all(const Mesh& mesh, double margin, const bvh::Tree& tree, bvh::DirtySet& dirty);

  /// Refits every vertex: makes the whole tree dirty.
  void refit_all(const Mesh& mesh, bvh::DirtySet& dirty);

  /// Whether vertices have moved back so often that largest_displacement() may have become far too large.
  bool is_stale() const { return is_on() && moves_since_exact_ > fitted_.size(); }

  /// Moves that were absorbed since the last call of clear_counts().
  std::uint64_t absorbed_count() const { return absorbed_; }
  void count_absorbed(std::size_t moves) { absorbed_ += moves; }
  void clear_counts() { absorbed_ = 0; }

 private:
  void refit(const Mesh& mesh, VertexId vertex, bvh::DirtySet& dirty);

  std::vector<Vec3> fitted_;  // empty while the margin is off
  double farthest_sq_ = 0;    // from its position at the last refit
  std::size_t moves_since_exact_ = 0;
  std::uint64_t absorbed_ = 0;
};

}  // namespace limber::model

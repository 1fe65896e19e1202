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
#include "limber/model.h"
#include "model/rebuild_scheduler.h"

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

/// Keeps a tree up to date with the vertices of its model: collects moves, and repairs the tree in commit().
///
/// The work is done by three parts: the DirtySet knows which nodes to refit, the MotionMargin absorbs small moves, the
/// RebuildScheduler rebuilds what has degraded.
///
/// States   Up to date, or moved. A move or rebuild_all() makes it moved, a commit that ends makes it up to date.
/// Throws   The constructor, set_motion_margin() and rebuild_all() allocate; they change nothing when they throw
///          std::bad_alloc. Moves and commits do without what cannot be allocated: without the vertex index the whole
///          tree is fitted, and a partial rebuild waits for another commit. If oneTBB throws, a commit
///          ends half-way, and the next one does what is left.
class TreeUpdater {
 public:
  /// Allocates at once all that moves and commits will need if the options say so.
  TreeUpdater(bvh::Tree& tree, const Mesh& mesh, const ModelOptions& options);
  TreeUpdater(const TreeUpdater&) = delete;
  TreeUpdater& operator=(const TreeUpdater&) = delete;

  /// Takes effect with the next move or commit.
  void set_motion_margin(const Mesh& mesh, double margin);

  /// Moves some vertices of the mesh. Pre: check_update() accepts the update.
  void move(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions);
  /// Moves all vertices, by at most the square root of `farthest_sq` each. Pre: check_update_of_all() accepts the
  /// update.
  void move_all(Mesh& mesh, std::span<const Vec3> positions, double farthest_sq);

  /// Builds the whole tree anew. A commit has to follow before the next query.
  void rebuild_all(const Mesh& mesh);

  bool is_up_to_date() const { return !has_moved_; }
  void commit(const Mesh& mesh, MaintenanceStats& stats);

  /// The mesh that the bounds contain after a commit: with a motion margin, vertices at their positions at the last
  /// refit.
  MeshView fitted_mesh(const Mesh& mesh) const { return margin_.fitted_mesh(mesh); }

 private:
  void start_margin(const Mesh& mesh);
  void note_moves(std::size_t count, double farthest_sq);
  /// Builds the index of vertices if there is none. Returns false if memory is missing for it.
  bool ensure_vertex_index(const Mesh& mesh);
  void mark_without_margin(const Mesh& mesh, std::span<const VertexId> ids);
  double expected_ns() const;

  // Steps of a commit.
  void check_margin(const Mesh& mesh);
  void adapt_unit(const Mesh& mesh);
  void publish(std::uint64_t refits, MaintenanceStats& stats);

  bvh::Tree& tree_;
  bvh::DirtySet dirty_;
  MotionMargin margin_;
  RebuildScheduler rebuilds_;

  double margin_width_;  // how far vertices may be from their positions at the last refit, while margin_ is on
  bool has_moved_ = false;
  bool must_check_all_ = false;  // the margin has changed: some vertices may be beyond it

  // Since the last commit.
  std::uint64_t moves_ = 0;
  std::uint64_t whole_passes_ = 0;   // over all vertices or nodes; publish() adds the refit if it covers all nodes
  double sum_of_displacements_ = 0;  // the longest of each batch, added up: no vertex has moved farther
};

}  // namespace limber::model

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "bvh/refit.h"
#include "limber/model.h"
#include "model/motion_margin.h"
#include "model/rebuild_scheduler.h"

namespace limber::model {

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

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <future>
#include <optional>
#include <span>
#include <vector>

#include "limber/model.h"
#include "model/slack_tuner.h"
#include "tree/changes.h"
#include "tree/restructuring.h"

namespace limber {

/// How a tree follows the vertices of its model.
///
/// Based on  the thesis this engine follows: loose bounds absorb small motions.
/// Differs   Bounds are not made larger. They are fitted to anchors, one for each vertex; a vertex may leave its anchor
///           by a given slack, and queries allow for what the furthest has in fact gone.
///
/// Throws   Memory is taken by the constructor, set_slack() and restructure_all(), which change nothing when they throw
///          std::bad_alloc. Moves and commits do without what cannot be allocated: without the table of vertices all is
///          fitted, and what only makes later work cheaper waits for another commit. What oneTBB throws ends a commit
///          half-way; the next one does all that is left.
class Following {
 public:
  Following(tree::Tree& tree, const Mesh& mesh, const ModelOptions& options);
  ~Following();
  Following(const Following&) = delete;
  Following& operator=(const Following&) = delete;

  /// From the next move or commit on.
  void set_slack(const Mesh& mesh, double slack);

  /// Moves some vertices of the mesh, or all.
  void move(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions);
  /// `furthest_sq` is the longest way of a vertex, squared.
  void move_all(Mesh& mesh, std::span<const Vec3> positions, double furthest_sq);

  /// All of the tree, by the next commit.
  void restructure_all(const Mesh& mesh);

  bool is_up_to_date() const { return !has_moved_; }
  void commit(const Mesh& mesh, MaintenanceStats& stats);

  /// Where the bounds hold the vertices.
  MeshView anchored(const Mesh& mesh) const;
  /// What vertices may be away from there.
  double slack() const;

 private:
  /// Slack that is a good part of what leaves measure makes queries dearer than repairs.
  double most_worthwhile_slack() const;
  /// Whether to find out which blocks slack spares: now and then is enough.
  bool counts_spared() const { return tuned_commits_ % 4 == 0; }
  bool is_tuned() const { return chosen_slack_ == ModelOptions::automatic; }
  /// Whether the table of vertices is there, or could be made.
  bool finds_vertices(const Mesh& mesh);
  void note_step(double length_sq);
  void list(const Mesh& mesh, std::span<const VertexId> ids);
  void absorb_or_anchor(const Mesh& mesh, VertexId vertex);
  void start_anchors(const Mesh& mesh);
  void anchor(const Mesh& mesh, VertexId vertex);
  /// Moves all anchors, for everything to be fitted.
  void anchor_all(const Mesh& mesh);
  /// Moves the anchors of vertices that have gone too far, and finds the furthest of the others. Returns how many had.
  std::size_t anchor_far(const Mesh& mesh);

  /// Goes on with what is being restructured. Returns whether that has ended, and the leaves are others.
  bool restructure(const Mesh& mesh);
  /// Whether that was worth it, once all is fitted.
  void judge_restructuring(MaintenanceStats& stats);
  /// Whether as much has been refitted since that was last so as the tree has blocks.
  bool ends_pass(std::uint64_t refits);
  /// Starts to restructure what has become bad.
  void look_at_quality(const Mesh& mesh);
  /// Sorts on a thread of its own; in commits where none can be started.
  void start_worker();
  /// What the worker does. Returns whether all is sorted.
  bool sort_until_stopped();
  void stop_worker();
  double repairs_ahead_ns() const;
  /// Gives the tree the unit that suits the mesh, and has everything fitted.
  void measure_again(const Mesh& mesh);

  tree::Tree& tree_;
  tree::Changes changes_;
  bool has_moved_ = false;
  bool spares_all_ = false;  // whether all have moved, but not all were repaired for
  bool tightens_ = false;    // whether the slack has become less since vertices were last compared with it

  // Since the last commit: the longest way of a vertex in one batch, and those of all batches together.
  double longest_step_ = 0, all_steps_ = 0;

  double chosen_slack_;
  std::vector<Vec3> anchors_;                  // empty while there is no slack
  double furthest_sq_ = 0;                     // from its anchor
  std::size_t since_found_ = 0;                // vertices moved since that was exact
  std::uint64_t absorbed_ = 0, anchored_ = 0;  // since the last commit
  SlackTuner tuner_;
  std::uint64_t tuned_commits_ = 0;

  Restructuring restructuring_;
  double restructuring_us_;
  tree::Quality quality_;
  double passes_ = 0, passes_to_look_ = 0;  // over the tree: since it was restructured, until it is looked at again
  double tolerated_;                        // how much worse than expected the tree may be
  double interval_;                         // passes after which it is restructured all the same
  double before_ = 0;                       // measure of what is restructured, before that
  std::optional<tree::Restructuring> sorting_;
  std::atomic<bool> stops_worker_{false};
  std::future<bool> sorted_;  // by the worker, which is the only one to touch sorting_ in the meantime
  std::atomic<std::uint64_t> paid_{0};
};

}  // namespace limber

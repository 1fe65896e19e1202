// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "limber/mesh.h"
#include "limber/query.h"

/// The engine: models and the queries between them.
namespace limber {

namespace tree {
struct Tree;
}  // namespace tree
namespace query {
class Front;
}
class Following;

/// What becomes of a tree whose triangles have come to lie in another order.
enum class Restructuring {
  off,         ///< who is where stays as it was built
  in_commits,  ///< commits put the worst parts right, a little each
  on_worker,   ///< a thread of its own does, and a commit takes over the result; when is up to the scheduler
};

struct ModelOptions {
  static constexpr double automatic = -1;

  /// How far vertices may go before the tree follows them, a length in the model's frame. Finite and >= 0, or
  /// `automatic`: the model tries what costs least, repairs and what queries pay for the slack together. With 0, every
  /// commit() repairs all. Answers do not depend on it beyond rounding.
  double slack = 0;

  Restructuring restructuring = Restructuring::in_commits;
  /// Microseconds that one commit may spend on sorting triangles anew, as estimated from counts; a step, of up to 10 ns
  /// a triangle, is always ended. Finite and >= 0, where 0 leaves the tree as it is, or `automatic`: in proportion to
  /// what else the commit has to do.
  double restructuring_us = automatic;
};

struct TreeStats {
  std::uint32_t levels = 0;  ///< of nodes, the root's included; 1 + ceil(log8(leaves))
  std::size_t nodes = 0;
  std::size_t leaves = 0;  ///< of up to 8 triangles each
  std::size_t bytes = 0;   ///< without positions and triangles
};

/// Work done on the tree since the model was built.
struct MaintenanceStats {
  std::uint64_t moved_vertices = 0;  ///< vertices named by updates, repetitions included
  std::uint64_t refits = 0;          ///< blocks of up to eight nodes recomputed
  std::uint64_t absorbed = 0;        ///< moves that the slack made it unnecessary to repair for
  double extra_steps = 0;            ///< steps of queries that were due to the slack
  double slack = 0;                  ///< how far vertices may go now
  std::uint64_t restructured = 0;    ///< triangles put into leaves anew, to the next multiple of 8
};

/// A mesh and its bounding volume hierarchy. Vertices may move; triangles, and who belongs to whom, may not.
///
/// Threads  Const functions, queries included, may run concurrently on one model; updates need it alone.
/// Throws   Functions that allocate throw std::bad_alloc when they cannot; the model is then as before the call.
///          A model that has been moved from may be destroyed, assigned to and reset(); is_valid() and is_committed()
///          are false, every other function throws std::invalid_argument.
/// Source   docs/algorithms/bounds.md, docs/algorithms/bending.md.
class Model {
 public:
  /// Cost     O(n log n), on the threads of the calling oneTBB arena; the same tree on any number of them.
  /// Throws   std::invalid_argument if an option is not what its comment says, or `mesh` has been moved from.
  explicit Model(Mesh mesh, const ModelOptions& options = {});
  Model(Model&&) noexcept;
  /// Waits, as the destructor does, until a worker that sorts for the replaced model has stopped.
  Model& operator=(Model&&) noexcept;
  ~Model();

  /// Whether there is a mesh: false only once the model has been moved from.
  bool is_valid() const noexcept { return tree_ != nullptr; }

  /// Moves vertex `ids[i]` to `positions[i]`; later entries win where an id is repeated. The tree is repaired by
  /// commit().
  ///
  /// Frame    The model's own frame.
  /// Alias    `positions` may be a part of the model's own: they are read before any vertex moves.
  /// Errors   `size_mismatch`, `index_out_of_range`, `non_finite`, `too_large` with the entry's index; the model is
  ///          then exactly as before.
  /// Cost     O(entries); the first time, and the next after triangles have been put into leaves anew, also O(n).
  Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);

  /// Moves every vertex. Errors as move_vertices().
  Result<void> move_all(std::span<const Vec3> positions);

  /// Repairs the tree; afterwards the model may be queried. Does nothing when nothing has moved.
  ///
  /// Throws   No std::bad_alloc of its own: where memory or threads are missing, restructuring and slack wait for later
  ///          commits. If oneTBB throws, the model is not committed, and another commit() repairs what is left.
  /// Cost     O(what has moved and what lies above it), at most that of one pass over everything, on the threads of the
  ///          calling oneTBB arena. Restructuring, where motion has made it worthwhile, takes what its options say.
  void commit();
  /// Whether nothing has moved since the last commit().
  bool is_committed() const;

  /// A commit() after which the tree is as if just built, whatever the options say.
  ///
  /// Cost     O(n log n), on the threads of the calling oneTBB arena.
  void restructure();

  /// Replaces ModelOptions::slack, from the next move or commit on.
  ///
  /// Throws   std::invalid_argument if `slack` is not what the option's comment says.
  void set_slack(double slack);

  /// Starts over with another mesh, whatever its triangles, as a new model with the same options.
  ///
  /// Cost     As the constructor.
  /// Throws   As the constructor; the model is then exactly as before.
  void reset(Mesh mesh);

  const ModelOptions& options() const {
    require_valid("options");
    return options_;
  }
  MaintenanceStats maintenance_stats() const;

  const Mesh& mesh() const {
    require_valid("mesh");
    return mesh_;
  }
  TreeStats tree_stats() const;

  /// Checks every invariant of the tree against the positions.
  ///
  /// Errors   `broken_invariant`, naming the invariant's number and the node.
  /// Cost     O(n log n).
  Result<void> validate() const;

  /// The library's own view of the tree; its type is private.
  const tree::Tree& tree() const {
    require_valid("tree");
    return *tree_;
  }

 private:
  void require_valid(const char* function) const {
    if (!is_valid()) throw_moved_from(function);
  }
  [[noreturn]] static void throw_moved_from(const char* function);

  Following& following();

  Mesh mesh_;
  ModelOptions options_;
  std::unique_ptr<tree::Tree> tree_;
  std::unique_ptr<Following> following_;  // once a vertex has moved
  MaintenanceStats maintenance_;
};

/// A model and where it stands. Keeps a reference: the model must outlive it.
struct Placed {
  const Model& model;
  Transform pose{};  ///< world_from_model
};

/// What one query of two models found, for the next one of the same two to start from: the triangles it ended with, and
/// what it ruled out, which stays ruled out while the models have moved little. Answers never depend on it beyond what
/// the asked error and rounding allow; a pair that belongs to other models only costs time.
///
/// Cost     25 kB, allocated by the first query, which throws std::bad_alloc if it cannot, and then changes nothing.
/// Threads  One call at a time.
class Pair {
 public:
  Pair();
  Pair(Pair&&) noexcept;
  Pair& operator=(Pair&&) noexcept;
  ~Pair();

  /// Makes the next query start from nothing.
  void forget() { *this = Pair(); }

 private:
  friend class Start;
  TriangleId triangle_a_ = no_id, triangle_b_ = no_id;
  std::unique_ptr<query::Front> front_;
};

/// Whether two placed models meet; stops at the first intersecting pair found.
///
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid (is_rigid()).
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a Pair's memory.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/traversal.md.
CollideResult collide(const Placed& a, const Placed& b);
CollideResult collide(const Placed& a, const Placed& b, Pair& pair);

/// Shortest distance between two placed models, with a pair of points that attains it.
///
/// Promise  lower <= true distance <= upper, each up to the rounding that query.h states. upper is within either of the
///          asked errors. Contacts are found at every setting.
/// Overlap  If the models meet, lower == upper == 0 and both points coincide. Depth is not computed.
/// Limit    If nothing is as close as max_distance, lower is at least that, upper is infinite, the witness is empty.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, the errors are finite and
///          >= 0, and max_distance is >= 0 or infinite.
/// Cost     Output-sensitive in practice, O(n m) at worst. 40 kB of stack; allocates nothing but a Pair's memory.
/// Threads  Reentrant; any number of calls may share models.
/// Source   [Quinlan1994] for the error-bounded descent; docs/algorithms/traversal.md.
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, Pair& pair);

/// Whether two placed models are at most `max_distance` apart; stops at the first such pair of triangles found.
///
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and max_distance is finite
///          and >= 0.
/// Promise  True for a finite `upper` that distance() has returned for the same models, poses and order; for 0 true
///          exactly when the models meet. Where the distance is closer to `max_distance` than the rounding stated in
///          query.h, either answer may come.
/// Cost     As collide(), which is within() of 0.
WithinResult within(const Placed& a, const Placed& b, double max_distance);
WithinResult within(const Placed& a, const Placed& b, double max_distance, Pair& pair);

}  // namespace limber

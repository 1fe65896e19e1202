// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "limber/mesh.h"
#include "limber/query.h"

/// The engine: models and the queries between them.
namespace limber {

namespace tree {
struct Tree;
}
namespace query {
class Front;
}

struct TreeStats {
  std::uint32_t levels = 0;  ///< of nodes, the root's included; 1 + ceil(log8(leaves))
  std::size_t nodes = 0;
  std::size_t leaves = 0;  ///< of up to 8 triangles each
  std::size_t bytes = 0;   ///< without positions and triangles
};

/// A mesh and its bounding volume hierarchy.
///
/// Threads  Const functions, queries included, may run concurrently on one model.
/// Source   docs/algorithms/bounds.md.
class Model {
 public:
  /// Cost     O(n log n), on the threads of the calling oneTBB arena; the same tree on any number of them.
  explicit Model(Mesh mesh);
  Model(Model&&) noexcept;
  Model& operator=(Model&&) noexcept;
  ~Model();

  const Mesh& mesh() const { return mesh_; }
  TreeStats tree_stats() const;

  /// Checks every invariant of the tree against the positions.
  ///
  /// Errors   `broken_invariant`, naming the invariant's number and the node.
  /// Cost     O(n log n).
  Result<void> validate() const;

  /// The library's own view of the tree; its type is private.
  const tree::Tree& tree() const { return *tree_; }

 private:
  Mesh mesh_;
  std::unique_ptr<tree::Tree> tree_;
};

/// A model and where it stands. Keeps a reference: the model must outlive it.
struct Placed {
  const Model& model;
  Transform pose{};  ///< world_from_model
};

/// What one query of two models found, for the next one of the same two to start from: the triangles it ended with, and
/// what it ruled out, which stays ruled out while the models have moved little. Answers never depend on it beyond what
/// the asked error allows; a pair that belongs to other models only costs time.
///
/// Cost     25 kB, allocated by the first query.
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
/// Pre      Both poses are rigid.
/// Errors   None.
/// Cost     Output-sensitive in practice, O(n m) at worst. Does not allocate.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/traversal.md.
CollideResult collide(const Placed& a, const Placed& b);
CollideResult collide(const Placed& a, const Placed& b, Pair& pair);

/// Shortest distance between two placed models, with a pair of points that attains it.
///
/// Promise  lower <= true distance <= upper up to float64 rounding of the placed vertices. upper is within either of
///          the asked errors. Contacts are found at every setting.
/// Overlap  If the models meet, lower == upper == 0 and both points coincide. Depth is not computed.
/// Limit    If nothing is as close as max_distance, lower is at least that, upper is infinite, the witness is empty.
/// Pre      Both poses are rigid; the errors are finite and >= 0; max_distance >= 0, infinity allowed.
/// Errors   None.
/// Cost     Output-sensitive in practice, O(n m) at worst. Does not allocate.
/// Threads  Reentrant; any number of calls may share models.
/// Source   [Quinlan1994] for the error-bounded descent; docs/algorithms/traversal.md.
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options, Pair& pair);

/// Whether two placed models are at most `max_distance` apart; stops at the first such pair of triangles found.
///
/// Pre      Both poses are rigid; max_distance is finite and >= 0.
/// Cost     As collide(), which is within() of 0.
WithinResult within(const Placed& a, const Placed& b, double max_distance);
WithinResult within(const Placed& a, const Placed& b, double max_distance, Pair& pair);

}  // namespace limber

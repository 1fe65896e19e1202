// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <span>

#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/mesh.h"

/// The sphere tree of flexible models as it was first described: binary, one sphere per triangle, repaired in three
/// ways, optionally loose. Baseline of every benchmark and second oracle of every test.
namespace limber::classic {

/// When and in which order the spheres above moved triangles are recomputed.
enum class Maintenance {
  immediate,  ///< at once: every moved vertex refits the path from each of its triangles to the root
  batched,    ///< at commit(): every changed triangle, once, refits its path to the root
  by_depth,   ///< at commit(): deepest spheres first, every affected sphere exactly once
};

/// How much larger than needed a sphere is made when it is recomputed, so that it can absorb later motion.
struct Looseness {
  /// Extra radius as a fraction of the tight radius; 0 keeps every sphere tight and never absorbs.
  /// Between 0 and 100; it compounds from level to level.
  double extra_radius = 0;
  /// A sphere that still contains its content is kept while its radius is at most this many times the one it would be
  /// given now; above that it has grown stale and is recomputed. Between 1 and 1e6.
  double stale_ratio = 1.5;
};

struct ModelOptions {
  Maintenance maintenance = Maintenance::by_depth;
  Looseness looseness{};
};

/// Work done on the tree since the model was built.
struct MaintenanceStats {
  std::uint64_t moved_vertices = 0;  ///< vertices named by updates, repetitions included
  std::uint64_t refits = 0;          ///< spheres recomputed
  std::uint64_t absorbed = 0;        ///< spheres that were loose enough to stay, ending the way up
};

struct TreeStats {
  std::uint32_t depth = 0;  ///< edges between the root and the deepest leaf: ceil(log2 n)
  std::size_t nodes = 0;    ///< 2 n - 1
  std::size_t bytes = 0;    ///< of the tree and its maintenance tables, without positions and triangles
  double root_radius = 0;
};

/// A mesh and its sphere tree.
///
/// Shape    n triangles give 2 n - 1 spheres. Every triangle has one leaf; every inner sphere encloses the spheres of
///          its two children; the shape of the tree never changes when vertices move.
/// Threads  Const functions, queries included, may run concurrently on one model; updates need it alone.
/// Throws   Functions that allocate throw std::bad_alloc when they cannot; the model is then as before the call.
///          commit() allocates nothing. A model that has been moved from may be destroyed and assigned to; is_valid()
///          and is_committed() are false, every other function throws std::invalid_argument.
/// Source   docs/algorithms/classic_tree.md, docs/algorithms/classic_maintenance.md.
class Model {
 public:
  /// Cost     O(n log n), single-threaded.
  /// Throws   std::invalid_argument if a Looseness value is not what its comment says, or `mesh` has been moved from.
  LIMBER_API explicit Model(Mesh mesh, const ModelOptions& options = {});
  LIMBER_API Model(Model&&) noexcept;
  LIMBER_API Model& operator=(Model&&) noexcept;
  LIMBER_API ~Model();

  /// Whether there is a mesh: false only once the model has been moved from.
  bool is_valid() const noexcept { return tree_ != nullptr; }

  /// Moves vertex `ids[i]` to `positions[i]`; later entries win where an id is repeated.
  ///
  /// Frame    The model's own frame.
  /// Alias    `positions` may be a part of the model's own: they are read before any vertex moves.
  /// Errors   `size_mismatch`, `index_out_of_range`, `non_finite`, `too_large` with the entry's index; the model is
  ///          then exactly as before.
  /// Cost     Immediate: O(triangles at the vertices * depth). Otherwise O(triangles at the vertices).
  LIMBER_API Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);

  /// Moves every vertex. Errors as move_vertices().
  LIMBER_API Result<void> move_all(std::span<const Vec3> positions);

  /// Repairs the tree; afterwards the model may be queried. Does nothing when there is nothing to repair.
  LIMBER_API void commit();
  LIMBER_API bool is_committed() const;

  LIMBER_API const Mesh& mesh() const;
  LIMBER_API const ModelOptions& options() const;
  LIMBER_API MaintenanceStats maintenance_stats() const;
  LIMBER_API TreeStats tree_stats() const;

  /// Checks every invariant of the tree against the current positions.
  ///
  /// Errors   `broken_invariant`, naming the invariant's number and the node.
  /// Pre      The model is committed.
  /// Cost     O(n).
  LIMBER_API Result<void> validate() const;

  /// The library's own view of the tree; its type is private.
  const struct Tree& tree() const {
    require_valid("tree");
    return *tree_;
  }

 private:
  void require_valid(const char* function) const {
    if (!is_valid()) throw_moved_from(function);
  }
  [[noreturn]] LIMBER_API static void throw_moved_from(const char* function);

  std::unique_ptr<Tree> tree_;
};

/// A model and where it stands. Keeps a pointer: the model must outlive it.
class Placed {
 public:
  Placed(const Model& model, const Transform& world_from_model = {}) : pose(world_from_model), model_(&model) {}
  Placed(const Model&&, const Transform& = {}) = delete;  // would point to a temporary

  const Model& model() const { return *model_; }
  Transform pose;  ///< world_from_model

 private:
  const Model* model_;
};

/// Whether two placed models meet; stops at the first intersecting pair found.
///
/// Throws   std::invalid_argument unless both models are committed and both poses are rigid (is_rigid()).
/// Cost     Output-sensitive in practice, O(n m) at worst.
/// Threads  Reentrant; any number of calls may share models.
/// Source   docs/algorithms/classic_queries.md.
LIMBER_API CollideResult collide(const Placed& a, const Placed& b);

/// Shortest distance between two placed models, with a pair of points that attains it.
///
/// Promise  lower <= true distance <= upper up to float64 rounding of the placed vertices; upper is within either of
///          the asked errors. Contacts are found at every setting.
/// Overlap  If the models meet, lower == upper == 0 and both points coincide. Depth is not computed.
/// Limit    If nothing is as close as max_distance, lower is that, upper is infinite, and the witness is empty.
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and the options are as their
///          comments say.
/// Cost     Output-sensitive in practice, O(n m) at worst.
/// Threads  Reentrant; any number of calls may share models.
/// Source   [Quinlan1994] for the error-bounded descent; docs/algorithms/classic_queries.md.
LIMBER_API DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});

/// Whether two placed models are at most `max_distance` apart; stops at the first such pair of triangles found.
///
/// Throws   std::invalid_argument unless both models are committed, both poses are rigid, and max_distance is finite
///          and >= 0.
/// Cost     As distance().
LIMBER_API CollideResult within(const Placed& a, const Placed& b, double max_distance);

}  // namespace limber::classic

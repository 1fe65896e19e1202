// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "limber/mesh.h"

/// The engine: models and the queries between them.
namespace limber {

class MeshEdges;

/// When a tree is rebuilt in part, because motion has degraded it.
enum class RebuildPolicy {
  off,        ///< never: leaves keep their triangles
  in_commit,  ///< commits rebuild the subtrees that have degraded most, a little each
  on_worker,  ///< a worker thread does, and a commit takes over its result; which one depends on the scheduler
};

struct ModelOptions {
  static constexpr std::nullopt_t automatic = std::nullopt;

  /// How far a vertex may move before its bounds are refitted, like the margin of a fat bounding box; queries allow for
  /// the largest distance that occurs. A length in the model's frame, finite and >= 0. With 0, every commit() refits
  /// all that has moved. Answers do not depend on it beyond rounding. It pays for jitter, and for small moves all over
  /// the mesh: docs/design/deforming.md has measurements.
  double motion_margin = 0;

  RebuildPolicy rebuild_policy = RebuildPolicy::in_commit;
  /// Microseconds that one commit may spend on rebuilding, as estimated from counts; the step under way, of some 5 us,
  /// is always completed. Finite and >= 0, where 0 means that nothing is ever rebuilt, or `automatic`: in proportion to
  /// what else the commit does. With a worker, what is left to commits is to read the positions and to fit bounds.
  std::optional<double> rebuild_budget_us = automatic;
  /// Whether the constructor prepares all that moves, commits and rebuilds will need, and allocates and touches their
  /// memory: about three times that of the tree. Later calls then allocate nothing. Otherwise the first move and the
  /// first rebuild prepare what they need, in O(n).
  bool preallocate = false;

  /// For loops that must not be late: a move takes time in proportion to the vertices that it names, a commit to the
  /// nodes above them, plus the budget, in microseconds as above. docs/guide/deadlines.md says what is left to watch.
  static ModelOptions real_time(double rebuild_budget_us) {
    return {.motion_margin = 0,
            .rebuild_policy = RebuildPolicy::in_commit,
            .rebuild_budget_us = rebuild_budget_us,
            .preallocate = true};
  }
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
  std::uint64_t refits = 0;          ///< 8-nodes whose bounds were recomputed
  /// Times that a move or commit has gone over the whole tree, or over all vertices. Rebuilding in small steps, and
  /// surveys in proportion to refits, are not counted.
  std::uint64_t whole_passes = 0;
  std::uint64_t absorbed = 0;           ///< vertex moves that stayed within the motion margin and needed no refit
  double motion_margin = 0;             ///< the margin in use
  std::uint64_t rebuilt_triangles = 0;  ///< triangles assigned to leaves anew, to the next multiple of 8
  double rebuild_us = 0;                ///< what rebuilding has cost commits, in microseconds estimated from counts
};

/// A mesh and its bounding volume hierarchy. Vertices may move; connectivity is fixed.
///
/// Threads  Const functions, queries included, may run concurrently on one model; updates need it alone.
/// Throws   Functions that allocate throw std::bad_alloc when they cannot; the model is then as before the call.
///          A model that has been moved from may be destroyed, assigned to and reset(); is_valid() and is_committed()
///          are false, every other function throws std::invalid_argument.
/// Source   docs/algorithms/bounds.md, docs/algorithms/deforming.md.
class Model {
 public:
  /// Cost     O(n log n), on the threads of the calling oneTBB arena; the same tree on any number of them.
  /// Throws   std::invalid_argument if an option is not what its comment says, or `mesh` has been moved from.
  LIMBER_API explicit Model(Mesh mesh, const ModelOptions& options = {});
  LIMBER_API Model(Model&&) noexcept;
  /// Waits, as the destructor does, until a worker of the replaced model has stopped.
  LIMBER_API Model& operator=(Model&&) noexcept;
  LIMBER_API ~Model();

  /// Whether there is a mesh: false only once the model has been moved from.
  bool is_valid() const noexcept { return impl_ != nullptr; }

  /// Moves vertex `ids[i]` to `positions[i]`; later entries win where an id is repeated. The tree is repaired by
  /// commit().
  ///
  /// Frame    The model's own frame.
  /// Alias    `positions` may be a part of the model's own: they are read before any vertex moves.
  /// Errors   `size_mismatch`, `index_out_of_range`, `non_finite`, `too_large` with the entry's index; the model is
  ///          then exactly as before.
  /// Cost     O(entries), plus O(n) for the first call without ModelOptions::preallocate.
  LIMBER_API Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);

  LIMBER_API Result<void> move_vertices(std::span<const VertexId> ids, const PositionsView& positions);

  /// Moves every vertex. Errors as move_vertices().
  LIMBER_API Result<void> move_all(std::span<const Vec3> positions);
  LIMBER_API Result<void> move_all(const PositionsView& positions);

  /// Repairs the tree; afterwards the model may be queried. Does nothing when no vertex has moved and the motion margin
  /// is what it was.
  ///
  /// Throws   No std::bad_alloc of its own: where memory or threads are missing, rebuilding and the motion margin wait
  ///          for later commits. If oneTBB throws, the model is not committed, and another commit() repairs what is
  ///          left.
  /// Cost     O(nodes above moved vertices), at most that of one pass over the whole tree, on the threads of the
  ///          calling oneTBB arena. Rebuilding, where motion has made it worthwhile, takes what the options say; at its
  ///          end, for some commits, also twice as long as refits of what they move.
  LIMBER_API void commit();
  /// Whether nothing has moved since the last commit().
  LIMBER_API bool is_committed() const;

  /// Commits, and rebuilds the whole tree whatever the options say; it is then as if just built.
  ///
  /// Cost     O(n log n), on the threads of the calling oneTBB arena.
  LIMBER_API void rebuild();

  /// Replaces ModelOptions::motion_margin, from the next move or commit on.
  ///
  /// Throws   std::invalid_argument if the margin is not what the option's comment says.
  LIMBER_API void set_motion_margin(double motion_margin);

  /// Starts over with another mesh, whatever its triangles, as a new model with the same options; with the default ones
  /// if the model has been moved from.
  ///
  /// Cost     As the constructor.
  /// Throws   As the constructor; the model is then exactly as before.
  LIMBER_API void reset(Mesh mesh);

  LIMBER_API const ModelOptions& options() const;
  LIMBER_API MaintenanceStats maintenance_stats() const;
  LIMBER_API const Mesh& mesh() const;
  /// The edges of the mesh (elements.h), as pairs of elements and moving models need them. The first call builds them;
  /// they are kept, at their address, until reset().
  ///
  /// Throws   std::invalid_argument if the mesh has more than 2^32 / 3 triangles; std::bad_alloc.
  /// Cost     Of the first call O(n log n) at worst, O(n) where few edges meet at a vertex; 34 bytes a triangle of a
  ///          closed mesh. Later ones O(1).
  /// Threads  Of concurrent first calls one builds, and the others wait.
  LIMBER_API const MeshEdges& edges() const;
  LIMBER_API TreeStats tree_stats() const;

  /// A box along the axes of the model's frame, and a sphere, that contain the model: to feed a broad phase. Both are
  /// slightly larger than the smallest ones. Under a pose, place the center and keep the radius.
  ///
  /// Frame    The model's own frame.
  /// Throws   std::invalid_argument unless the model is committed.
  /// Cost     O(1).
  [[nodiscard]] LIMBER_API Box bounding_box() const;
  [[nodiscard]] LIMBER_API Sphere bounding_sphere() const;

  /// The bounding spheres of one level of the tree, to draw it: of the root on level 0, of all leaves on the last one,
  /// tree_stats().levels - 1. Each holds the triangles below it; the root's is bounding_sphere().
  ///
  /// Frame    The model's own frame.
  /// Throws   std::invalid_argument unless the model is committed and there is such a level.
  /// Cost     O(spheres).
  [[nodiscard]] LIMBER_API std::vector<Sphere> node_spheres(std::uint32_t level) const;

  /// Checks every invariant of the tree against the positions.
  ///
  /// Errors   `broken_invariant`, naming the invariant's number and the node.
  /// Cost     O(n log n).
  LIMBER_API Result<void> validate() const;

  /// For the library's own use.
  struct Impl;

 private:
  friend struct Access;  // for the library's own use
  const Impl& impl() const;
  void require_valid(const char* function) const;

  std::unique_ptr<Impl> impl_;
};

class Shape;
class ClosedSurface;
class ConvexSurface;
namespace model {
class ConvexParts;
}

/// What queries are about: the triangles of a model; with a radius, all points that are at most that far from a
/// triangle; of a solid, also all points that its surface encloses. Keeps a pointer: the model that it is of, or that a
/// shape has, must outlive it. All queries of a solid throw std::invalid_argument if its model has been reset() since.
class Body {
 public:
  Body(const Model& model) : model_(&model) {}
  /// A model with a margin around it, as planners pad links and engines give meshes a thickness.
  ///
  /// Throws   std::invalid_argument unless the radius is finite, >= 0 and at most `max_coordinate`.
  LIMBER_API Body(const Model& model, double radius);
  Body(const Model&&, double = 0) = delete;  // would point to a temporary
  /// A shape (shapes.h).
  LIMBER_API Body(const Shape& shape);
  Body(const Shape&&) = delete;
  /// A closed surface with its inside (points.h).
  ///
  /// Throws   std::invalid_argument if the model has been reset() since the surface was created.
  LIMBER_API explicit Body(const ClosedSurface& solid);
  /// A convex surface with its inside (convex.h), and a margin around it. Keeps a pointer to the surface, too.
  ///
  /// Throws   std::invalid_argument if a vertex of the model has moved since the surface was created, or as above.
  LIMBER_API explicit Body(const ConvexSurface& surface, double radius = 0);
  explicit Body(const ConvexSurface&&, double = 0) = delete;

  const Model& model() const { return *model_; }
  double radius() const { return radius_; }
  bool is_solid() const { return is_solid_; }

 private:
  friend struct Access;  // for the library's own use

  const Model* model_;
  double radius_ = 0;
  const model::ConvexParts* convex_ = nullptr;  // of a body that is known to be convex
  std::uint32_t surface_id_ = 0;                // of a solid whose model may be reset()
  bool is_solid_ = false;
  bool is_in_one_piece_ = false;  // whether all triangles are known to be connected by common vertices
};

/// A body and where it stands: most often a model or a shape. Keeps a pointer: the model must outlive it.
class Placed {
 public:
  Placed(const Model& model, const Transform& world_from_model = {}) : pose(world_from_model), body_(model) {}
  Placed(const Shape& shape, const Transform& world_from_model = {}) : pose(world_from_model), body_(shape) {}
  Placed(const Body& body, const Transform& world_from_model = {}) : pose(world_from_model), body_(body) {}
  Placed(const Model&&, const Transform& = {}) = delete;  // would point to a temporary
  Placed(const Shape&&, const Transform& = {}) = delete;

  const Model& model() const { return body_.model(); }
  const Body& body() const { return body_; }
  Transform pose;  ///< world_from_model

 private:
  Body body_;
};

}  // namespace limber

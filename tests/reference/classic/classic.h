// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/mesh.h"

/// The sphere tree of flexible models as it was first described: binary, one sphere per triangle, repaired in three
/// ways, optionally loose. Baseline of benchmarks and second oracle of tests; it checks no arguments.
///
/// Source   docs/algorithms/classic.md.
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
  double extra_radius = 0;
  /// A sphere that still contains its content is kept while its radius is at most this many times the one it would be
  /// given now; above that it has grown stale and is recomputed.
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

struct Node {
  Sphere sphere;
  std::uint32_t parent;       ///< no_id for the root
  std::uint32_t first_child;  ///< the second is first_child + 1; no_id for a leaf
  TriangleId triangle;        ///< no_id for an inner node
  std::uint32_t depth;        ///< edges to the root

  bool is_leaf() const { return triangle != no_id; }
};

inline constexpr std::uint32_t root = 0;

/// Nodes lie in breadth-first order: siblings are adjacent, and every child comes after its parent.
struct Tree {
  Mesh mesh;
  ModelOptions options;

  std::vector<Node> nodes;
  std::vector<std::uint32_t> leaf_of;  ///< by triangle

  /// Triangles at vertex v: triangles_at[first_triangle_at[v]] up to first_triangle_at[v + 1].
  std::vector<std::uint32_t> first_triangle_at;
  std::vector<TriangleId> triangles_at;

  // What commit() has to repair.
  std::vector<TriangleId> changed_triangles;
  std::vector<std::uint8_t> is_changed;                    ///< by triangle
  std::vector<std::vector<std::uint32_t>> queue_at_depth;  ///< nodes waiting for repair, empty between commits
  std::vector<std::uint8_t> is_queued;                     ///< by node

  MaintenanceStats stats;

  Tree(Mesh owned, const ModelOptions& asked) : mesh(std::move(owned)), options(asked) {}
};

/// A mesh and its sphere tree. Const functions, queries included, may run concurrently.
class Model {
 public:
  /// Cost     O(n log n).
  explicit Model(Mesh mesh, const ModelOptions& options = {});

  /// Moves vertex `ids[i]` to `positions[i]`; later entries win where an id is repeated.
  ///
  /// Errors   Those of Mesh::set_position(); entries before that one have moved.
  /// Cost     Immediate: O(triangles at the vertices * depth). Otherwise O(triangles at the vertices).
  Result<void> move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions);
  Result<void> move_all(std::span<const Vec3> positions);

  /// Repairs the tree; afterwards the model may be queried.
  void commit();
  bool is_committed() const { return tree_.changed_triangles.empty(); }

  const Mesh& mesh() const { return tree_.mesh; }
  const MaintenanceStats& maintenance_stats() const { return tree_.stats; }
  const Tree& tree() const { return tree_; }

  /// Checks the tree against the current positions: 2 n - 1 nodes, linked as described, one leaf for every triangle, a
  /// depth of ceil(log2 n), each sphere around its triangle or around those of both children, and no pending repair.
  ///
  /// Errors   `broken_invariant` with the node.
  Result<void> validate() const;

 private:
  Tree tree_;
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

/// At least x + y for x, y >= 0; exact when either is 0.
inline double add_up(double x, double y) {
  if (x == 0 || y == 0) return x + y;
  return (x + y) * (1 + 0x1p-51);
}

/// Queries as those of limber/distance.h, without cache and budget.
///
/// Pre      Both models are committed, and both poses are rigid.
CollideResult collide(const Placed& a, const Placed& b);
DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options = {});
CollideResult within(const Placed& a, const Placed& b, double max_distance);

}  // namespace limber::classic

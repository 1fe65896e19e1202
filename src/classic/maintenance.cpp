// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Based on  the thesis this engine follows: propagation to the root, at once, batched, or ordered by depth; loose
//           spheres.
// Differs   The queue ordered by depth is one list per level instead of a heap, which costs O(1) per node; a node is
//           put in once, however many children ask for it. A loose sphere is also recomputed when it has become much
//           larger than needed, because otherwise a shrinking model would keep its largest spheres for ever.
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"
#include "classic/tree.h"
#include "mesh/updates.h"

namespace limber::classic {
namespace {

/// Repairs one node; false when its loose sphere absorbed the change, so that nothing above it needs repair.
bool refit(Tree& tree, Node& node) {
  const Looseness& looseness = tree.options.looseness;
  const Sphere fresh = with_extra_radius(tight_sphere(tree, node), looseness);
  if (looseness.extra_radius > 0 && node.sphere.radius <= looseness.stale_ratio * fresh.radius &&
      sphere_holds(tree, node)) {
    ++tree.stats.absorbed;
    return false;
  }
  node.sphere = fresh;
  LIMBER_ASSERT(sphere_holds(tree, node));
  ++tree.stats.refits;
  return true;
}

/// Repairs the path from a triangle's leaf up to the root, or to the first sphere that absorbs the change.
void refit_path(Tree& tree, TriangleId triangle) {
  LIMBER_ASSERT(triangle < tree.leaf_of.size());
  for (std::uint32_t n = tree.leaf_of[triangle]; n != no_id; n = tree.nodes[n].parent) {
    if (!refit(tree, tree.nodes[n])) return;
  }
}

void enqueue(Tree& tree, std::uint32_t n) {
  LIMBER_ASSERT(n < tree.nodes.size());
  if (tree.is_queued[n] != 0) return;
  tree.is_queued[n] = 1;
  std::vector<std::uint32_t>& queue = tree.queue_at_depth[tree.nodes[n].depth];
  LIMBER_ASSERT(queue.size() < queue.capacity());
  queue.push_back(n);
}

/// Repairs every node above a changed triangle once, deepest first.
void refit_by_depth(Tree& tree) {
  for (const TriangleId t : tree.changed_triangles) enqueue(tree, tree.leaf_of[t]);
  for (std::size_t depth = tree.queue_at_depth.size(); depth-- > 0;) {
    for (const std::uint32_t n : tree.queue_at_depth[depth]) {
      tree.is_queued[n] = 0;
      if (refit(tree, tree.nodes[n]) && n != root) enqueue(tree, tree.nodes[n].parent);
    }
    tree.queue_at_depth[depth].clear();
  }
}

void move_vertex(Tree& tree, VertexId v, const Vec3& position) {
  LIMBER_ASSERT(v < tree.mesh.positions().size());
  MeshWriter::set_position(tree.mesh, v, position);
  ++tree.stats.moved_vertices;
  for (std::uint32_t i = tree.first_triangle_at[v]; i < tree.first_triangle_at[v + 1]; ++i) {
    const TriangleId t = tree.triangles_at[i];
    if (tree.options.maintenance == Maintenance::immediate) {
      refit_path(tree, t);
    } else if (tree.is_changed[t] == 0) {
      tree.is_changed[t] = 1;
      LIMBER_ASSERT(tree.changed_triangles.size() < tree.changed_triangles.capacity());
      tree.changed_triangles.push_back(t);
    }
  }
}

}  // namespace

Model::Model(Mesh mesh, const ModelOptions& options) : tree_(std::make_unique<Tree>(std::move(mesh), options)) {
  LIMBER_VALIDATE(validate());
}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

void Model::throw_moved_from(const char* function) {
  throw std::invalid_argument(std::string("limber::classic::Model::") + function + ": the model has been moved from");
}

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  const base::DefaultFloatEnvironment environment;
  require_valid("move_vertices");
  if (overlaps(tree_->mesh, positions)) {
    const std::vector<Vec3> copy(positions.begin(), positions.end());
    return move_vertices(ids, copy);
  }
  if (auto valid = check_update(tree_->mesh, ids, positions); !valid) return valid;
  for (std::size_t i = 0; i < ids.size(); ++i) move_vertex(*tree_, ids[i], positions[i]);
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  const base::DefaultFloatEnvironment environment;
  require_valid("move_all");
  if (auto valid = check_update_of_all(tree_->mesh, positions); !valid) return valid;
  for (VertexId v = 0; v < positions.size(); ++v) move_vertex(*tree_, v, positions[v]);
  return {};
}

void Model::commit() {
  const base::DefaultFloatEnvironment environment;
  require_valid("commit");
  Tree& tree = *tree_;
  if (tree.options.maintenance == Maintenance::by_depth) {
    refit_by_depth(tree);
  } else {
    for (const TriangleId t : tree.changed_triangles) refit_path(tree, t);
  }
  for (const TriangleId t : tree.changed_triangles) tree.is_changed[t] = 0;
  tree.changed_triangles.clear();
  LIMBER_VALIDATE(validate());
}

bool Model::is_committed() const { return is_valid() && tree_->changed_triangles.empty(); }

const Mesh& Model::mesh() const {
  require_valid("mesh");
  return tree_->mesh;
}

const ModelOptions& Model::options() const {
  require_valid("options");
  return tree_->options;
}

MaintenanceStats Model::maintenance_stats() const {
  require_valid("maintenance_stats");
  return tree_->stats;
}

}  // namespace limber::classic

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "base/access.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "limber/convex.h"
#include "limber/points.h"
#include "limber/shapes.h"
#include "mesh/updates.h"
#include "model/model_impl.h"

namespace limber {
namespace {

bool is_length(double x) { return std::isfinite(x) && x >= 0; }

void check(const Mesh& mesh, const ModelOptions& options) {
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::Model: the mesh has been moved from");
  LIMBER_REQUIRE(is_length(options.motion_margin),
                 "limber::Model: options.motion_margin is no length: finite and at least 0");
  LIMBER_REQUIRE(!options.rebuild_budget_us || is_length(*options.rebuild_budget_us),
                 "limber::Model: options.rebuild_budget_us is neither a time nor automatic");
}

model::TreeUpdater& updater_of(Model::Impl& impl) {
  if (!impl.updater) impl.updater.emplace(impl.tree, impl.mesh, impl.options);
  return *impl.updater;
}

/// An upper bound of the rounding of a slot's center and extent.
double rounding(const bvh::Tree& tree, bvh::SlotId id) {
  const bvh::Node& node = tree.nodes[bvh::node_of(id)];
  const double radius = static_cast<double>(node.bounds.radius[bvh::slot_of(id)]);
  const double extent = tree.unit * (static_cast<double>(node.radius) + radius);
  return base::offset_error * (max_abs(node.origin) + extent) + std::numeric_limits<double>::min();
}

/// The sphere of a slot, around all that is below it.
Sphere slot_sphere(const bvh::Tree& tree, bvh::SlotId id) {
  const bvh::Node& node = tree.nodes[bvh::node_of(id)];
  const double radius = tree.unit * static_cast<double>(node.bounds.radius[bvh::slot_of(id)]);
  return {bvh::slot_center(tree, id), (radius + tree.slack + rounding(tree, id)) * base::outward};
}

/// validate() for builds with checks; says nothing where there is no memory for it.
[[maybe_unused]] Result<void> validate_if_possible(const Model& model) {
  try {
    return model.validate();
  } catch (const std::bad_alloc&) {
    return {};
  }
}

}  // namespace

Model::Model(Mesh mesh, const ModelOptions& options) {
  const base::DefaultFloatEnvironment environment;
  check(mesh, options);
  impl_ = std::make_unique<Impl>(std::move(mesh), options);
  LIMBER_VALIDATE(validate_if_possible(*this));
}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

const Model::Impl& Model::impl() const {
  require_valid("impl");
  return *impl_;
}

void Model::require_valid(const char* function) const {
  if (is_valid()) return;
  throw std::invalid_argument(std::string("limber::Model::") + function + ": the model has been moved from");
}

const Mesh& Model::mesh() const {
  require_valid("mesh");
  return impl_->mesh;
}

const MeshEdges& Model::edges() const {
  require_valid("edges");
  const std::lock_guard lock(impl_->edges_mutex);
  if (!impl_->edges) impl_->edges.emplace(Access::make<MeshEdges>(impl_->mesh));
  return *impl_->edges;
}

const ModelOptions& Model::options() const {
  require_valid("options");
  return impl_->options;
}

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  const base::DefaultFloatEnvironment environment;
  require_valid("move_vertices");
  Impl& impl = *impl_;
  if (overlaps(impl.mesh, positions)) {  // the mesh's own positions: they are copied before they are overwritten
    const std::vector<Vec3> copy(positions.begin(), positions.end());
    return move_vertices(ids, copy);
  }
  if (auto valid = check_update(impl.mesh, ids, positions); !valid) return valid;
  if (ids.empty()) return {};
  updater_of(impl).move(impl.mesh, ids, positions);
  impl.stats.moved_vertices += ids.size();
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  const base::DefaultFloatEnvironment environment;
  require_valid("move_all");
  Impl& impl = *impl_;
  const Result<double> farthest_sq = check_displacements(impl.mesh, positions);
  if (!farthest_sq) return farthest_sq.error();
  updater_of(impl).move_all(impl.mesh, positions, *farthest_sq);
  impl.stats.moved_vertices += positions.size();
  return {};
}

Result<void> Model::move_vertices(std::span<const VertexId> ids, const PositionsView& positions) {
  require_valid("move_vertices");
  return move_vertices(ids, impl_->copied(positions));
}

Result<void> Model::move_all(const PositionsView& positions) {
  require_valid("move_all");
  return move_all(impl_->copied(positions));
}

void Model::commit() {
  const base::DefaultFloatEnvironment environment;
  require_valid("commit");
  if (!impl_->updater) return;
  impl_->updater->commit(impl_->mesh, impl_->stats);
  LIMBER_VALIDATE(validate_if_possible(*this));
}

bool Model::is_committed() const { return is_valid() && (!impl_->updater || impl_->updater->is_up_to_date()); }

void Model::rebuild() {
  const base::DefaultFloatEnvironment environment;
  require_valid("rebuild");
  updater_of(*impl_).rebuild_all(impl_->mesh);
  commit();
}

void Model::set_motion_margin(double motion_margin) {
  const base::DefaultFloatEnvironment environment;
  require_valid("set_motion_margin");
  LIMBER_REQUIRE(is_length(motion_margin),
                 "limber::Model::set_motion_margin: the margin is no length: finite and at least 0");
  if (impl_->updater) impl_->updater->set_motion_margin(impl_->mesh, motion_margin);
  impl_->options.motion_margin = motion_margin;
}

void Model::reset(Mesh mesh) { *this = Model(std::move(mesh), is_valid() ? impl_->options : ModelOptions{}); }

MaintenanceStats Model::maintenance_stats() const {
  require_valid("maintenance_stats");
  MaintenanceStats stats = impl_->stats;
  stats.motion_margin = impl_->options.motion_margin;
  return stats;
}

TreeStats Model::tree_stats() const {
  require_valid("tree_stats");
  const bvh::Tree& tree = impl_->tree;
  TreeStats stats;
  stats.levels = static_cast<std::uint32_t>(tree.level_begin.size() - 1);
  for (const bvh::Node& node : tree.nodes) stats.nodes += node.child_count;  // to users, a slot is a node
  stats.leaves = tree.leaves.size();
  stats.bytes = sizeof(bvh::Tree) + tree.nodes.capacity() * sizeof(bvh::Node) +
                tree.leaves.capacity() * sizeof(bvh::Leaf) + tree.level_begin.capacity() * sizeof(std::uint32_t);
  return stats;
}

Box Model::bounding_box() const {
  const base::DefaultFloatEnvironment environment;
  require_valid("bounding_box");
  LIMBER_REQUIRE(is_committed(), "limber::Model::bounding_box: the model has moves that are not committed");
  const bvh::Tree& tree = impl_->tree;
  const bvh::ChildBounds& n = tree.nodes[0].bounds;
  const Vec3 half = tree.unit * Vec3{n.half_x[0], n.half_y[0], n.half_z[0]};
  const Vec3 center = bvh::slot_center(tree, bvh::root_slot),
             extents = half + Vec3{1, 1, 1} * (tree.slack + rounding(tree, bvh::root_slot));
  // Computed while the default rounding mode is on, not after it is restored.
  return environment.computed_before_restore(Box{center - extents, center + extents});
}

Sphere Model::bounding_sphere() const {
  const base::DefaultFloatEnvironment environment;
  require_valid("bounding_sphere");
  LIMBER_REQUIRE(is_committed(), "limber::Model::bounding_sphere: the model has moves that are not committed");
  return environment.computed_before_restore(slot_sphere(impl_->tree, bvh::root_slot));
}

std::vector<Sphere> Model::node_spheres(std::uint32_t level) const {
  const base::DefaultFloatEnvironment environment;
  require_valid("node_spheres");
  LIMBER_REQUIRE(is_committed(), "limber::Model::node_spheres: the model has moves that are not committed");
  const bvh::Tree& tree = impl_->tree;
  LIMBER_REQUIRE(level < tree.level_begin.size() - 1, "limber::Model::node_spheres: the tree has no such level");
  std::vector<Sphere> spheres;
  for (std::uint32_t n = tree.level_begin[level]; n < tree.level_begin[level + 1]; ++n) {
    for (std::uint32_t slot = 0; slot < tree.nodes[n].child_count; ++slot) {
      spheres.push_back(slot_sphere(tree, n * bvh::width + slot));
    }
  }
  return spheres;
}

Result<void> Model::validate() const {
  const base::DefaultFloatEnvironment environment;
  require_valid("validate");
  const Impl& impl = *impl_;
  if (!impl.updater) return bvh::validate(impl.tree, impl.mesh);
  const MeshView fitted = impl.updater->fitted_mesh(impl.mesh);
  for (VertexId v = 0; v < fitted.positions.size(); ++v) {
    if (length(impl.mesh.positions()[v] - fitted.positions[v]) <= impl.tree.slack) continue;
    return Error{
        ErrorCode::broken_invariant,
        "invariant I4: vertex " + std::to_string(v) + " is farther than the motion margin from where it was fitted", v};
  }
  return bvh::validate(impl.tree, fitted);
}

// --- bodies: what a query takes, a model with a radius, a shape, or a solid ---

Body::Body(const Model& model, double radius) : model_(&model), radius_(radius) {
  LIMBER_REQUIRE(radius >= 0 && radius <= max_coordinate,
                 "limber::Body: the radius must be finite, at least 0 and at most max_coordinate");
}

// Solid shapes are convex.
Body::Body(const Shape& shape)
    : model_(&shape.model()),
      radius_(shape.radius()),
      convex_(Access::parts_of(shape)),
      is_solid_(shape.is_solid()),
      is_in_one_piece_(shape.is_solid()) {}

Body::Body(const ClosedSurface& solid)
    : model_(&Access::placed(PlacedSurface(solid)).model()),
      surface_id_(Access::impl(*model_).surface_id),
      is_solid_(true) {}

Body::Body(const ConvexSurface& surface, double radius) : Body(surface.model(), radius) {
  convex_ = Access::parts_of(surface);
  is_solid_ = is_in_one_piece_ = surface.is_solid();
  LIMBER_REQUIRE(has_its_surface(*this), "limber::Body: the model has moved since it was found to be convex");
}

void throw_not_ready(const Placed& placed, const char* place, const char* name) {
  const auto text = [&](const char* what) { return std::string(place) + ": " + name + what; };
  LIMBER_REQUIRE(placed.model().is_committed(),
                 text(" is not committed: it has moves without a commit(), or has been moved from").c_str());
  LIMBER_REQUIRE(
      has_its_surface(placed.body()),
      text(Access::convex_parts(placed.body()) == nullptr
               ? " was reset() after it was made a solid, so ClosedSurface::create() must check it again"
               : " has moved since it was found to be convex, so ConvexSurface::create() must check it again")
          .c_str());
  geometry::throw_not_rigid(placed.pose, std::string(place) + ": the pose of " + name);
}

}  // namespace limber

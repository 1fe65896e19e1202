// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/check.h"
#include "core/float_environment.h"
#include "model/following.h"
#include "model/mesh.h"
#include "tree/node.h"

namespace limber {
namespace {

bool is_automatic_or_length(double x) { return x == ModelOptions::automatic || (std::isfinite(x) && x >= 0); }

Mesh with_triangles(Mesh mesh) {
  LIMBER_REQUIRE(!mesh.triangles().empty(), "limber::Model: the mesh has been moved from");
  return mesh;
}

ModelOptions checked(const ModelOptions& options) {
  LIMBER_REQUIRE(is_automatic_or_length(options.slack),
                 "limber::Model: options.slack is neither a length nor automatic");
  LIMBER_REQUIRE(is_automatic_or_length(options.restructuring_us),
                 "limber::Model: options.restructuring_us is neither a time nor automatic");
  return options;
}

std::unique_ptr<tree::Tree> tree_of(const Mesh& mesh) {
  const core::DefaultFloatEnvironment environment;
  return std::make_unique<tree::Tree>(tree::build(mesh));
}

/// validate() for builds with checks; nothing is known where there is no memory for it.
[[maybe_unused]] Result<void> validate_if_possible(const Model& model) {
  try {
    return model.validate();
  } catch (const std::bad_alloc&) {
    return {};
  }
}

}  // namespace

Model::Model(Mesh mesh, const ModelOptions& options)
    : mesh_(with_triangles(std::move(mesh))), options_(checked(options)), tree_(tree_of(mesh_)) {
  LIMBER_VALIDATE(validate_if_possible(*this));
}
Model::Model(Model&&) noexcept = default;
Model::~Model() = default;

Model& Model::operator=(Model&& other) noexcept {
  if (this == &other) return *this;
  following_ = std::move(other.following_);  // first: it works on the tree
  tree_ = std::move(other.tree_);
  mesh_ = std::move(other.mesh_);
  options_ = other.options_;
  maintenance_ = other.maintenance_;
  return *this;
}

void Model::throw_moved_from(const char* function) {
  throw std::invalid_argument(std::string("limber::Model::") + function + ": the model has been moved from");
}

Following& Model::following() {
  if (following_ == nullptr) following_ = std::make_unique<Following>(*tree_, mesh_, options_);
  return *following_;
}

void Model::restructure() {
  const core::DefaultFloatEnvironment environment;
  require_valid("restructure");
  following().restructure_all(mesh_);
  commit();
}

void Model::set_slack(double slack) {
  const core::DefaultFloatEnvironment environment;
  require_valid("set_slack");
  LIMBER_REQUIRE(is_automatic_or_length(slack), "limber::Model::set_slack: slack is neither a length nor automatic");
  if (following_ != nullptr) following_->set_slack(mesh_, slack);
  options_.slack = slack;
}

void Model::reset(Mesh mesh) { *this = Model(std::move(mesh), options_); }

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  const core::DefaultFloatEnvironment environment;
  require_valid("move_vertices");
  if (overlaps(mesh_, positions)) {
    const std::vector<Vec3> copy(positions.begin(), positions.end());
    return move_vertices(ids, copy);
  }
  if (auto sound = check_update(mesh_, ids, positions); !sound) return sound;
  if (ids.empty()) return {};
  following().move(mesh_, ids, positions);
  maintenance_.moved_vertices += ids.size();
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  const core::DefaultFloatEnvironment environment;
  require_valid("move_all");
  const Result<double> furthest_sq = check_steps_of_all(mesh_, positions);
  if (!furthest_sq) return furthest_sq.error();
  following().move_all(mesh_, positions, *furthest_sq);
  maintenance_.moved_vertices += positions.size();
  return {};
}

void Model::commit() {
  const core::DefaultFloatEnvironment environment;
  require_valid("commit");
  if (following_ == nullptr) return;
  following_->commit(mesh_, maintenance_);
  LIMBER_VALIDATE(validate_if_possible(*this));
}

bool Model::is_committed() const { return is_valid() && (following_ == nullptr || following_->is_up_to_date()); }

MaintenanceStats Model::maintenance_stats() const {
  require_valid("maintenance_stats");
  MaintenanceStats stats = maintenance_;
  stats.slack = following_ != nullptr ? following_->slack() : std::max(0.0, options_.slack);
  return stats;
}

TreeStats Model::tree_stats() const {
  require_valid("tree_stats");
  TreeStats stats;
  stats.levels = static_cast<std::uint32_t>(tree_->level_begin.size() - 1);
  for (const tree::Block& block : tree_->blocks) stats.nodes += block.count;
  stats.leaves = tree_->leaves.size();
  stats.bytes = sizeof(tree::Tree) + tree_->blocks.capacity() * sizeof(tree::Block) +
                tree_->leaves.capacity() * sizeof(tree::Leaf) + tree_->level_begin.capacity() * sizeof(std::uint32_t);
  return stats;
}

Result<void> Model::validate() const {
  const core::DefaultFloatEnvironment environment;
  require_valid("validate");
  if (following_ == nullptr) return tree::validate(*tree_, mesh_);
  const MeshView anchored = following_->anchored(mesh_);
  for (VertexId v = 0; v < anchored.positions.size(); ++v) {
    if (length(mesh_.positions()[v] - anchored.positions[v]) <= tree_->slack) continue;
    return Error{ErrorCode::broken_invariant, "I4: beyond the slack is vertex " + std::to_string(v), v};
  }
  return tree::validate(*tree_, anchored);
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "core/check.h"
#include "model/following.h"
#include "model/mesh.h"
#include "tree/node.h"

namespace limber {
namespace {

bool is_automatic_or_length(double x) { return x == ModelOptions::automatic || (std::isfinite(x) && x >= 0); }

}  // namespace

Model::Model(Mesh mesh, const ModelOptions& options)
    : mesh_(std::move(mesh)), options_(options), tree_(std::make_unique<tree::Tree>(tree::build(mesh_))) {
  LIMBER_ASSERT(is_automatic_or_length(options.slack));
  LIMBER_ASSERT(is_automatic_or_length(options.restructuring_us));
  LIMBER_VALIDATE(validate());
}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

Following& Model::following() {
  if (following_ == nullptr) following_ = std::make_unique<Following>(*tree_, mesh_, options_);
  return *following_;
}

void Model::restructure() {
  following().restructure_all(mesh_);
  commit();
}

void Model::set_slack(double slack) {
  LIMBER_ASSERT(is_automatic_or_length(slack));
  options_.slack = slack;
  if (following_ != nullptr) following_->set_slack(mesh_, slack);
}

void Model::rebuild(Mesh mesh) { *this = Model(std::move(mesh), options_); }

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  if (auto sound = check_update(mesh_, ids, positions); !sound) return sound;
  if (ids.empty()) return {};
  following().move(mesh_, ids, positions);
  maintenance_.moved_vertices += ids.size();
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  const Result<double> furthest_sq = check_steps_of_all(mesh_, positions);
  if (!furthest_sq) return furthest_sq.error();
  following().move_all(mesh_, positions, *furthest_sq);
  maintenance_.moved_vertices += positions.size();
  return {};
}

void Model::commit() {
  if (following_ == nullptr) return;
  following_->commit(mesh_, maintenance_);
  LIMBER_VALIDATE(validate());
}

bool Model::is_committed() const { return following_ == nullptr || following_->is_up_to_date(); }

MaintenanceStats Model::maintenance_stats() const {
  MaintenanceStats stats = maintenance_;
  stats.slack = following_ != nullptr ? following_->slack() : std::max(0.0, options_.slack);
  return stats;
}

TreeStats Model::tree_stats() const {
  TreeStats stats;
  stats.levels = static_cast<std::uint32_t>(tree_->level_begin.size() - 1);
  for (const tree::Block& block : tree_->blocks) stats.nodes += block.count;
  stats.leaves = tree_->leaves.size();
  stats.bytes = sizeof(tree::Tree) + tree_->blocks.capacity() * sizeof(tree::Block) +
                tree_->leaves.capacity() * sizeof(tree::Leaf) + tree_->level_begin.capacity() * sizeof(std::uint32_t);
  return stats;
}

Result<void> Model::validate() const {
  if (following_ == nullptr) return tree::validate(*tree_, mesh_);
  const MeshView anchored = following_->anchored(mesh_);
  for (VertexId v = 0; v < anchored.positions.size(); ++v) {
    if (length(mesh_.positions()[v] - anchored.positions[v]) <= tree_->slack) continue;
    return Error{ErrorCode::broken_invariant, "I4: beyond the slack is vertex " + std::to_string(v), v};
  }
  return tree::validate(*tree_, anchored);
}

}  // namespace limber

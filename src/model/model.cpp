// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <utility>

#include "core/check.h"
#include "model/mesh.h"
#include "tree/changes.h"
#include "tree/node.h"

namespace limber {

Model::Model(Mesh mesh) : mesh_(std::move(mesh)), tree_(std::make_unique<tree::Tree>(tree::build(mesh_))) {
  LIMBER_VALIDATE(validate());
}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

tree::Changes& Model::changes() {
  if (changes_ == nullptr) changes_ = std::make_unique<tree::Changes>(*tree_, mesh_);
  return *changes_;
}

Result<void> Model::move_vertices(std::span<const VertexId> ids, std::span<const Vec3> positions) {
  if (auto sound = check_update(mesh_, ids, positions); !sound) return sound;
  if (ids.empty()) return {};
  tree::Changes& changed = changes();
  for (std::size_t i = 0; i < ids.size(); ++i) {
    mesh_.set_position(ids[i], positions[i]);
    changed.add(ids[i]);
  }
  maintenance_.moved_vertices += ids.size();
  return {};
}

Result<void> Model::move_all(std::span<const Vec3> positions) {
  if (auto sound = check_update_of_all(mesh_, positions); !sound) return sound;
  for (VertexId v = 0; v < positions.size(); ++v) mesh_.set_position(v, positions[v]);
  changes().add_all();
  maintenance_.moved_vertices += positions.size();
  return {};
}

void Model::commit() {
  if (is_committed()) return;
  maintenance_.refits += tree::refit(*tree_, mesh_, *changes_);
  LIMBER_VALIDATE(validate());
}

bool Model::is_committed() const { return changes_ == nullptr || changes_->empty(); }

TreeStats Model::tree_stats() const {
  TreeStats stats;
  stats.levels = static_cast<std::uint32_t>(tree_->level_begin.size() - 1);
  for (const tree::Block& block : tree_->blocks) stats.nodes += block.count;
  stats.leaves = tree_->leaves.size();
  stats.bytes = sizeof(tree::Tree) + tree_->blocks.capacity() * sizeof(tree::Block) +
                tree_->leaves.capacity() * sizeof(tree::Leaf) + tree_->level_begin.capacity() * sizeof(std::uint32_t);
  return stats;
}

Result<void> Model::validate() const { return tree::validate(*tree_, mesh_); }

}  // namespace limber

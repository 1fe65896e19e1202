// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/model.h"

#include <utility>

#include "core/check.h"
#include "tree/node.h"

namespace limber {

Model::Model(Mesh mesh) : mesh_(std::move(mesh)), tree_(std::make_unique<tree::Tree>(tree::build(mesh_))) {
  LIMBER_VALIDATE(validate());
}
Model::Model(Model&&) noexcept = default;
Model& Model::operator=(Model&&) noexcept = default;
Model::~Model() = default;

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

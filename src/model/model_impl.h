// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/access.h"
#include "bvh/tree.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "model/tree_updater.h"

namespace limber {

struct Model::Impl {
  Impl(Mesh source, const ModelOptions& wanted) : mesh(std::move(source)), options(wanted), tree(bvh::build(mesh)) {
    if (!options.preallocate) return;
    updater.emplace(tree, mesh, options);
    scratch.resize(mesh.positions().size());
  }

  Mesh mesh;
  ModelOptions options;
  bvh::Tree tree;
  std::optional<model::TreeUpdater> updater;  // once a vertex has moved
  MaintenanceStats stats;
  std::vector<Vec3> scratch;

  /// Positions as the library keeps them, until the next call.
  std::span<const Vec3> copied(const PositionsView& positions) {
    scratch.resize(positions.size());
    positions.copy_to(scratch);
    return scratch;
  }

  mutable std::mutex edges_mutex;
  mutable std::optional<const MeshEdges> edges;  // once they have been asked for
};

}  // namespace limber

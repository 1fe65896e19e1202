// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/access.h"
#include "bvh/tree.h"
#include "geometry/rigid.h"
#include "limber/elements.h"
#include "limber/model.h"
#include "model/convex_parts.h"
#include "model/tree_updater.h"

namespace limber {

struct Model::Impl {
  Impl(Mesh source, const ModelOptions& wanted) : mesh(std::move(source)), options(wanted), tree(bvh::build(mesh)) {
    if (!options.preallocate) return;
    updater.emplace(tree, mesh, options);
    scratch.resize(mesh.positions().size());
  }

  /// Tells the mesh from the last four billion others, also from those in the same memory: solids remember it.
  static inline std::atomic<std::uint32_t> last_surface_id = 0;
  const std::uint32_t surface_id = ++last_surface_id;

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

/// Whether a body is no solid, or its model still has the surface that was found to be closed; and where that was found
/// to be convex, no vertex has moved since.
///
/// Pre: the model has not been moved from.
inline bool has_its_surface(const Body& body) {
  if (const model::ConvexParts* convex = Access::convex_parts(body)) return convex->is_of(body.model());
  const std::uint32_t id = Access::surface_id(body);
  return id == 0 || id == Access::impl(body.model()).surface_id;
}

/// Throws std::invalid_argument, which says what of a model is not as require_ready() wants it.
[[noreturn]] void throw_not_ready(const Placed& placed, const char* place, const char* name);

/// The insides of a model that a query may ask about: it is committed, still has the surface that was found to be
/// closed, and its pose is rigid.
///
/// Throws   std::invalid_argument, "place: name ...", unless it is so.
inline const Model::Impl& require_ready(const Placed& placed, const char* place, const char* name) {
  const bool is_ready =
      placed.model().is_committed() && has_its_surface(placed.body()) && geometry::is_rigid(placed.pose);
  if (!is_ready) throw_not_ready(placed, place, name);
  return Access::impl(placed.model());
}

}  // namespace limber

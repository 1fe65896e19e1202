// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "limber/mesh.h"

namespace limber {

/// Whether `positions` overlaps the mesh's own array: then writing one position may change another.
bool overlaps(const Mesh& mesh, std::span<const Vec3> positions);

/// Checks an update of some vertices.
///
/// Errors   `size_mismatch`, or `index_out_of_range`, `non_finite`, `too_large` with the first bad entry.
Result<void> check_update(const Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions);

/// Checks an update of all vertices. Errors as check_update().
Result<void> check_update_of_all(const Mesh& mesh, std::span<const Vec3> positions);

/// Checks an update of all vertices, and returns the longest displacement of a vertex, squared.
Result<double> check_displacements(const Mesh& mesh, std::span<const Vec3> positions);

/// Replaces positions of a mesh without checking them again. Pre: the update is valid.
struct MeshWriter {
  static void set_positions(Mesh& mesh, std::span<const VertexId> ids, std::span<const Vec3> positions);
  static void set_positions(Mesh& mesh, std::span<const Vec3> positions);
};

}  // namespace limber

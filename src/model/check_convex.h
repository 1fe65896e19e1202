// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/base.h"
#include "limber/mesh.h"

namespace limber::model {

/// Whether the triangles of a mesh, with what they enclose, are a convex set: a closed surface, a flat polygon, a
/// segment or a point. Decided exactly.
///
/// Errors   `not_convex` or `not_closed`, naming what keeps the mesh from it, where, and by how much.
/// Cost     O(n log n) where an edge is concave. O(n^2) for convex surfaces, some 10 ms for 1000 vertices.
Result<void> check_convex(const Mesh& mesh);

}  // namespace limber::model

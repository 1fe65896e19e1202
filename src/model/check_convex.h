// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/base.h"
#include "limber/mesh.h"

namespace limber::model {

/// Whether the triangles of a mesh, with what they enclose, are a convex set: a closed surface, for which the result is
/// true, or a flat polygon, a segment or a point. What is in front of a plane by at most `max_concavity` counts as on
/// it.
///
/// Errors   `not_convex` or `not_closed`, naming what keeps the mesh from it, where, and by how much.
/// Cost     O(n log n) where an edge is concave. O(n^2) for convex surfaces, some 10 ms for 1000 vertices.
Result<bool> check_convex(const Mesh& mesh, double max_concavity);

}  // namespace limber::model

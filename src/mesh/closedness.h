// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/mesh.h"

namespace limber::mesh {

/// Whether every edge, by vertex ids, belongs to exactly two triangles, which run through it in opposite directions.
///
/// Errors   `not_closed` for the first triangle with an edge of which that is not so, naming the edge.
/// Cost     O(n log n) at worst, O(n) where few edges meet at a vertex; allocates 36 bytes a triangle and 8 a vertex.
Result<void> check_closed(const Mesh& mesh);

}  // namespace limber::mesh

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "limber/mesh.h"

namespace limber::mesh {

/// Whether every edge, by vertex ids, belongs to exactly two triangles, which run through it in opposite directions.
///
/// Errors   `not_closed` for the first triangle with an edge of which that is not so, naming the edge.
/// Cost     O(n log n); allocates 48 bytes a triangle.
Result<void> check_closed(std::span<const Corners> triangles);

}  // namespace limber::mesh

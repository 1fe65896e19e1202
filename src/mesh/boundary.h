// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "limber/mesh.h"

namespace limber {

/// Whether each edge is run through as often in one direction as in the other; an edge from a vertex to itself does not
/// count.
///
/// Promise  True for all such triangles; for others with a probability of 2^-64.
/// Cost     O(triangles), some nanoseconds each. Allocates nothing.
bool has_no_boundary(std::span<const Corners> triangles);

}  // namespace limber

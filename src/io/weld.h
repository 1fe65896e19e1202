// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "limber/base.h"
#include "limber/math.h"

namespace limber::io {

/// Which vertices of a file share a position.
struct Weld {
  std::vector<VertexId> welded_of;       ///< for each file vertex
  std::vector<VertexId> file_vertex_of;  ///< the first file vertex for each welded vertex
};

/// Maps vertices at equal positions to one; -0 equals 0. Welded vertices are numbered in order of first appearance.
///
/// Pre      No coordinate is NaN; there are fewer than 2^31 positions.
/// Cost     O(n) expected; O(n log n) for positions chosen so that their hash values collide.
Weld weld(std::span<const Vec3> positions);

}  // namespace limber::io

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>

#include "limber/base.h"
#include "limber/geometry.h"

/// Triangles of one mesh that share vertices always intersect: in the shared corner or edge. These functions decide
/// whether they meet elsewhere, that is, share a point off that corner or edge.
///
/// Pre      The thread is in the default floating-point environment. Coordinates are at most max_coordinate in size.
/// Promise  Exact, also for triangles that are a segment or a point. Neither the order of a and b nor that of corners
///          matters.
/// Source   docs/algorithms/intersection.md, "Triangles that share corners".
namespace limber::geometry {

/// Whether two triangles of one mesh meet elsewhere than in what they share by their vertex ids.
///
/// No shared vertex: any common point counts, as for intersects(). One vertex: any other point counts. Two vertices:
/// any point off the edge between them counts. Three vertices, in any order: nothing counts, for both are the same set
/// of points. A triangle may name a vertex more than once.
/// Pre      Equal ids stand for equal positions.
bool meets_elsewhere(const Triangle& a, const std::array<VertexId, 3>& ids_a, const Triangle& b,
                     const std::array<VertexId, 3>& ids_b);

/// Whether two triangles share any point but one corner of both: corner_a of a, corner_b of b.
///
/// Pre      The two corners have equal positions.
bool meet_beyond_shared_corner(const Triangle& a, std::size_t corner_a, const Triangle& b, std::size_t corner_b);

/// Whether two triangles share any point off a common edge: that of a without corner apex_a, that of b without apex_b.
///
/// Pre      The ends of both edges have the same two positions, in either order.
bool meet_beyond_shared_edge(const Triangle& a, std::size_t apex_a, const Triangle& b, std::size_t apex_b);

}  // namespace limber::geometry

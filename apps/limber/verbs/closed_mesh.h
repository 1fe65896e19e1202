// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

#include "limber/mesh.h"

/// Closed meshes, and what lies inside them.
namespace limber::program {

/// An edge has two distinct ends. A triangle uses an edge once, even where two of its corners coincide.
struct EdgeCounts {
  std::size_t open = 0;          ///< used by one triangle
  std::size_t closed = 0;        ///< used by two
  std::size_t non_manifold = 0;  ///< used by more

  /// Whether every edge has two triangles, so that the mesh has an inside.
  bool are_closed() const { return closed > 0 && open == 0 && non_manifold == 0; }
};
EdgeCounts count_edges(MeshView mesh);

/// The box of the triangles; vertices without a triangle do not count. Pre: there is a triangle.
Box box_of(MeshView mesh);

/// Whether all triangles of a mesh lie in a box of another frame, up to rounding. Stops at the first that does not.
bool is_in_box(MeshView mesh, const Transform& box_from_mesh, const Box& box);

/// Whether a mesh lies wholly inside a closed mesh: a ray from one vertex of each connected part crosses the closed
/// mesh an odd number of times, decided exactly for the placed vertices rounded to float64. Says no for more than
/// `max_parts` parts.
///
/// Pre      The meshes do not meet, or else the answer means nothing; both poses are world_from_mesh.
/// Cost     O(triangles of both), for each part.
bool lies_inside(MeshView inner, const Transform& inner_pose, MeshView outer, const Transform& outer_pose);
inline constexpr std::size_t max_parts = 64;

}  // namespace limber::program

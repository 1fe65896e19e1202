// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "limber/points.h"

/// Distances over the surface of one model to another, for a map in colours.
namespace limber::program {

/// A placed mesh whose long edges are divided where the distance to another model may differ between their ends: large
/// faces would otherwise show what their corners know. Edges are divided in the middle, and in all of their triangles.
struct DistanceMap {
  std::vector<Vec3> positions;          ///< in the world; those of the mesh come first
  std::vector<Corners> triangles;       ///< parts of one triangle of the mesh follow each other
  std::vector<std::uint32_t> parts_of;  ///< how many parts each triangle of the mesh has
  std::vector<double> distances;        ///< by vertex: to the closest point of the other model
};

/// The map of a model. Edges are divided until they are short next to their distance from the other model, or shorter
/// than `shortest_edge`, or until there is no room left below about `most_triangles`. The longest get the room first.
///
/// Errors   BadInput where a vertex as placed is above `max_coordinate`.
/// Pre      most_triangles is at least the number of the mesh's triangles.
/// Cost     One closest point for each vertex, on the threads of the calling oneTBB arena.
DistanceMap distance_map(MeshView mesh, const Transform& pose, const Placed& other, double shortest_edge,
                         std::size_t most_triangles);

}  // namespace limber::program

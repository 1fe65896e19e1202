// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <vector>

#include "limber/math.h"
#include "limber/mesh.h"

namespace limber::model {

/// The convex hull of some points.
struct Hull {
  std::vector<Vec3> positions;     ///< some of the points, all corners of the hull among them
  std::vector<Corners> triangles;  ///< its surface, corners counter-clockwise as seen from outside; none is degenerate
  bool is_solid = false;           ///< else it is a flat polygon, a segment or a point, as triangles
};

/// Based on  The incremental hull: each point that is outside replaces the faces that it sees by a cone over their
///           border.
/// Differs   Signs are exact, and only what is strictly in front of a face sees it. So no rounding can spoil the
///           surface, and no face is degenerate: a point in line with an edge of the border would not see the face
///           behind it. Coplanar points become corners of coplanar triangles.
///
/// Promise  Exactly all points are behind all triangles, or on them.
/// Pre      There is a point; all are finite.
/// Cost     O(n h) for h triangles of the hull, so O(n^2) at worst.
/// Source   [Edelsbrunner1987], the beneath-beyond method.
Hull convex_hull(std::span<const Vec3> points);

}  // namespace limber::model

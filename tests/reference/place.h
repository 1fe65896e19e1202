// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "base/check.h"
#include "geometry/rigid.h"
#include "reference/reference.h"

namespace limber::reference {

/// The triangles of a mesh in the world, each rounded once.
inline std::vector<Triangle> place(const Placed& placed) {
  LIMBER_REQUIRE(geometry::is_rigid(placed.pose), "limber::reference: a query needs rigid poses; one of a mesh is not");
  std::vector<Triangle> triangles;
  triangles.reserve(placed.mesh.triangles.size());
  for (TriangleId t = 0; t < placed.mesh.triangles.size(); ++t) {
    const Triangle model = placed.mesh.triangle(t);
    triangles.push_back({placed.pose(model.v0), placed.pose(model.v1), placed.pose(model.v2)});
  }
  return triangles;
}

}  // namespace limber::reference

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "limber/contacts.h"
#include "limber/distance.h"
#include "reference/place.h"
#include "support/exact_distance.h"
#include "support/random_geometry.h"

/// Bodies that bug reports of other libraries describe.
namespace limber::testing {

inline Transform at(double x, double y = 0, double z = 0) { return {{}, {x, y, z}}; }

/// A box whose normals point outward. Corner i has the high x if bit 0 of i is set, and so on.
inline Mesh box(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (int i = 0; i < 8; ++i) {
    corners.push_back({(i & 1) ? high.x : low.x, (i & 2) ? high.y : low.y, (i & 4) ? high.z : low.z});
  }
  constexpr VertexId ids[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<Corners> triangles;
  for (const auto& c : ids) triangles.push_back({c[0], c[1], c[2]});
  return Mesh::create(std::move(corners), std::move(triangles)).value();
}
inline Mesh box(const Vec3& half) { return box(-half, half); }

inline Mesh scaled(const Mesh& mesh, double factor) {
  std::vector<Vec3> positions = mesh.positions();
  for (Vec3& p : positions) p *= factor;
  return Mesh::create(std::move(positions), mesh.triangles()).value();
}

inline std::vector<Triangle> placed_triangles(const Placed& placed) {
  return reference::place({placed.model().mesh(), placed.pose});
}

/// The squared distance of two models without rounding, by exact arithmetic on all pairs of their placed triangles.
inline exact::Fraction exact_squared_distance(const Placed& a, const Placed& b) {
  exact::Fraction least = -1;
  for (const Triangle& t : placed_triangles(a)) {
    for (const Triangle& u : placed_triangles(b)) {
      const exact::Fraction squared = exact::squared_distance(t, u);
      if (least < 0 || squared < least) least = squared;
    }
  }
  return least;
}

}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "limber/mesh.h"
#include "support/random_geometry.h"

/// Meshes and turns that several tests use.
namespace limber::testing {

inline Mesh small_mesh(std::vector<Vec3> positions, std::vector<Corners> triangles) {
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

inline Mesh scaled(const Mesh& mesh, double factor) {
  return mapped(mesh, [factor](const Vec3& p) { return factor * p; });
}

/// The triangles of a box, whose normals point outward.
inline std::vector<Corners> box_triangles(VertexId first = 0) {
  constexpr VertexId ids[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  std::vector<Corners> triangles;
  for (const auto& c : ids) triangles.push_back({first + c[0], first + c[1], first + c[2]});
  return triangles;
}

/// The corners of a box. Corner i has the high x if bit 0 of i is set, and so on.
inline std::vector<Vec3> box_corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> corners;
  for (unsigned i = 0; i < 8; ++i) {
    corners.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  }
  return corners;
}

inline Mesh box_mesh(const Vec3& low, const Vec3& high) {
  return Mesh::create(box_corners(low, high), box_triangles()).value();
}

inline Mat3 about_z(double angle) {
  return {{std::cos(angle), -std::sin(angle), 0}, {std::sin(angle), std::cos(angle), 0}, {0, 0, 1}};
}

}  // namespace limber::testing

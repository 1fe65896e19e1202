// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/random_scene.h"

/// Scenes whose coordinates are small integers: centers, normals and heights of bounds coincide or are 0, to the bit.
namespace limber::testing {

/// One of the 24 turns of a cube, or with `mirrors` one of 48 maps.
inline Mat3 lattice_rotation(Rng& rng, bool mirrors = false) {
  std::size_t axis[3] = {0, 1, 2};
  for (std::size_t k = 2; k > 0; --k) std::swap(axis[k], axis[rng.below(k + 1)]);
  Mat3 m{{0, 0, 0}, {0, 0, 0}, {0, 0, 0}};
  Vec3* const rows[3] = {&m.row0, &m.row1, &m.row2};
  for (std::size_t k = 0; k < 3; ++k) (*rows[k])[axis[k]] = rng.below(2) == 0 ? 1 : -1;
  const bool is_mirror = dot(cross(m.row0, m.row1), m.row2) < 0;
  if (is_mirror && !(mirrors && rng.below(2) == 0)) m.row0 = -1 * m.row0;
  return m;
}

/// Triangles between lattice points, or a plane over a lattice, or some triangles many times.
inline Mesh lattice_mesh(Rng& rng) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  const std::uint64_t kind = rng.below(3);
  if (kind == 0) {
    const std::uint64_t side = 2 + rng.below(4), points = 3 + rng.below(20), count = 1 + rng.below(30);
    for (std::uint64_t i = 0; i < points; ++i) positions.push_back(lattice_point(rng, side));
    const auto some = [&] { return static_cast<VertexId>(rng.below(points)); };
    for (std::uint64_t i = 0; i < count; ++i) triangles.push_back({some(), some(), some()});
  } else if (kind == 1) {  // z = a x + b y
    const auto slope = [&] { return static_cast<double>(rng.below(3)) - 1; };
    const double a = slope(), b = slope();
    const auto n = static_cast<VertexId>(1 + rng.below(8));
    for (VertexId y = 0; y <= n; ++y) {
      for (VertexId x = 0; x <= n; ++x) positions.push_back({double(x), double(y), a * x + b * y});
    }
    for (VertexId y = 0; y < n; ++y) {
      for (VertexId x = 0; x < n; ++x) {
        const VertexId v = y * (n + 1) + x;
        triangles.push_back({v, v + 1, v + n + 2});
        triangles.push_back({v, v + n + 2, v + n + 1});
      }
    }
  } else {
    for (int i = 0; i < 5; ++i) positions.push_back(lattice_point(rng, 4));
    const std::uint64_t count = 1 + rng.below(20);
    for (std::uint64_t i = 0; i < count; ++i) {
      Corners c{0, 1, static_cast<VertexId>(2 + rng.below(3) / 2)};
      std::rotate(c.begin(), c.begin() + rng.below(3), c.end());
      if (rng.below(2) == 0) std::swap(c[0], c[1]);
      triangles.push_back(c);
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// Two such meshes, or one and itself turned or mirrored, at integer places.
inline Scene lattice_scene(Rng& rng) {
  Mesh a = lattice_mesh(rng), b = lattice_mesh(rng);
  if (rng.below(2) == 0) {
    const Mat3 m = lattice_rotation(rng, true);
    std::vector<Vec3> positions = a.positions();
    for (Vec3& p : positions) p = m * p;
    b = Mesh::create(std::move(positions), a.triangles()).value();
  }
  const auto place = [&] {
    const auto integer = [&] { return static_cast<double>(rng.below(5)) - 2; };
    const Transform pose{lattice_rotation(rng), {integer(), integer(), integer()}};
    return rng.below(3) == 0 ? Transform{} : pose;
  };
  const Transform pose_a = place(), pose_b = place();
  return {std::move(a), std::move(b), pose_a, pose_b, 20, 1e-13};
}

}  // namespace limber::testing

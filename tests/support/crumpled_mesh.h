// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "support/random_scene.h"

/// Random meshes that are close to themselves, and margins.
namespace limber::testing {

/// How far apart things are: 0, or anything up to the size.
inline double some_margin(Rng& rng, double size) {
  return rng.below(4) == 0 ? 0 : size * std::pow(10.0, rng.uniform(-6, -0.5));
}

/// A surface or a soup whose triangles share vertices, crumpled so that it may meet itself.
inline Mesh crumpled(Rng& rng) {
  const std::uint64_t kind = rng.below(6);
  if (kind == 5) return arbitrary_scene(rng).mesh_a;
  // One after the other, so that all compilers make the same meshes.
  const std::uint32_t n = kind < 2 ? some(rng, 2, 5) : some(rng, 1, 8);
  const std::uint32_t m = kind < 2 ? some(rng, 3, 6) : some(rng, 1, 8);
  const Mesh mesh = kind < 2 ? scenes::ball(m, n) : scenes::grid(m, n, -2, -2, 0.5, 0.5);
  std::vector<Vec3> positions = mesh.positions();
  const double step = std::pow(10.0, rng.uniform(-3, 0.5));
  for (Vec3& p : positions) {
    if (kind == 4) {
      p = lattice_point(rng, 3);  // folded in every way
    } else if (rng.below(3) == 0) {
      p += step * uniform_point(rng);
    }
  }
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& c : triangles) {  // some that name a vertex twice, that are there twice, or that share odd vertices
    if (rng.below(40) == 0) c[rng.below(3)] = static_cast<VertexId>(rng.below(positions.size()));
  }
  if (rng.below(3) == 0) triangles.push_back(triangles[rng.below(triangles.size())]);
  const double scale = rng.below(4) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150) : 1;
  const Vec3 offset = rng.below(4) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
  return moved(Mesh::create(std::move(positions), std::move(triangles)).value(), offset, scale);
}

inline double extent_of(const Mesh& mesh) {
  double extent = 0;
  for (const Vec3& p : mesh.positions()) extent = std::max(extent, max_abs(p));
  return extent;
}

}  // namespace limber::testing

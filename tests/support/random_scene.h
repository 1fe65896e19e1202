// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/random_geometry.h"

/// Two random meshes and their poses: soups of every kind, surfaces, huge offsets, any scale.
namespace limber::testing {

inline Triangle arbitrary_triangle(Rng& rng, std::uint64_t kind) {
  const Vec3 at = uniform_point(rng, -3, 3);
  switch (kind) {
    case 0:
      return lattice_triangle(rng);
    case 1:
      return uniform_triangle(rng);
    case 2:  // small
      return {at + 0.1 * uniform_point(rng), at + 0.1 * uniform_point(rng), at + 0.1 * uniform_point(rng)};
    case 3:  // a point
      return {at, at, at};
    case 4:  // in one plane with all others
      return {{at.x, at.y, 0}, {at.x + 0.3, at.y, 0}, {at.x, at.y + 0.3, 0}};
    default:  // a needle
      return {at, at + 2 * uniform_point(rng), at + 1e-9 * uniform_point(rng)};
  }
}

inline Mesh moved(const Mesh& mesh, const Vec3& offset, double scale) {
  return mapped(mesh, [&](const Vec3& p) { return (p + offset) * scale; });
}

inline std::uint32_t some(Rng& rng, std::uint32_t least, std::uint32_t more) {
  return least + static_cast<std::uint32_t>(rng.below(more));
}

/// A small sheet with bumps.
inline Mesh dented_sheet(Rng& rng) {
  const std::uint32_t ny = some(rng, 1, 8), nx = some(rng, 1, 8);  // one after the other: the same on all compilers
  return mapped(scenes::grid(nx, ny, -2, -2, 0.5, 0.5), [&](const Vec3& p) {
    return Vec3{p.x, p.y, 0.3 * rng.uniform(-1, 1)};
  });
}

/// A mesh of one kind, moved far from its origin or scaled by a power of two now and then.
inline Mesh arbitrary_mesh(Rng& rng, std::size_t most, const Vec3& offset, double scale) {
  const std::uint64_t kind = rng.below(10);
  if (kind == 8) {  // walls: triangles as large as the scene
    std::vector<Triangle> walls;
    for (std::uint32_t i = 0, count = some(rng, 1, 24); i < count; ++i) {
      const Vec3 at = uniform_point(rng, -4, 4);
      walls.push_back({at, uniform_point(rng, -4, 4), uniform_point(rng, -4, 4)});
    }
    return moved(soup(walls), offset, scale);
  }
  if (kind == 9) {  // small and fine
    const std::uint32_t rings = some(rng, 3, 8), segments = some(rng, 4, 12);
    const double size = std::ldexp(1.0, -static_cast<int>(rng.below(8)));
    return moved(moved(scenes::ball(segments, rings), uniform_point(rng, -4, 4) * (1 / size), size), offset, scale);
  }
  if (kind == 6) {
    const std::uint32_t rings = some(rng, 2, 5), segments = some(rng, 3, 8);
    return moved(scenes::ball(segments, rings), offset, scale);
  }
  if (kind > 6) return moved(dented_sheet(rng), offset, scale);
  std::vector<Triangle> triangles;
  for (std::size_t i = 0, count = 1 + rng.below(most); i < count; ++i) {
    triangles.push_back(arbitrary_triangle(rng, kind));
  }
  if (rng.below(4) == 0) triangles.push_back(triangles.front());
  return moved(soup(triangles), offset, scale);
}

struct Scene {
  Mesh mesh_a, mesh_b;
  Transform pose_a, pose_b;
  double size;       // the length that rounding is relative to
  double tolerance;  // 1e-14 of it
};

inline Scene arbitrary_scene(Rng& rng) {
  const double scale = rng.below(4) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150) : 1;
  const Vec3 offset = rng.below(4) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
  const std::size_t most = rng.below(5) == 0 ? 300 : 30;
  Transform pose_a, pose_b;
  if (offset == Vec3{}) {
    if (rng.below(2) == 0) pose_a = random_pose(rng, 3);
    if (rng.below(2) == 0) pose_b = random_pose(rng, 8);
  }
  pose_a.translation *= scale, pose_b.translation *= scale;
  Mesh mesh_a = arbitrary_mesh(rng, most, offset, scale), mesh_b = arbitrary_mesh(rng, most, offset, scale);
  const double size = (20 + max_abs(offset)) * scale;
  return {std::move(mesh_a), std::move(mesh_b), pose_a, pose_b, size, 1e-14 * size};
}

}  // namespace limber::testing

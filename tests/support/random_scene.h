// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>
#include <vector>

#include "limber/scene.h"
#include "support/random_geometry.h"

/// Random meshes, and two with their poses: soups of every kind, surfaces, huge offsets, any scale.
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

struct RandomScene {
  Mesh mesh_a, mesh_b;
  Transform pose_a, pose_b;
  double size;       // the length that rounding is relative to
  double tolerance;  // 1e-14 of it
};

inline RandomScene arbitrary_scene(Rng& rng) {
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

/// Models of three kinds in a scene, one id of which is free.
struct Heap {
  std::vector<Model> models;
  limber::Scene scene;

  Heap(Rng& rng, std::size_t objects, double range) {
    models.emplace_back(scenes::ball(8, 5));
    models.emplace_back(scenes::grid(3, 3, -1, -1, 0.6, 0.6));
    models.emplace_back(scenes::random_soup(rng, 9, 0.5));
    for (std::size_t i = 0; i < objects; ++i) static_cast<void>(scene.add({models[i % 3], random_pose(rng, range)}));
    if (objects > 4) scene.remove(3);
    scene.commit();
  }
};

// --- meshes that are close to themselves, and margins ---

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

// --- triangles that share a vertex or an edge: the caps of cylinders and cones, books; in order or not, flat or not,
// meeting each other or not ---

/// A flat fan of triangles around one vertex, as a file has the cap of a cylinder.
inline Mesh flat_fan(std::uint32_t count) {
  std::vector<Vec3> positions{{0, 0, 0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    positions.push_back({std::cos(angle), std::sin(angle), 0});
    if (i > 0) triangles.push_back({0, i, i + 1});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// Triangles around one edge, the pages of a book that is open all around.
inline Mesh book(std::uint32_t count) {
  std::vector<Vec3> positions{{0, 0, 0}, {0, 0, 1}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    positions.push_back({std::cos(angle), std::sin(angle), 0.5});
    triangles.push_back({0, 1, i + 2});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A fan or a book of up to 400 triangles, of which some may meet, at any scale, in any order.
inline Mesh arbitrary_fan(Rng& rng) {
  const auto count = static_cast<std::uint32_t>(70 + rng.below(330));
  const bool is_book = rng.below(3) == 0, is_flat = rng.below(2) == 0, is_closed = rng.below(2) == 0;
  const bool has_seams = rng.below(3) == 0;
  const double jitter = rng.below(3) == 0 ? std::ldexp(1.0, -static_cast<int>(rng.below(40))) : 0;
  const double steepness = is_flat ? 0 : rng.uniform(-2, 2), turn = rng.uniform(0.1, 2 * std::numbers::pi);
  const double scale = rng.below(4) == 0 ? std::ldexp(1.0, static_cast<int>(rng.below(300)) - 150) : 1;
  const Vec3 offset = rng.below(4) == 0 ? uniform_point(rng, -1e6, 1e6) : Vec3{};
  const Mat3 rotation = rng.below(2) == 0 ? random_pose(rng, 1).rotation : Mat3{};
  std::vector<Vec3> positions{{0, 0, 0}, {0, 0, is_book ? std::ldexp(1.0, -static_cast<int>(rng.below(30))) : 0.0}};
  std::vector<Corners> triangles;
  for (std::uint32_t i = 0; i <= count; ++i) {
    const double angle = (is_closed ? 2 * std::numbers::pi : turn) * i / count, length = rng.uniform(0.5, 1);
    const Vec3 rim{length * std::cos(angle), length * std::sin(angle), length * steepness};
    positions.push_back(rim + jitter * uniform_point(rng));
    if (is_book) {
      triangles.push_back({0, 1, i + 2});
    } else if (i > 0) {
      triangles.push_back({0, i + 1, i + 2});
    }
  }
  if (has_seams) {
    // Each triangle gets vertices of its own, next to its neighbor's edge or page up to rounding.
    for (Corners& t : triangles) {
      const double length = rng.uniform(0.5, 1);
      positions.push_back(nudged(rng, length * positions[t[is_book ? 2 : 1]], 1));
      t[is_book ? 2 : 1] = static_cast<VertexId>(positions.size() - 1);
    }
  }
  if (rng.below(4) == 0) triangles.push_back(triangles[rng.below(triangles.size())]);
  if (rng.below(4) == 0) {  // one that all may meet
    const auto first = static_cast<VertexId>(positions.size());
    for (int k = 0; k < 3; ++k) positions.push_back(uniform_point(rng));
    triangles.push_back({first, first + 1, first + 2});
  }
  for (std::size_t i = triangles.size(); i > 1; --i) std::swap(triangles[i - 1], triangles[rng.below(i)]);
  for (Vec3& p : positions) p = (rotation * p + offset) * scale;
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

}  // namespace limber::testing

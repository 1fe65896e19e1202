// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
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

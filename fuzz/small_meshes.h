// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "fuzz/coordinates.h"
#include "limber/mesh.h"

/// Meshes and poses from a few bytes each.
namespace limber::fuzz {

inline Vec3 model_point(ByteReader& bytes) {
  const double x = coordinate(bytes), y = coordinate(bytes), z = coordinate(bytes);
  return {x, y, z};
}

/// Up to 12 vertices and 40 triangles between any of them, degenerate and repeated ones included.
inline Mesh soup(ByteReader& bytes, double factor) {
  std::vector<Vec3> positions;
  for (std::uint32_t v = 0, count = 1 + bytes.below(12); v < count; ++v)
    positions.push_back(scaled(model_point(bytes), factor));
  std::vector<Corners> triangles;
  const auto vertex_count = static_cast<std::uint32_t>(positions.size());
  const std::uint32_t most = bytes.below(8) == 7 ? 40 : 12;
  for (std::uint32_t t = 0, count = 1 + bytes.below(most); t < count; ++t) {
    const VertexId v0 = bytes.below(vertex_count), v1 = bytes.below(vertex_count), v2 = bytes.below(vertex_count);
    triangles.push_back({v0, v1, v2});
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A rectangular grid of up to 128 triangles, so that the tree has inner nodes; heights repeat after a few vertices.
inline Mesh sheet(ByteReader& bytes, double factor) {
  const std::uint32_t columns = 1 + bytes.below(8), rows = 1 + bytes.below(8);
  const Vec3 origin = model_point(bytes);
  std::vector<double> heights;
  for (std::uint32_t i = 0, count = 1 + bytes.below(6); i < count; ++i) heights.push_back(coordinate(bytes));
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  for (std::uint32_t y = 0; y <= rows; ++y) {
    for (std::uint32_t x = 0; x <= columns; ++x) {
      const Vec3 offset{0.5 * x, 0.5 * y, heights[positions.size() % heights.size()]};
      positions.push_back(scaled(origin + offset, factor));
      if (x == columns || y == rows) continue;
      const VertexId v = y * (columns + 1) + x, above = v + columns + 1;
      triangles.push_back({v, v + 1, above});
      triangles.push_back({v + 1, above + 1, above});
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

inline Mesh small_mesh(ByteReader& bytes, double factor) {
  return bytes.below(5) == 4 ? sheet(bytes, factor) : soup(bytes, factor);
}

/// A rotation: none, by right angles, or by any angle.
inline Mat3 rotation(ByteReader& bytes) {
  const std::uint32_t kind = bytes.below(4);
  if (kind < 2) return {};
  if (kind == 2) {
    constexpr std::array<Mat3, 4> turns{{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                         {{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                         {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                         {{-1, 0, 0}, {0, -1, 0}, {0, 0, 1}}}};
    return turns[bytes.below(4)];
  }
  const auto part = [&] { return static_cast<double>(bytes.byte()) - 128; };
  const double qw = part() + 0.5, qx = part(), qy = part(), qz = part();
  return transform_from_quaternion({}, qw, qx, qy, qz).value().rotation;
}

inline Transform pose(ByteReader& bytes, double factor) {
  const Mat3 turn = rotation(bytes);
  if (bytes.flag()) return {turn, {}};
  return {turn, scaled(model_point(bytes), factor)};
}

}  // namespace limber::fuzz

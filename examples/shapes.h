// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "limber/limber.h"

/// Meshes for the examples. Yours come from your program, or from files through limber/io.h.
namespace shapes {

/// A flat square around the origin, z = 0, of squares * squares squares, two triangles each.
inline limber::Mesh sheet(std::uint32_t squares, double side) {
  std::vector<limber::Vec3> positions;
  std::vector<limber::Corners> triangles;
  for (std::uint32_t j = 0; j <= squares; ++j) {
    for (std::uint32_t i = 0; i <= squares; ++i) {
      positions.push_back({side * (i / double(squares) - 0.5), side * (j / double(squares) - 0.5), 0});
      if (i == squares || j == squares) continue;
      const std::uint32_t v = j * (squares + 1) + i, above = v + squares + 1;
      triangles.push_back({v, v + 1, above + 1});
      triangles.push_back({v, above + 1, above});
    }
  }
  return limber::Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A closed ball of radius 1 around the origin: `slices` meridians, `slices` / 2 bands, poles on the z axis.
inline limber::Mesh ball(std::uint32_t slices) {
  const std::uint32_t bands = slices / 2, south = 1 + (bands - 1) * slices;
  const auto id = [&](std::uint32_t j, std::uint32_t i) {
    return j == 0 ? 0 : j == bands ? south : 1 + (j - 1) * slices + i % slices;
  };
  std::vector<limber::Vec3> positions(south + 1);
  std::vector<limber::Corners> triangles;
  for (std::uint32_t j = 0; j <= bands; ++j) {
    const double polar = std::numbers::pi * j / bands;
    for (std::uint32_t i = 0; i < slices; ++i) {
      const double turn = 2 * std::numbers::pi * i / slices;
      positions[id(j, i)] = {std::sin(polar) * std::cos(turn), std::sin(polar) * std::sin(turn), std::cos(polar)};
      if (j > 0 && j < bands) triangles.push_back({id(j, i), id(j + 1, i), id(j, i + 1)});
      if (j + 1 < bands) triangles.push_back({id(j, i + 1), id(j + 1, i), id(j + 1, i + 1)});
    }
  }
  return limber::Mesh::create(std::move(positions), std::move(triangles)).value();
}

}  // namespace shapes

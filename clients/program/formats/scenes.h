// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "limber/mesh.h"

/// Meshes that are built in: with IEEE + - * / sqrt and a seeded generator alone, so that they are the same on every
/// machine.
namespace limber::program::scenes {

/// splitmix64.
class Rng {
 public:
  explicit Rng(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next();
  double uniform();  ///< in [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }

 private:
  std::uint64_t state_;
};

/// Within 1e-15 of the true values for arguments of moderate size.
double sine(double x);
double cosine(double x);

/// nx * ny squares of two triangles in the plane z = 0 from the corner (x0, y0) on, each dx by dy. Vertex
/// j * (nx + 1) + i is at (x0 + i dx, y0 + j dy, 0).
Mesh grid(std::uint32_t nx, std::uint32_t ny, double x0, double y0, double dx, double dy);

/// A unit ball around the origin, with poles on the z axis. Pre: slices >= 3, stacks >= 2.
Mesh ball(std::uint32_t slices, std::uint32_t stacks);

/// `square` (8 x 8 units around the origin, 8192 triangles), `ball` (diameter 2, 1024 triangles), `sheet` (100 x 100
/// units, 20 000 triangles).
///
/// Errors   `unsupported_format` naming the scenes there are.
Result<Mesh> by_name(const std::string& name);

}  // namespace limber::program::scenes

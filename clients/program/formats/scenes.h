// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "limber/mesh.h"

/// Meshes that are built in, and how the demonstration deforms one: with IEEE + - * / sqrt and a seeded generator
/// alone, so that they are the same on every machine.
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

Mesh thesis_ball();   ///< diameter 2, 1024 triangles
Mesh thesis_sheet();  ///< 100 x 100 units, 20 000 triangles

/// A frame of a sheet of nx * ny squares that waves over [0, 4] x [0, 4 ny / nx].
Mesh wave_sheet(std::uint32_t nx, std::uint32_t ny, double frame);

/// Triangles without common vertices: around random places in the cube [-1, 1]^3, in cubes of edge `size`.
Mesh random_soup(Rng& rng, std::uint32_t triangles, double size);

/// `square` (8 x 8 units around the origin, 8192 triangles), `ball`, `sheet`; `wave:F` (frame F) and `soup:S` (seed S).
///
/// Errors   `unsupported_format` naming the scenes there are.
Result<Mesh> by_name(const std::string& name);

/// All vertices within `radius` of a vertical line move along z in proportion to their distance from it.
struct Dent {
  double x = 0, y = 0, radius = 1;
  double slope = 0.1;  ///< displacement per unit of distance from the line
};
Dent random_dent(Rng& rng);  ///< of the 100 x 100 sheet

struct VertexMoves {
  std::vector<VertexId> ids;
  std::vector<Vec3> positions;
};
VertexMoves dent_moves(const Dent& dent, std::span<const Vec3> positions);

}  // namespace limber::program::scenes

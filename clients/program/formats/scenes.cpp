// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/scenes.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace limber::program::scenes {
namespace {

using std::numbers::pi;

/// The power series of the sine, whose first term is `x`, or of the cosine, whose first term is 1, reduced to one turn.
double series(double x, bool is_sine) {
  constexpr int terms = 16;  // beyond the first; at |x| <= pi the last is far below one unit in the last place
  x -= std::floor(x / (2 * pi) + 0.5) * (2 * pi);
  double term = is_sine ? x : 1;
  double sum = term;
  for (int k = 1; k <= terms; ++k) {
    const int n = is_sine ? 2 * k + 1 : 2 * k;
    term = term * (-(x * x)) / static_cast<double>(n * (n - 1));
    sum += term;
  }
  return sum;
}

}  // namespace

std::uint64_t Rng::next() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Rng::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

double sine(double x) { return series(x, true); }
double cosine(double x) { return series(x, false); }

Mesh grid(std::uint32_t nx, std::uint32_t ny, double x0, double y0, double dx, double dy) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  positions.reserve((std::size_t{nx} + 1) * (std::size_t{ny} + 1));
  triangles.reserve(std::size_t{2} * nx * ny);
  for (std::uint32_t j = 0; j <= ny; ++j) {
    for (std::uint32_t i = 0; i <= nx; ++i) positions.push_back({x0 + i * dx, y0 + j * dy, 0});
  }
  for (std::uint32_t j = 0; j < ny; ++j) {
    for (std::uint32_t i = 0; i < nx; ++i) {
      const VertexId a = j * (nx + 1) + i;
      const VertexId b = a + 1;
      const VertexId c = a + nx + 2;
      const VertexId d = a + nx + 1;
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Mesh ball(std::uint32_t slices, std::uint32_t stacks) {
  std::vector<Vec3> positions = {{0, 0, 1}};
  for (std::uint32_t k = 1; k < stacks; ++k) {
    const double theta = pi * k / stacks;
    for (std::uint32_t s = 0; s < slices; ++s) {
      const double phi = 2 * pi * s / slices;
      positions.push_back({sine(theta) * cosine(phi), sine(theta) * sine(phi), cosine(theta)});
    }
  }
  positions.push_back({0, 0, -1});
  const auto south = static_cast<VertexId>(positions.size() - 1);

  const auto on_ring = [&](std::uint32_t ring, std::uint32_t s) -> VertexId {
    return 1 + (ring - 1) * slices + s % slices;
  };
  std::vector<Corners> triangles;
  for (std::uint32_t s = 0; s < slices; ++s) triangles.push_back({0, on_ring(1, s), on_ring(1, s + 1)});
  for (std::uint32_t k = 1; k + 1 < stacks; ++k) {
    for (std::uint32_t s = 0; s < slices; ++s) {
      const VertexId a = on_ring(k, s);
      const VertexId b = on_ring(k + 1, s);
      const VertexId c = on_ring(k + 1, s + 1);
      const VertexId d = on_ring(k, s + 1);
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    }
  }
  const std::uint32_t last = stacks - 1;
  for (std::uint32_t s = 0; s < slices; ++s) triangles.push_back({on_ring(last, s), south, on_ring(last, s + 1)});
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

Result<Mesh> by_name(const std::string& name) {
  if (name == "square") return grid(64, 64, -4, -4, 0.125, 0.125);
  if (name == "ball") return ball(32, 17);
  if (name == "sheet") return grid(100, 100, 0, 0, 1, 1);
  return Error{ErrorCode::unsupported_format, "no scene is called '" + name + "'; there are square, ball, sheet", {}};
}

}  // namespace limber::program::scenes

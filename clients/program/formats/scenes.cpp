// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "formats/scenes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "command/text.h"

namespace limber::program::scenes {
namespace {

using std::numbers::pi;

/// Terms of the power series beyond the first; at |x| <= pi the last of them is far below one unit in the last place.
constexpr int series_terms = 16;

double reduced_to_one_turn(double x) { return x - std::floor(x / (2 * pi) + 0.5) * (2 * pi); }

struct NamedScene {
  const char* name;
  std::optional<std::uint64_t> default_number;  ///< of one that takes a number
  Mesh (*make)(std::uint64_t number);
};

constexpr std::array<NamedScene, 5> named_scenes = {{
    {"square", {}, [](std::uint64_t) { return grid(64, 64, -4, -4, 0.125, 0.125); }},
    {"ball", {}, [](std::uint64_t) { return thesis_ball(); }},
    {"sheet", {}, [](std::uint64_t) { return thesis_sheet(); }},
    {"wave", 0, [](std::uint64_t frame) { return wave_sheet(100, 100, static_cast<double>(frame)); }},
    {"soup", 1,
     [](std::uint64_t seed) {
       Rng rng(seed);
       return random_soup(rng, 1000, 0.2);
     }},
}};

}  // namespace

std::uint64_t Rng::next() {
  state_ += 0x9E3779B97F4A7C15ULL;
  std::uint64_t z = state_;
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

double Rng::uniform() { return static_cast<double>(next() >> 11) * 0x1p-53; }

double sine(double x) {
  x = reduced_to_one_turn(x);
  double term = x;
  double sum = x;
  for (int k = 1; k <= series_terms; ++k) {
    term = term * (-(x * x)) / static_cast<double>(2 * k * (2 * k + 1));
    sum += term;
  }
  return sum;
}

double cosine(double x) {
  x = reduced_to_one_turn(x);
  double term = 1;
  double sum = 1;
  for (int k = 1; k <= series_terms; ++k) {
    term = term * (-(x * x)) / static_cast<double>((2 * k - 1) * (2 * k));
    sum += term;
  }
  return sum;
}

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

Mesh thesis_ball() { return ball(32, 17); }
Mesh thesis_sheet() { return grid(100, 100, 0, 0, 1, 1); }

Mesh wave_sheet(std::uint32_t nx, std::uint32_t ny, double frame) {
  const double height = 4.0 * ny / nx;
  const Mesh flat = grid(nx, ny, 0, 0, 4.0 / nx, height / ny);
  std::vector<Vec3> positions = flat.positions();
  const double phase = 0.37 * frame;
  for (Vec3& p : positions) p.z = 0.1 * sine(4 * p.x + phase) * cosine(5 * p.y - 0.7 * phase);
  return Mesh::create(std::move(positions), flat.triangles()).value();
}

Mesh random_soup(Rng& rng, std::uint32_t triangles, double size) {
  const auto point_in = [&rng](double low, double high) {
    Vec3 point;
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = rng.uniform(low, high);
    return point;
  };
  std::vector<Vec3> positions;
  std::vector<Corners> corners;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 place = point_in(-1, 1);
    for (int k = 0; k < 3; ++k) positions.push_back(place + point_in(-size / 2, size / 2));
    corners.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return Mesh::create(std::move(positions), std::move(corners)).value();
}

Result<Mesh> by_name(const std::string& name) {
  const std::size_t colon = name.find(':');
  std::string known;
  for (const NamedScene& scene : named_scenes) {
    known += std::string(known.empty() ? "" : ", ") + scene.name + (scene.default_number ? "[:number]" : "");
    if (name.substr(0, colon) != scene.name) continue;
    if (colon == std::string::npos) return scene.make(scene.default_number.value_or(0));
    const std::optional<std::uint64_t> number = parsed_count(name.substr(colon + 1));
    if (scene.default_number && number) return scene.make(*number);
  }
  return Error{ErrorCode::unsupported_format, "no scene is called '" + name + "'; there are " + known, std::nullopt};
}

Dent random_dent(Rng& rng) {
  Dent dent;
  dent.x = 100 * rng.uniform();
  dent.y = 100 * rng.uniform();
  dent.radius = 1 + 9 * rng.uniform();
  dent.slope = (rng.next() & 1) != 0 ? 0.1 : -0.1;
  return dent;
}

VertexMoves dent_moves(const Dent& dent, std::span<const Vec3> positions) {
  VertexMoves moves;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Vec3& p = positions[i];
    const double dx = p.x - dent.x;
    const double dy = p.y - dent.y;
    const double distance = std::sqrt(dx * dx + dy * dy);
    if (distance > dent.radius) continue;
    moves.ids.push_back(static_cast<VertexId>(i));
    moves.positions.push_back({p.x, p.y, p.z + dent.slope * distance});
  }
  return moves;
}

}  // namespace limber::program::scenes

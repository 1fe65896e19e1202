// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/scenes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace limber::scenes {
namespace {

using std::numbers::pi;
constexpr std::uint64_t pose_seed = 0x5EED0001;
constexpr std::uint64_t linked_ring_seed = 0x5EED0004;

/// Not FNV's own start, 14695981039346656037, but that number without its last digit, with which the published hashes
/// of these meshes were made. Any start serves.
constexpr std::uint64_t hash_start = 1469598103934665603U;

/// Terms of the power series beyond the first; at |x| <= pi the last of them is far below one unit in the last place.
constexpr int series_terms = 16;

double reduced_to_one_turn(double x) { return x - std::floor(x / (2 * pi) + 0.5) * (2 * pi); }

/// The generators below only make sound meshes. A failure is a mistake in them, so it may throw.
Mesh made(std::vector<Vec3> positions, std::vector<Corners> triangles) {
  return Mesh::create(std::move(positions), std::move(triangles)).value();
}

/// A soup from a source of corners: triangle i owns the vertices 3 i, 3 i + 1, 3 i + 2.
template <typename NextTriangle>
Mesh soup(std::uint32_t triangle_count, NextTriangle next_triangle) {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  positions.reserve(std::size_t{3} * triangle_count);
  triangles.reserve(triangle_count);
  for (std::uint32_t i = 0; i < triangle_count; ++i) {
    for (const Vec3& corner : next_triangle()) positions.push_back(corner);
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return made(std::move(positions), std::move(triangles));
}

template <typename Draw>
Vec3 drawn_point(Draw draw) {
  const double x = draw();
  const double y = draw();
  const double z = draw();
  return {x, y, z};
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

double Rng::uniform(double low, double high) { return low + (high - low) * uniform(); }

std::uint64_t Rng::below(std::uint64_t bound) { return next() % bound; }

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

Mat3 random_rotation(Rng& rng) {
  const double u1 = rng.uniform();
  const double u2 = rng.uniform();
  const double u3 = rng.uniform();
  const double a = std::sqrt(1 - u1);
  const double b = std::sqrt(u1);
  double x = a * sine(2 * pi * u2);
  double y = a * cosine(2 * pi * u2);
  double z = b * sine(2 * pi * u3);
  double w = b * cosine(2 * pi * u3);
  const double norm = std::sqrt(x * x + y * y + z * z + w * w);
  x /= norm;
  y /= norm;
  z /= norm;
  w /= norm;
  return {{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)},
          {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)},
          {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)}};
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
  return made(std::move(positions), std::move(triangles));
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
  return made(std::move(positions), std::move(triangles));
}

Mesh ring(std::uint32_t around, std::uint32_t across, double tube) {
  std::vector<Vec3> circle;  // points of the section, in the half plane of x and z
  for (std::uint32_t j = 0; j < across; ++j) {
    const double angle = 2 * pi * j / across;
    circle.push_back({1 + tube * cosine(angle), 0, tube * sine(angle)});
  }
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;
  positions.reserve(std::size_t{around} * across);
  triangles.reserve(std::size_t{2} * around * across);
  for (std::uint32_t i = 0; i < around; ++i) {
    const double angle = 2 * pi * i / around, x = cosine(angle), y = sine(angle);
    for (const Vec3& p : circle) positions.push_back({p.x * x, p.x * y, p.z});
    const std::uint32_t here = i * across, next = (i + 1) % around * across;
    for (std::uint32_t j = 0; j < across; ++j) {
      const std::uint32_t after = (j + 1) % across;
      triangles.push_back({here + j, next + j, next + after});
      triangles.push_back({here + j, next + after, here + after});
    }
  }
  return made(std::move(positions), std::move(triangles));
}

Mesh thesis_square() { return grid(64, 64, -4, -4, 0.125, 0.125); }
Mesh thesis_ball() { return ball(32, 17); }
Mesh thesis_sheet() { return grid(100, 100, 0, 0, 1, 1); }

Mesh wave_sheet(std::uint32_t nx, std::uint32_t ny, double frame) {
  const double height = 4.0 * ny / nx;
  const Mesh flat = grid(nx, ny, 0, 0, 4.0 / nx, height / ny);
  std::vector<Vec3> positions = flat.positions();
  const double phase = 0.37 * frame;
  for (Vec3& p : positions) p.z = 0.1 * sine(4 * p.x + phase) * cosine(5 * p.y - 0.7 * phase);
  return made(std::move(positions), flat.triangles());
}

Mesh random_soup(Rng& rng, std::uint32_t triangles, double size) {
  return soup(triangles, [&] {
    const Vec3 place = drawn_point([&] { return rng.uniform(-1, 1); });
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) corner = place + drawn_point([&] { return rng.uniform(-size / 2, size / 2); });
    return corners;
  });
}

Mesh lattice_soup(Rng& rng, std::uint32_t triangles, std::uint32_t side) {
  return soup(triangles, [&] {
    std::array<Vec3, 3> corners;
    for (Vec3& corner : corners) corner = drawn_point([&] { return static_cast<double>(rng.below(side)); });
    return corners;
  });
}

Transform ball_over_square(const Mesh& ball, double separation, std::uint32_t index) {
  Rng rng(pose_seed + index);
  Transform pose;
  pose.rotation = random_rotation(rng);
  if (index == 0) {
    pose.translation.x = 0.1 * std::sqrt(2.0);
    pose.translation.y = 0.1 * std::sqrt(3.0);
  } else {
    pose.translation.x = 2 * rng.uniform() - 1;
    pose.translation.y = 2 * rng.uniform() - 1;
  }
  double lowest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : ball.positions()) lowest = std::min(lowest, dot(pose.rotation.row2, p));
  pose.translation.z = separation - lowest;
  return pose;
}

Transform linked_ring(std::uint32_t index) {
  Rng rng(linked_ring_seed + index);
  const double roll = pi / 2 + rng.uniform(-0.3, 0.3), turn = rng.uniform(-0.3, 0.3);
  Transform pose;
  pose.rotation = {{cosine(turn), -sine(turn) * cosine(roll), sine(turn) * sine(roll)},
                   {sine(turn), cosine(turn) * cosine(roll), -cosine(turn) * sine(roll)},
                   {0, sine(roll), cosine(roll)}};
  pose.translation.x = 1 + rng.uniform(-0.25, 0.25);
  pose.translation.y = rng.uniform(-0.25, 0.25);
  pose.translation.z = rng.uniform(-0.25, 0.25);
  return pose;
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

std::uint64_t hash(MeshView mesh) {
  std::uint64_t state = hash_start;
  const auto mix = [&state](std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) state = (state ^ ((value >> (8 * i)) & 0xFF)) * 0x100000001B3ULL;
  };
  for (const Vec3& p : mesh.positions) {
    for (const double coordinate : {p.x, p.y, p.z}) mix(std::bit_cast<std::uint64_t>(coordinate), 8);
  }
  for (const Corners& triangle : mesh.triangles) {
    for (const VertexId corner : triangle) mix(corner, 4);
  }
  return state;
}

}  // namespace limber::scenes

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "scenes/motions.h"

#include <cmath>
#include <memory>
#include <utility>

namespace limber::scenes {
namespace {

constexpr std::uint64_t soup_seed = 0x5EED0010, displacement_seed = 0x5EED0011;
constexpr double half_period = 250;  // frames

/// 0 in frame 0, 1 in frame half_period, 0 again in frame 2 * half_period, and so on.
double there_and_back(double frame) {
  const double phase = frame - 2 * half_period * std::floor(frame / (2 * half_period));
  return (phase <= half_period ? phase : 2 * half_period - phase) / half_period;
}

/// Positions of frame f are each(vertex, its first position, f).
template <typename Each>
Motion motion(std::string name, Mesh mesh, Each each) {
  const auto start = std::make_shared<const std::vector<Vec3>>(mesh.positions());
  return {std::move(name), std::move(mesh), [start, each](double frame) {
            std::vector<Vec3> positions = *start;
            for (std::size_t v = 0; v < positions.size(); ++v) positions[v] = each(v, positions[v], frame);
            return positions;
          }};
}

Vec3 turned_about_z(const Vec3& p, double angle) {
  const double c = cosine(angle), s = sine(angle);
  return {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
}

}  // namespace

Motion waving_sheet(std::uint32_t nx, std::uint32_t ny) {
  return motion("waving sheet", wave_sheet(nx, ny, 0), [](std::size_t, const Vec3& p, double frame) {
    const double phase = 0.37 * frame;
    return Vec3{p.x, p.y, 0.1 * sine(4 * p.x + phase) * cosine(5 * p.y - 0.7 * phase)};
  });
}

Motion twisting_bar(std::uint32_t per_side) {
  // A sheet is rolled up along x; coincident vertices close it.
  const Mesh sheet = grid(4 * per_side, 8 * per_side, 0, 0, 1.0 / per_side, 1.0 / per_side);
  std::vector<Vec3> positions = sheet.positions();
  for (Vec3& p : positions) {
    const double along = p.x - std::floor(p.x), z = p.y - 4;
    const Vec3 sides[] = {{along - 0.5, -0.5, z}, {0.5, along - 0.5, z}, {0.5 - along, 0.5, z}, {-0.5, 0.5 - along, z}};
    p = sides[static_cast<int>(p.x) % 4];
  }
  return motion("twisting bar", Mesh::create(std::move(positions), sheet.triangles()).value(),
                [](std::size_t, const Vec3& p, double frame) {
                  constexpr double two_turns = 12.566370614359172;
                  return turned_about_z(p, two_turns * there_and_back(frame) * (1 - std::abs(p.z) / 4));
                });
}

Motion crumpling_cloth(std::uint32_t n) {
  return motion("crumpling cloth", grid(n, n, -1, -1, 2.0 / n, 2.0 / n), [](std::size_t, const Vec3& p, double frame) {
    const double t = there_and_back(frame), shrunk = 1 - 0.67 * t;
    Vec3 place{shrunk * p.x, shrunk * p.y, 0};
    // Folds in seven directions, each finer and lower than the last.
    double fineness = 3, height = 0.25;
    for (int k = 0; k < 7; ++k) {
      const double angle = 2.4 * k, across = fineness * (cosine(angle) * p.x + sine(angle) * p.y);
      const double wave = height * t * sine(across + 0.7 * k + 3 * t);
      place += Vec3{0.6 * wave * cosine(1.3 * k), 0.6 * wave * sine(1.3 * k), wave};
      fineness *= 1.45, height *= 0.75;
    }
    return place;
  });
}

Motion shuffled_soup(std::uint32_t triangles) {
  Rng soup_rng(soup_seed), rng(displacement_seed);
  Mesh soup = random_soup(soup_rng, triangles, 0.05);
  const auto center = [&](TriangleId t) {
    const Triangle corners = soup.triangle(t);
    return (corners.v0 + corners.v1 + corners.v2) * (1.0 / 3);
  };
  std::vector<TriangleId> goal(triangles);
  for (TriangleId t = 0; t < triangles; ++t) goal[t] = t;
  for (TriangleId t = triangles; t > 1; --t) std::swap(goal[t - 1], goal[rng.below(t)]);
  std::vector<Vec3> displacements;
  for (TriangleId t = 0; t < triangles; ++t) displacements.push_back(center(goal[t]) - center(t));
  const auto shared = std::make_shared<const std::vector<Vec3>>(std::move(displacements));
  return motion("shuffled soup", std::move(soup), [shared](std::size_t v, const Vec3& p, double frame) {
    return p + (frame / (2.0 * half_period)) * (*shared)[v / 3];
  });
}

}  // namespace limber::scenes

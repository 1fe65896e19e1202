// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "limber/mesh.h"
#include "run_program.h"

/// Meshes that several tests ask about. Contacts of all but the soups are counted on paper.
namespace limber::program_tests {

/// A square of two triangles in the plane z = 0, split along the diagonal from (-1, -1) to (1, 1). Triangle 0 is where
/// x >= y.
inline Mesh two_triangles() { return scenes::grid(1, 1, -1, -1, 2, 2); }

/// A frame of a sheet of nx * ny squares that waves over [0, 4] x [0, 4 ny / nx].
inline Mesh wave_sheet(std::uint32_t nx, std::uint32_t ny, double frame) {
  const double height = 4.0 * ny / nx, phase = 0.37 * frame;
  Mesh sheet = scenes::grid(nx, ny, 0, 0, 4.0 / nx, height / ny);
  std::vector<Vec3> positions = sheet.positions();
  for (Vec3& p : positions) p.z = 0.1 * scenes::sine(4 * p.x + phase) * scenes::cosine(5 * p.y - 0.7 * phase);
  sheet.set_positions(positions).value();
  return sheet;
}

/// A mesh that is put together from parts.
struct Parts {
  std::vector<Vec3> positions;
  std::vector<Corners> triangles;

  Parts& add(MeshView part, double scale = 1, const Vec3& center = {}) {
    const auto first = static_cast<VertexId>(positions.size());
    for (const Vec3& p : part.positions) positions.push_back(center + scale * p);
    for (const Corners& c : part.triangles) triangles.push_back({c[0] + first, c[1] + first, c[2] + first});
    return *this;
  }

  /// Two triangles a face, the top last. The top is split along the diagonal from the corner of least x and y to that
  /// of most; the first triangle is where x >= y.
  Parts& add_box(const Vec3& low, const Vec3& high) {
    std::vector<Vec3> corners;
    for (const double z : {low.z, high.z}) {
      for (const double y : {low.y, high.y}) {
        for (const double x : {low.x, high.x}) corners.push_back({x, y, z});
      }
    }
    const std::vector<Corners> sides = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}, {1, 3, 7}, {1, 7, 5},
                                        {3, 2, 6}, {3, 6, 7}, {2, 0, 4}, {2, 4, 6}, {4, 5, 7}, {4, 7, 6}};
    return add({corners, sides});
  }

  Parts& add_ball(double radius, const Vec3& center = {}) { return add(scenes::ball(16, 8), radius, center); }

  /// Turns the last triangles over, so that a part is a cavity.
  Parts& turn(std::size_t count) {
    for (std::size_t t = triangles.size() - count; t < triangles.size(); ++t)
      std::swap(triangles[t][0], triangles[t][1]);
    return *this;
  }

  std::string stored(const Folder& folder, const std::string& name) const {
    return folder.store(name, MeshView{positions, triangles});
  }
};

inline Mesh cube(const Vec3& center, double half_side) {
  const Vec3 half{half_side, half_side, half_side};
  Parts box = Parts().add_box(center - half, center + half);
  return Mesh::create(std::move(box.positions), std::move(box.triangles)).value();
}

/// A strip of four squares along x, folded behind the second: the last square lies over the first, at height z_3 where
/// x = 1.3 and at height z_4 where x = 0.3. Square i is triangles 2 i and 2 i + 1.
inline Mesh folded_strip(double z_3, double z_4) {
  Mesh strip = scenes::grid(4, 1, 0, 0, 1, 1);
  std::vector<Vec3> positions = strip.positions();
  for (std::size_t j = 0; j < 2; ++j) {
    const double y = static_cast<double>(j);
    positions[5 * j + 3] = {1.3, y, z_3};
    positions[5 * j + 4] = {0.3, y, z_4};
  }
  strip.set_positions(positions).value();
  return strip;
}

/// Triangles without common vertices: around random places in the cube [-1, 1]^3, in cubes of edge `size`.
inline Mesh random_soup(scenes::Rng& rng, std::uint32_t triangles, double size) {
  const auto point_in = [&rng](double low, double high) {
    Vec3 point;
    for (std::size_t axis = 0; axis < 3; ++axis) point[axis] = rng.uniform(low, high);
    return point;
  };
  Parts soup;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const Vec3 place = point_in(-1, 1);
    for (int k = 0; k < 3; ++k) soup.positions.push_back(place + point_in(-size / 2, size / 2));
    soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return Mesh::create(std::move(soup.positions), std::move(soup.triangles)).value();
}

/// Two soups at the same place, and their files.
struct Soups {
  Folder folder;
  scenes::Rng rng;
  Mesh a, b;
  std::string file_a, file_b;

  Soups(std::uint64_t seed, double size)
      : rng(seed),
        a(random_soup(rng, 60, size)),
        b(random_soup(rng, 50, size)),
        file_a(folder.store("a.obj", a)),
        file_b(folder.store("b.obj", b)) {}

  std::string files() const { return ' ' + file_a + ' ' + file_b + ' '; }
};

}  // namespace limber::program_tests

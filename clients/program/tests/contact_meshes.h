// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "limber/mesh.h"
#include "run_program.h"
#include "scenes/scenes.h"

/// Meshes that several tests ask about. Contacts of all but the soups are counted on paper.
namespace limber::program_tests {

/// A square of two triangles in the plane z = 0, split along the diagonal from (-1, -1) to (1, 1). Triangle 0 is where
/// x >= y.
inline Mesh two_triangles() { return scenes::grid(1, 1, -1, -1, 2, 2); }

/// The twelve triangles of a cube along the axes, two a face, the top last. The top is split along the diagonal
/// from the corner of least x and y to that of most; the first triangle is where x >= y.
inline Mesh cube(const Vec3& center, double half_side) {
  std::vector<Vec3> positions;
  for (const double z : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      for (const double x : {-1.0, 1.0}) positions.push_back(center + half_side * Vec3{x, y, z});
    }
  }
  return Mesh::create(std::move(positions), {{0, 2, 3},
                                             {0, 3, 1},
                                             {0, 1, 5},
                                             {0, 5, 4},
                                             {1, 3, 7},
                                             {1, 7, 5},
                                             {3, 2, 6},
                                             {3, 6, 7},
                                             {2, 0, 4},
                                             {2, 4, 6},
                                             {4, 5, 7},
                                             {4, 7, 6}})
      .value();
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

/// Two soups at the same place, and their files.
struct Soups {
  Folder folder;
  scenes::Rng rng;
  Mesh a, b;
  std::string file_a, file_b;

  Soups(std::uint64_t seed, double size)
      : rng(seed),
        a(scenes::random_soup(rng, 60, size)),
        b(scenes::random_soup(rng, 50, size)),
        file_a(folder.store("a.obj", a)),
        file_b(folder.store("b.obj", b)) {}

  std::string files() const { return ' ' + file_a + ' ' + file_b + ' '; }
};

}  // namespace limber::program_tests

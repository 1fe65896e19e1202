// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "limber/penetration.h"
#include "scenes/surfaces.h"
#include "support/random_geometry.h"

/// Closed surfaces of the kinds that break code, and what a loop over vertices says of two of them.
namespace limber::testing {

/// A model and its surface.
struct SolidModel {
  explicit SolidModel(Mesh mesh) : model(std::move(mesh)), surface(ClosedSurface::create(model).value()) {}
  Model model;
  ClosedSurface surface;
};

inline Mesh turned_inside_out(const Mesh& mesh) {
  std::vector<Corners> triangles = mesh.triangles();
  for (Corners& c : triangles) std::swap(c[1], c[2]);
  return Mesh::create(mesh.positions(), std::move(triangles)).value();
}

inline Mesh tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return Mesh::create({a, b, c, d}, {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}}).value();
}

inline Box lattice_box(Rng& rng, std::uint64_t side = 5) {
  const Vec3 low = lattice_point(rng, side);
  return {low, low + Vec3{1, 1, 1} + lattice_point(rng, 3)};
}

/// A box with a smaller one taken out of it.
inline Mesh hollow_box(const Vec3& low, const Vec3& high, double wall) {
  const Vec3 w{wall, wall, wall};
  return joined(scenes::boxes({{low, high}}), turned_inside_out(scenes::boxes({{low + w, high - w}})));
}

/// Some solid at the lattice, of at most `most_triangles` triangles, but for tetrahedra and boxes.
inline Mesh random_solid(Rng& rng, std::uint64_t kind_count = 8) {
  switch (rng.below(kind_count)) {
    case 0: {
      const Vec3 a = lattice_point(rng), b = lattice_point(rng), c = lattice_point(rng), d = lattice_point(rng);
      return tetrahedron(a, b, c, d);  // flat ones and points among them
    }
    case 1: {
      const Vec3 a = uniform_point(rng, 0, 4), b = uniform_point(rng, 0, 4), c = uniform_point(rng, 0, 4);
      const double height = rng.below(2) == 0 ? 1 : std::pow(10.0, rng.uniform(-12, 0));
      return tetrahedron(a, b, c, (a + b + c) * (1.0 / 3) + height * uniform_point(rng));
    }
    case 2:
      return scenes::boxes({lattice_box(rng)});
    case 3: {
      const Box one = lattice_box(rng), two = lattice_box(rng);
      return scenes::boxes({one, two});
    }
    case 4:
      return hollow_box({0, 0, 0}, {4, 4, 4}, rng.below(2) == 0 ? 1 : rng.uniform(0.1, 1.9));
    case 5: {
      const Vec3 center = lattice_point(rng), stretch = uniform_point(rng, 0.05, 2);
      return mapped(
          scenes::ball(3 + static_cast<std::uint32_t>(rng.below(6)), 2 + static_cast<std::uint32_t>(rng.below(4))),
          [&](const Vec3& p) {
            return center + Vec3{p.x * stretch.x, p.y * stretch.y, p.z * stretch.z};
          });
    }
    case 6: {
      const Vec3 center = lattice_point(rng);
      return mapped(scenes::ring(3 + static_cast<std::uint32_t>(rng.below(6)), 3, rng.uniform(0.1, 0.6)),
                    [&](const Vec3& p) { return center + 2 * p; });
    }
    default:
      return turned_inside_out(random_solid(rng, 7));
  }
}

/// The deepest vertex of a mesh in a solid, by a loop over all vertices.
inline std::optional<DeepestVertex> deepest_by_loop(const Mesh& mesh, const Transform& pose, const ClosedSurface& solid,
                                                    const Transform& pose_of_solid) {
  std::vector<VertexId> used;
  for (const Corners& c : mesh.triangles()) used.insert(used.end(), c.begin(), c.end());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::optional<DeepestVertex> best;
  for (const VertexId v : used) {
    const Vec3 position = pose(mesh.positions()[v]);
    const SignedDistance found = solid.signed_distance(position, pose_of_solid);
    if (!found.is_inside || (best && found.closest->distance <= best->depth)) continue;
    best = DeepestVertex{v, found.closest->distance, position, *found.closest, {}};
  }
  return best;
}

}  // namespace limber::testing

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "limber/mesh.h"
#include "support/random_geometry.h"

/// Triangles of one mesh that share vertices, from a seeded generator: ordinary neighbours, and all that degenerates.
namespace limber::testing {

/// Two triangles by ids of common positions.
struct Neighbors {
  std::vector<Vec3> positions;
  Corners ids_a, ids_b;

  Triangle triangle(const Corners& ids) const { return {positions[ids[0]], positions[ids[1]], positions[ids[2]]}; }
  Triangle a() const { return triangle(ids_a); }
  Triangle b() const { return triangle(ids_b); }

  /// The ids that both name, each once.
  std::vector<VertexId> shared() const {
    std::vector<VertexId> ids;
    for (VertexId id = 0; id < positions.size(); ++id) {
      if (std::count(ids_a.begin(), ids_a.end(), id) > 0 && std::count(ids_b.begin(), ids_b.end(), id) > 0) {
        ids.push_back(id);
      }
    }
    return ids;
  }
};

constexpr int neighbor_kinds = 12;

/// Five positions of a kind.
inline std::vector<Vec3> positions_of_kind(Rng& rng, int kind) {
  const Triangle plane = uniform_triangle(rng);
  const Vec3 step = lattice_point(rng) - Vec3{1, 1, 1};
  const auto flat = [](Vec3 q) { return Vec3{q.x, q.y, 0}; };
  const auto position = [&](std::size_t i) -> Vec3 {
    const double s = rng.uniform(-1, 2), t = rng.uniform(-1, 2);
    if (kind == 0) return uniform_point(rng);
    if (kind == 1) return lattice_point(rng);
    if (kind == 2) return nudged(rng, lattice_point(rng));
    if (kind == 3) return flat(lattice_point(rng));
    if (kind == 4) return nudged(rng, flat(lattice_point(rng)));
    if (kind == 5) return flat(uniform_point(rng));
    if (kind == 6) return point_on(plane, s, t);                       // coplanar up to rounding
    if (kind == 7) return flat(plane.v0 + s * (plane.v1 - plane.v0));  // collinear up to rounding, but coplanar
    if (kind == 8) return static_cast<double>(rng.below(5)) * step;    // collinear
    if (kind == 9) return std::ldexp(1.0, -static_cast<int>(rng.below(400))) * lattice_point(rng);
    if (kind == 10) return nudged(rng, plane.v0 + s * (plane.v1 - plane.v0));  // slivers
    const double angle = static_cast<double>(i) * 1.05 + 0.3 * rng.uniform();  // a fan, flat or nearly so
    return i == 0 ? Vec3{} : Vec3{std::cos(angle), std::sin(angle), rng.below(2) == 0 ? 0 : 0.1 * rng.uniform()};
  };
  std::vector<Vec3> p(5);
  for (std::size_t i = 0; i < p.size(); ++i) p[i] = position(i);
  if (rng.below(6) == 0) p[4] = nudged(rng, point_on({p[0], p[1], p[2]}, rng.uniform(), rng.uniform()), 1);
  return p;
}

/// Two triangles that share one or two vertices, now and then three.
inline Neighbors random_neighbors(Rng& rng, int kind) {
  Neighbors n{positions_of_kind(rng, kind), {0, 1, 2}, {0, 3, 4}};
  if (rng.below(2) == 0) n.ids_b[1] = 1;
  if (rng.below(16) == 0) n.ids_b = {0, 1, 2};
  if (rng.below(16) == 0) n.ids_a[rng.below(3)] = static_cast<VertexId>(rng.below(5));
  if (rng.below(16) == 0) n.ids_b[rng.below(3)] = static_cast<VertexId>(rng.below(5));
  if (n.shared().empty()) n.ids_b[0] = n.ids_a[0];
  // Some at scales where products of four lengths underflow, some far from the origin.
  const double scale = rng.below(4) != 0 ? 1 : std::ldexp(1.0, static_cast<int>(rng.below(438)) - 250);
  const Vec3 offset = rng.below(8) == 0 ? uniform_point(rng, -1e3, 1e3) : Vec3{};
  for (Vec3& p : n.positions) p = scale * (p + offset);
  for (Corners* ids : {&n.ids_a, &n.ids_b}) {
    std::rotate(ids->begin(), ids->begin() + static_cast<std::ptrdiff_t>(rng.below(3)), ids->end());
    if (rng.below(2) == 0) std::swap((*ids)[0], (*ids)[1]);
  }
  return n;
}

}  // namespace limber::testing

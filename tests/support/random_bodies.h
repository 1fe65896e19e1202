// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "limber/distance.h"
#include "limber/points.h"
#include "limber/shapes.h"
#include "reference/reference.h"
#include "support/random_geometry.h"

/// Random bodies: shapes, meshes and solids; and the truth about two of them by brute force over the triangles of their
/// cores.
namespace limber::testing {

/// A body with all that it points to.
struct OwnedBody {
  std::shared_ptr<const Shape> shape;
  std::shared_ptr<const Model> model;
  std::optional<ClosedSurface> surface;

  Body body() const {
    if (shape) return *shape;
    return surface ? Body(*surface) : Body(*model);
  }
};

inline OwnedBody owned(Shape shape) { return {std::make_shared<const Shape>(std::move(shape)), nullptr, {}}; }
inline OwnedBody owned(Mesh mesh) { return {nullptr, std::make_shared<const Model>(std::move(mesh)), {}}; }
inline OwnedBody owned_solid(Mesh mesh) {
  OwnedBody body = owned(std::move(mesh));
  body.surface = ClosedSurface::create(*body.model).value();
  return body;
}

/// Any number, or one that leads to ties: a multiple of a half, rarely 0.
inline double some_size(Rng& rng, bool is_on_lattice, double most = 1) {
  return is_on_lattice ? 0.5 * std::floor(2 * most * rng.uniform(0, 1.99)) : most * rng.uniform(0.01, 1);
}
inline Vec3 some_point(Rng& rng, bool is_on_lattice) {
  return is_on_lattice ? 0.5 * lattice_point(rng) - Vec3{1, 1, 1} : uniform_point(rng);
}
inline Transform some_pose(Rng& rng, bool is_on_lattice, double range) {
  if (!is_on_lattice) return random_pose(rng, range);
  return {Mat3{}, range * 0.5 * (lattice_point(rng, 5) - Vec3{2, 2, 2})};
}

constexpr std::uint64_t body_kinds = 10;
inline OwnedBody random_body(Rng& rng, std::uint64_t kind, bool is_on_lattice) {
  const auto size = [&](double most = 1) { return some_size(rng, is_on_lattice, most); };
  const auto point = [&] { return some_point(rng, is_on_lattice); };
  switch (kind) {
    case 0:
      return owned(Shape::sphere(size()));
    case 1: {
      const Vec3 from = point(), to = point();
      return owned(Shape::capsule(from, to, size(0.5)));
    }
    case 2: {
      const double x = size(), y = size(), z = size();
      return owned(Shape::box({x, y, z}));
    }
    case 3: {
      const double x = size(), y = size(), z = size();
      return owned(Shape::box({x, y, z}, size(0.5)));
    }
    case 4:
      return owned(Shape::cylinder({0, 0, -0.5}, {0, 0, size() + 0.5}, size() + 0.5, 0.1));
    case 5: {
      const Vec3 normal = is_on_lattice ? Vec3{0, 0, 1} : point();
      return owned(Shape::half_space(normal, size() - 0.5, 8));
    }
    case 6:
      return owned(scenes::ball(8, 5));
    case 7:
      return owned_solid(scenes::ball(8, 5));
    case 8:
      return owned(is_on_lattice ? scenes::lattice_soup(rng, 20, 3) : scenes::random_soup(rng, 20, 0.5));
    default:
      return owned_solid(joined(scenes::ball(6, 4), mapped(scenes::ball(5, 4), [](const Vec3& p) {
                                  return 0.25 * p + Vec3{2, 0, 0};
                                })));
  }
}

/// What brute force says of two bodies.
struct BodiesTruth {
  double cores;  ///< the distance of the cores
  double radius;
  bool is_contained;  ///< whether a vertex of one core is in the solid of the other one
  double tolerance;

  double distance() const { return is_contained ? 0 : std::max(0.0, cores - radius); }
};

inline reference::Placed core_of(const Placed& p) { return {p.model().mesh().view(), p.pose}; }

inline bool has_vertex_in(const Placed& p, const Placed& solid) {
  if (!solid.body().is_solid()) return false;
  const MeshView mesh = p.model().mesh();
  return std::any_of(mesh.triangles.begin(), mesh.triangles.end(), [&](const Corners& corners) {
    return std::any_of(corners.begin(), corners.end(),
                       [&](VertexId v) { return reference::contains(core_of(solid), p.pose(mesh.positions[v])); });
  });
}

inline BodiesTruth truth_of(const Placed& a, const Placed& b) {
  BodiesTruth truth{};
  truth.cores = reference::distance(core_of(a), core_of(b)).upper;
  truth.radius = a.body().radius() + b.body().radius();
  truth.is_contained = has_vertex_in(a, b) || has_vertex_in(b, a);
  double size = truth.radius + truth.cores;
  for (const Placed* p : {&a, &b}) {
    const Sphere sphere = p->model().bounding_sphere();
    size += max_abs(p->pose.translation) + max_abs(sphere.center) + sphere.radius;
  }
  truth.tolerance = 0x1p-43 * size;
  return truth;
}

}  // namespace limber::testing

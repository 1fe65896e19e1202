// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Models and shapes.
#include <cstring>
#include <utility>
#include <vector>

#include "bindings.h"
#include "limber/mesh.h"
#include "limber/model.h"
#include "limber/shapes.h"

namespace limber::web {
namespace {

struct OwnedShape final : OwnedBody {
  explicit OwnedShape(Shape made) : shape(std::move(made)) {}
  Body body() const override { return shape; }

  const Shape shape;
};

std::size_t position_bytes(std::size_t count, bool is_float32) {
  return 3 * count * (is_float32 ? sizeof(float) : sizeof(double));
}

/// What make() returns; null if it has thrown. Gives the radius, and whether it is a solid.
template <typename Make>
OwnedBody* made_shape(const Make& make) {
  return made([&] {
    auto* const owned = new OwnedShape(make());
    give_numbers(owned->shape.radius(), owned->shape.is_solid());
    return owned;
  });
}

}  // namespace

/// A model of the coordinates in input(), and of the ids of triangles behind them.
LIMBER_EXPORT(newModel)
OwnedModel* new_model(std::size_t vertex_count, bool is_float32, std::size_t triangle_count, double motion_margin,
                      bool rebuilds) {
  return made([&] {
    const std::span ids = ids_from(3 * triangle_count, position_bytes(vertex_count, is_float32));
    std::vector<Corners> triangles(triangle_count);
    if (triangle_count > 0) std::memcpy(triangles.data(), ids.data(), ids.size_bytes());
    Mesh mesh = Mesh::create(positions_from(vertex_count, is_float32), std::move(triangles)).value();
    const RebuildPolicy policy = rebuilds ? RebuildPolicy::in_commit : RebuildPolicy::off;
    return new OwnedModel(std::move(mesh), ModelOptions{.motion_margin = motion_margin, .rebuild_policy = policy});
  });
}

/// Positions in input(), then ids.
LIMBER_EXPORT(moveVertices) bool move_vertices(OwnedModel* model, std::size_t count, bool is_float32) {
  return guarded([&] {
    const std::span ids = ids_from(count, position_bytes(count, is_float32));
    model->move_vertices(ids, positions_from(count, is_float32)).value();
  });
}

LIMBER_EXPORT(moveAll) bool move_all(OwnedModel* model, std::size_t count, bool is_float32) {
  return guarded([&] { model->move_all(positions_from(count, is_float32)).value(); });
}

LIMBER_EXPORT(commit) bool commit(OwnedModel* model) {
  return guarded([&] { model->commit(); });
}

LIMBER_EXPORT(rebuild) bool rebuild(OwnedModel* model) {
  return guarded([&] { model->rebuild(); });
}

LIMBER_EXPORT(verticesOf) void vertices_of(const OwnedModel* model) {
  const std::span positions = model->mesh().positions();
  give_bytes(positions.data(), positions.size_bytes());
}

/// The two vertices of each edge.
LIMBER_EXPORT(edgesOf) bool edges_of(const OwnedModel* model) {
  return guarded([&] {
    const std::span vertices = model->edges().vertices();
    give_bytes(vertices.data(), vertices.size_bytes());
  });
}

LIMBER_EXPORT(boundingBox) bool bounding_box(const OwnedModel* model) {
  return guarded([&] {
    const auto [low, high] = model->bounding_box();
    give_numbers(low.x, low.y, low.z, high.x, high.y, high.z);
  });
}

// --- shapes ---

LIMBER_EXPORT(newSphere) OwnedBody* new_sphere(double radius) {
  return made_shape([&] { return Shape::sphere(radius); });
}

LIMBER_EXPORT(newBox) OwnedBody* new_box(double x, double y, double z, double radius) {
  return made_shape([&] { return Shape::box({x, y, z}, radius); });
}

/// Around the points in input(): two, in float64, for the ends of a capsule.
LIMBER_EXPORT(newCapsule) OwnedBody* new_capsule(double radius) {
  return made_shape([&] {
    const std::vector<Vec3> ends = points_from(2, false);
    return Shape::capsule(ends[0], ends[1], radius);
  });
}

LIMBER_EXPORT(newConvexHull) OwnedBody* new_convex_hull(std::size_t count, bool is_float32, double radius) {
  return made_shape([&] { return Shape::convex_hull(points_from(count, is_float32), radius); });
}

}  // namespace limber::web

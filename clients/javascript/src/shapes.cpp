// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/shapes.h"

#include <utility>
#include <vector>

#include "bindings.h"

namespace limber::web {
namespace {

struct OwnedShape : BodyOwner {
  explicit OwnedShape(Shape made) : shape(std::move(made)) {}
  Body body() const override { return shape; }

  const Shape shape;
};

/// What make() returns, or null on failure. Writes radius, deviation, and whether it is a solid.
template <typename Make>
BodyOwner* made(const Make& make) {
  OwnedShape* owned = nullptr;
  guarded([&] {
    owned = new OwnedShape(make());
    exchange.numbers[0] = owned->shape.radius(), exchange.numbers[1] = owned->shape.deviation();
    exchange.words[0] = owned->shape.is_solid() ? 1 : 0;
  });
  return owned;
}

}  // namespace

LIMBER_EXPORT(newSphere) BodyOwner* new_sphere(double radius) {
  return made([&] { return Shape::sphere(radius); });
}

LIMBER_EXPORT(newBox) BodyOwner* new_box(double x, double y, double z, double radius) {
  return made([&] { return Shape::box({x, y, z}, radius); });
}

LIMBER_EXPORT(newHalfSpace) BodyOwner* new_half_space(double x, double y, double z, double offset, double half_extent) {
  return made([&] { return Shape::half_space({x, y, z}, offset, half_extent); });
}

// --- points in input(), as float64 unless a function says otherwise ---

LIMBER_EXPORT(newCapsule) BodyOwner* new_capsule(double radius) {
  return made([&] {
    const std::vector<Vec3> ends = points_from(2, false);
    return Shape::capsule(ends[0], ends[1], radius);
  });
}

LIMBER_EXPORT(newCylinder) BodyOwner* new_cylinder(double radius, double max_error) {
  return made([&] {
    const std::vector<Vec3> ends = points_from(2, false);
    return Shape::cylinder(ends[0], ends[1], radius, max_error);
  });
}

LIMBER_EXPORT(newConvexHull) BodyOwner* new_convex_hull(std::size_t count, bool is_float32, double radius) {
  return made([&] { return Shape::convex_hull(points_from(count, is_float32), radius); });
}

LIMBER_EXPORT(newPointCloud) BodyOwner* new_point_cloud(std::size_t count, bool is_float32, double radius) {
  return made([&] { return Shape::point_cloud(points_from(count, is_float32), radius); });
}

/// Heights in input(), row by row, as float64.
LIMBER_EXPORT(newHeightField)
BodyOwner* new_height_field(std::size_t columns, std::size_t rows, double step_x, double step_y, double radius) {
  return made([&] {
    const std::span heights(reinterpret_cast<const double*>(input()), columns * rows);
    return Shape::height_field(heights, columns, rows, step_x, step_y, radius);
  });
}

}  // namespace limber::web

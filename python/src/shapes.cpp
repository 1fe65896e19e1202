// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/shapes.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstddef>
#include <memory>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"

namespace limber::python {
namespace {

using Made = std::unique_ptr<ShapeObject>;

Made made(Shape shape) { return std::make_unique<ShapeObject>(std::move(shape)); }

Made capsule(const ArrayLike& start, const ArrayLike& end, double radius) {
  return made(Shape::capsule(point_from(start, "start"), point_from(end, "end"), radius));
}

Made cylinder(const ArrayLike& start, const ArrayLike& end, double radius, double max_error) {
  return made(Shape::cylinder(point_from(start, "start"), point_from(end, "end"), radius, max_error));
}

Made convex_hull(const ArrayLike& points, double radius) {
  const std::vector<Vec3> corners = points_from(points, "points");
  return without_gil([&] { return made(Shape::convex_hull(corners, radius)); });
}

Made point_cloud(const ArrayLike& points, double radius) {
  const std::vector<Vec3> centers = points_from(points, "points");
  return without_gil([&] { return made(Shape::point_cloud(centers, radius)); });
}

Made height_field(const ArrayLike& heights, double step_x, double step_y, double radius) {
  const Array array(heights, "heights", "shape (rows, columns) and numbers", Lists::floats);
  if (!array.has_numbers({-1, -1})) array.refuse();
  const std::vector<double> numbers = array.numbers();
  return without_gil(
      [&] { return made(Shape::height_field(numbers, array.size(1), array.size(0), step_x, step_y, radius)); });
}

}  // namespace

void bind_bodies(nb::module_& m) {
  nb::class_<ShapeObject, BodyObject>(m, "Shape", docs::Shape)
      .def(  // in place of the one of Body, which makes something else
          "__init__",
          [](nb::handle, const nb::args&, const nb::kwargs&) {
            throw nb::type_error("limber3d.Shape: made by functions such as Shape.sphere()");
          },
          nb::sig("def __init__(self) -> None"), "Raises TypeError.")
      .def_static(
          "sphere", [](double radius) { return made(Shape::sphere(radius)); }, "radius"_a, docs::Shape_sphere)
      .def_static("capsule", &capsule, "start"_a, "end"_a, "radius"_a, docs::Shape_capsule)
      .def_static(
          "box",
          [](const ArrayLike& half_extents, double radius) {
            return made(Shape::box(point_from(half_extents, "half_extents"), radius));
          },
          "half_extents"_a, "radius"_a = 0.0, docs::Shape_box)
      .def_static("cylinder", &cylinder, "start"_a, "end"_a, "radius"_a, "max_error"_a, docs::Shape_cylinder)
      .def_static(
          "half_space",
          [](const ArrayLike& normal, double offset, double half_extent) {
            return made(Shape::half_space(point_from(normal, "normal"), offset, half_extent));
          },
          "normal"_a, "offset"_a, "half_extent"_a, docs::Shape_half_space)
      .def_static("convex_hull", &convex_hull, "points"_a, "radius"_a = 0.0, docs::Shape_convex_hull)
      .def_static(
          "height_field", &height_field, "heights"_a, "step_x"_a, "step_y"_a, "radius"_a = 0.0,
          "A surface over a grid in the x-y plane: heights[row, column] is the height at (column * step_x, row * "
          "step_y). It is\na surface, with nothing below; `radius` makes it thicker.")
      .def_static("point_cloud", &point_cloud, "points"_a, "radius"_a, docs::Shape_point_cloud)
      .def_prop_ro(
          "deviation", [](const ShapeObject& self) { return self.shape.deviation(); }, docs::Shape_deviation);
}

}  // namespace limber::python

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/shapes.h"

#include <nanobind/nanobind.h>
#include <nanobind/stl/unique_ptr.h>

#include <cstddef>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "interrupts.h"
#include "records.h"

namespace limber::python {
namespace {

using Made = std::unique_ptr<ShapeObject>;

Made made(Shape shape) { return std::make_unique<ShapeObject>(std::move(shape)); }

/// The shape, made again for a pickle by the function of that name with these arguments.
template <typename... Arguments>
Made remember(Made made, const char* function, const Arguments&... arguments) {
  made->made_by = nb::make_tuple(function, nb::make_tuple(arguments...));
  return made;
}

nb::object rows_of(const std::vector<Vec3>& points) { return array_of(std::span<const Vec3>(points)); }

Made capsule(const ArrayLike& start, const ArrayLike& end, double radius) {
  const Vec3 from = point_from(start, "start"), to = point_from(end, "end");
  return remember(made(Shape::capsule(from, to, radius)), "capsule", array_of(from), array_of(to), radius);
}

Made cylinder(const ArrayLike& start, const ArrayLike& end, double radius, double max_error) {
  const Vec3 from = point_from(start, "start"), to = point_from(end, "end");
  return remember(made(Shape::cylinder(from, to, radius, max_error)), "cylinder", array_of(from), array_of(to), radius,
                  max_error);
}

Made convex_hull(const ArrayLike& points, double radius) {
  const std::vector<Vec3> corners = points_from(points, "points");
  return remember(aside(corners.size() * 64, [corners, radius] { return made(Shape::convex_hull(corners, radius)); }),
                  "convex_hull", rows_of(corners), radius);
}

Made point_cloud(const ArrayLike& points, double radius) {
  const std::vector<Vec3> centers = points_from(points, "points");
  return remember(aside(centers.size(), [centers, radius] { return made(Shape::point_cloud(centers, radius)); }),
                  "point_cloud", rows_of(centers), radius);
}

Made height_field(const ArrayLike& heights, double step_x, double step_y, double radius) {
  const Array array(heights, "heights", "shape (rows, columns) and numbers", Lists::floats);
  if (!array.has_numbers({-1, -1})) array.refuse();
  const std::vector<double> numbers = array.numbers();
  Made field = aside(numbers.size(), [=, columns = array.size(1), rows = array.size(0)] {
    return made(Shape::height_field(numbers, columns, rows, step_x, step_y, radius));
  });
  const FloatArray copy =
      array_of(std::span<const double>(numbers), nb::str("float64"), {array.size(0), array.size(1)});
  return remember(std::move(field), "height_field", copy, step_x, step_y, radius);
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
          "sphere", [](double radius) { return remember(made(Shape::sphere(radius)), "sphere", radius); }, "radius"_a,
          docs::Shape_sphere)
      .def_static("capsule", &capsule, "start"_a, "end"_a, "radius"_a, docs::Shape_capsule)
      .def_static(
          "box",
          [](const ArrayLike& half_extents, double radius) {
            const Vec3 half = point_from(half_extents, "half_extents");
            return remember(made(Shape::box(half, radius)), "box", array_of(half), radius);
          },
          "half_extents"_a, "radius"_a = 0.0, docs::Shape_box)
      .def_static("cylinder", &cylinder, "start"_a, "end"_a, "radius"_a, "max_error"_a, docs::Shape_cylinder)
      .def_static(
          "half_space",
          [](const ArrayLike& normal, double offset, double half_extent) {
            const Vec3 up = point_from(normal, "normal");
            return remember(made(Shape::half_space(up, offset, half_extent)), "half_space", array_of(up), offset,
                            half_extent);
          },
          "normal"_a, "offset"_a, "half_extent"_a, docs::Shape_half_space)
      .def_static("convex_hull", &convex_hull, "points"_a, "radius"_a = 0.0, docs::Shape_convex_hull)
      .def_static(
          "height_field", &height_field, "heights"_a, "step_x"_a, "step_y"_a, "radius"_a = 0.0,
          "A surface over a grid in the x-y plane: heights[row, column] is the height at (column * step_x, row * "
          "step_y). It is\na surface, with nothing below; `radius` makes it thicker.")
      .def_static("point_cloud", &point_cloud, "points"_a, "radius"_a, docs::Shape_point_cloud)
      .def(
          "__reduce__",
          [](const ShapeObject& self) {
            const nb::object caller = nb::module_::import_("operator").attr("methodcaller");
            return nb::make_tuple(caller(self.made_by[0], *self.made_by[1]), nb::make_tuple(nb::type<ShapeObject>()));
          },
          nb::sig("def __reduce__(self) -> tuple[Any, ...]"))
      .def_prop_ro(
          "deviation", [](const ShapeObject& self) { return self.shape.deviation(); }, docs::Shape_deviation);
}

}  // namespace limber::python

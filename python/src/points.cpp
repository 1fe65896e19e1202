// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <string>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "closed_surface.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

PointResult closest_point_of(ModelObject& model, const ArrayLike& point, const PoseLike& pose, double max_distance) {
  const Reading guard = reading(model);
  const Vec3 p = point_from(point, "point");
  const Placed placed(model.model, pose_from(pose, "pose"));
  return without_gil([&] { return closest_point(placed, p, {max_distance}); });
}

RecordArray closest_points_of(ModelObject& model, const ArrayLike& points, const PoseLike& pose, double max_distance,
                              const BudgetObject* budget) {
  const Reading guard = reading(model);
  const std::vector<Vec3> asked = points_from(points, "points");
  const Placed placed(model.model, pose_from(pose, "pose"));
  const auto ask = [&](auto part, auto results, const QueryBudget&) {
    closest_point_many(placed, part, results, {max_distance});
  };
  return recorded_in_parts<PointResult>(asked, has_bad_point(asked), budget, Spent::leaves_out, dtypes().surface_point,
                                        ask);
}

double winding_number_of(ModelObject& model, const ArrayLike& point, const PoseLike& pose) {
  const Placed placed(model.model, pose_from(pose, "pose"));
  return aside(model.model.mesh().triangles().size(), [placed, p = point_from(point, "point"), use = InUse(model)] {
    return generalized_winding_number(placed, p);
  });
}

constexpr const char* points_budget =
    "Budget   Of the whole call, in time or by its flag. What it leaves out is missing at the end: the answers are "
    "those "
    "of\n         the first points.";

void bind_closed_surface(nb::module_& m) {
  nb::class_<ClosedSurfaceObject>(m, "ClosedSurface", docs::ClosedSurface,
                                  nb::type_slots(collectable<ClosedSurfaceObject>))
      .def(nb::init<nb::handle_t<ModelObject>>(), "model"_a,
           "Raises ValueError, naming an edge, if the surface is not closed and oriented. Of such a surface\n"
           "generalized_winding_number() tells inside from outside. Takes O(n log n).")
      .def_prop_ro("model", &ClosedSurfaceObject::model, "The model.")
      .def(
          "__reduce__",
          [](const ClosedSurfaceObject& self) {
            return nb::make_tuple(nb::type<ClosedSurfaceObject>(), nb::make_tuple(self.model()));
          },
          nb::sig("def __reduce__(self) -> tuple[Any, ...]"))
      .def(
          "solid",
          [](ClosedSurfaceObject& self) -> std::unique_ptr<BodyObject> { return std::make_unique<SolidObject>(self); },
          nb::keep_alive<0, 1>(),
          "The surface with its inside, for queries of two bodies and for scenes: what it encloses collides with "
          "it.\n\nRaises   As all queries of it: ValueError if the model has been reset().")
      .def("contains", &ClosedSurfaceObject::contains, "point"_a, "pose"_a = nb::none(), docs::ClosedSurface_contains)
      .def("contains_many", &ClosedSurfaceObject::contains_many, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
           "budget"_a = nb::none(),
           (std::string("contains() of each of the points, shape (n, 3), on all threads.\n\n") + points_budget).c_str())
      .def("winding_number", &ClosedSurfaceObject::winding_number, "point"_a, "pose"_a = nb::none(),
           docs::ClosedSurface_winding_number)
      .def("signed_distance", &ClosedSurfaceObject::signed_distance, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
           max_distance_argument(), docs::ClosedSurface_signed_distance)
      .def("signed_distance_many", &ClosedSurfaceObject::signed_distance_many, "points"_a, "pose"_a = nb::none(),
           nb::kw_only(), max_distance_argument(), "budget"_a = nb::none(),
           (std::string(R"(signed_distance() of each of the points, on all threads.

Shape    points is (n, 3), of the world.
Returns  An array of n records, limber3d.signed_distance_dtype, with these fields. Distances are negative inside, and
         infinite where nothing is as close as max_distance.
Raises   As signed_distance(); then nothing is returned.
)") + points_budget +
            surface_point_fields() + "\n\nis_inside: " + docs::SignedDistance_is_inside)
               .c_str());
}

}  // namespace

void bind_points(nb::module_& m) {
  m.def("closest_point", &closest_point_of, "model"_a, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
        max_distance_argument(), docs::closest_point);
  m.def("closest_point_many", &closest_points_of, "model"_a, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
        max_distance_argument(), "budget"_a = nb::none(),
        (std::string(R"(closest_point() of each of the points, on all threads.

Shape    points is (n, 3), of the world.
Returns  An array of n records, limber3d.surface_point_dtype, with these fields. The distance is infinite where nothing
         is as close as max_distance.
Raises   As closest_point(); then nothing is returned.
)") + points_budget +
         surface_point_fields())
            .c_str());
  m.def("generalized_winding_number", &winding_number_of, "model"_a, "point"_a, "pose"_a = nb::none(),
        docs::generalized_winding_number);
  bind_closed_surface(m);
}

}  // namespace limber::python

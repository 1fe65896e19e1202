// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
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

RecordArray closest_points_of(ModelObject& model, const ArrayLike& points, const PoseLike& pose, double max_distance) {
  const Reading guard = reading(model);
  const std::vector<Vec3> asked = points_from(points, "points");
  const Placed placed(model.model, pose_from(pose, "pose"));
  std::vector<PointResult> results(asked.size());
  without_gil([&] { closest_points(placed, asked, results, {max_distance}); });
  return recorded(results, dtypes().surface_point);
}

double winding_number_of(ModelObject& model, const ArrayLike& point, const PoseLike& pose) {
  const Reading guard = reading(model);
  const Vec3 p = point_from(point, "point");
  const Placed placed(model.model, pose_from(pose, "pose"));
  return without_gil([&] { return winding_number(placed, p); });
}

/// A closed surface, and the model that it refers to.
class ClosedSurfaceObject {
  static ClosedSurface checked(ModelObject& model) {
    const Reading guard = reading(model);
    return value_or_raise(without_gil([&] { return ClosedSurface::create(model.model); }));
  }

  template <typename Query>
  auto ask(const ArrayLike& point, const PoseLike& pose, const Query& query) {
    const Reading guard = reading(model_);
    const Vec3 p = point_from(point, "point");
    const Transform placed = pose_from(pose, "pose");
    return without_gil([&] { return query(p, placed); });
  }

 public:
  explicit ClosedSurfaceObject(nb::handle_t<ModelObject> model)
      : owner_(nb::borrow(model)), model_(nb::cast<ModelObject&>(model)), surface_(checked(model_)) {}

  Named<"Model"> model() const { return nb::object(owner_); }

  int visit_references(visitproc visit, void* argument) const { return visit(owner_.ptr(), argument); }

  bool contains(const ArrayLike& point, const PoseLike& pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.contains(p, t); });
  }

  std::optional<int> winding_number(const ArrayLike& point, const PoseLike& pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.winding_number(p, t); });
  }

  SignedDistance signed_distance(const ArrayLike& point, const PoseLike& pose, double max_distance) {
    return ask(point, pose,
               [&](const Vec3& p, const Transform& t) { return surface_.signed_distance(p, t, {max_distance}); });
  }

  Named<"NDArray[numpy.bool_]"> contains_many(const ArrayLike& points, const PoseLike& pose) {
    const Reading guard = reading(model_);
    const std::vector<Vec3> asked = points_from(points, "points");
    const Transform placed = pose_from(pose, "pose");
    nb::object answers = new_array(nb::str("bool"), {asked.size()});
    auto* const inside = static_cast<bool*>(memory_of(answers, asked.size()));
    without_gil([&] {
      constexpr std::size_t grain = 16;
      using Range = oneapi::tbb::blocked_range<std::size_t>;
      oneapi::tbb::parallel_for(Range(0, asked.size(), grain), [&](const Range& range) {
        for (std::size_t i = range.begin(); i != range.end(); ++i) inside[i] = surface_.contains(asked[i], placed);
      });
    });
    return answers;
  }

  RecordArray signed_distances(const ArrayLike& points, const PoseLike& pose, double max_distance) {
    const Reading guard = reading(model_);
    const std::vector<Vec3> asked = points_from(points, "points");
    const Transform placed = pose_from(pose, "pose");
    std::vector<SignedDistance> results(asked.size());
    without_gil([&] { surface_.signed_distances(asked, results, placed, {max_distance}); });
    return recorded(results, dtypes().signed_distance);
  }

 private:
  nb::object owner_;
  ModelObject& model_;
  ClosedSurface surface_;
};

void bind_closed_surface(nb::module_& m) {
  nb::class_<ClosedSurfaceObject>(m, "ClosedSurface", docs::ClosedSurface,
                                  nb::type_slots(collectable<ClosedSurfaceObject>))
      .def(nb::init<nb::handle_t<ModelObject>>(), "model"_a,
           "Raises ValueError, naming an edge, if the surface is not closed and oriented. Takes O(n log n).")
      .def_prop_ro("model", &ClosedSurfaceObject::model, "The model.")
      .def("contains", &ClosedSurfaceObject::contains, "point"_a, "pose"_a = nb::none(), docs::ClosedSurface_contains)
      .def("contains_many", &ClosedSurfaceObject::contains_many, "points"_a, "pose"_a = nb::none(),
           "contains() of each of the points, shape (n, 3), on all threads.")
      .def("winding_number", &ClosedSurfaceObject::winding_number, "point"_a, "pose"_a = nb::none(),
           docs::ClosedSurface_winding_number)
      .def("signed_distance", &ClosedSurfaceObject::signed_distance, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
           max_distance_argument(), docs::ClosedSurface_signed_distance)
      .def("signed_distances", &ClosedSurfaceObject::signed_distances, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
           max_distance_argument(),
           (std::string(R"(signed_distance() of each of the points, on all threads.

Shape    points is (n, 3), of the world.
Returns  An array of n records, limber3d.signed_distance_dtype, with these fields. Distances are negative inside, and
         infinite where nothing is as close as max_distance.
Raises   As signed_distance(); then nothing is returned.)") +
            surface_point_fields() + "\n\nis_inside: " + docs::SignedDistance_is_inside)
               .c_str());
}

}  // namespace

void bind_points(nb::module_& m) {
  m.def("closest_point", &closest_point_of, "model"_a, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
        max_distance_argument(), docs::closest_point);
  m.def("closest_points", &closest_points_of, "model"_a, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
        max_distance_argument(),
        (std::string(R"(closest_point() of each of the points, on all threads.

Shape    points is (n, 3), of the world.
Returns  An array of n records, limber3d.surface_point_dtype, with these fields. The distance is infinite where nothing
         is as close as max_distance.
Raises   As closest_point(); then nothing is returned.)") +
         surface_point_fields())
            .c_str());
  m.def("winding_number", &winding_number_of, "model"_a, "point"_a, "pose"_a = nb::none(), docs::winding_number);
  bind_closed_surface(m);
}

}  // namespace limber::python

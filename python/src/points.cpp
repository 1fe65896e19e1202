// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "errors.h"
#include "limber/limber.h"
#include "model_object.h"
#include "poses.h"
#include "query_arguments.h"
#include "records.h"

namespace limber::python {
namespace {

PointResult closest_point_of(ModelObject& model, nb::handle point, nb::handle pose, double max_distance) {
  const Reading guard = reading(model);
  const Vec3 p = point_from(point, "point");
  const Placed placed(model.model, pose_from(pose, "pose"));
  return without_gil([&] { return closest_point(placed, p, {max_distance}); });
}

/// An array of records of results[i].
template <typename Result, typename RecordOf>
nb::object recorded(const std::vector<Result>& results, nb::handle dtype, const RecordOf& record) {
  std::vector<SurfacePointRecord> records(results.size());
  std::transform(results.begin(), results.end(), records.begin(), record);
  return array_of(std::span<const SurfacePointRecord>(records), dtype);
}

nb::object closest_points_of(ModelObject& model, nb::handle points, nb::handle pose, double max_distance) {
  const Reading guard = reading(model);
  const std::vector<Vec3> asked = points_from(points, "points");
  const Placed placed(model.model, pose_from(pose, "pose"));
  std::vector<PointResult> results(asked.size());
  without_gil([&] { closest_points(placed, asked, results, {max_distance}); });
  return recorded(results, dtypes().surface_point, [](const PointResult& r) { return record_of(r.closest); });
}

double winding_number_of(ModelObject& model, nb::handle point, nb::handle pose) {
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
  auto ask(nb::handle point, nb::handle pose, const Query& query) {
    const Reading guard = reading(model_);
    const Vec3 p = point_from(point, "point");
    const Transform placed = pose_from(pose, "pose");
    return without_gil([&] { return query(p, placed); });
  }

 public:
  explicit ClosedSurfaceObject(nb::handle_t<ModelObject> model)
      : owner_(nb::borrow(model)), model_(nb::cast<ModelObject&>(model)), surface_(checked(model_)) {}

  nb::object model() const { return owner_; }

  int visit_references(visitproc visit, void* argument) const { return visit(owner_.ptr(), argument); }

  bool contains(nb::handle point, nb::handle pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.contains(p, t); });
  }

  std::optional<int> winding_number(nb::handle point, nb::handle pose) {
    return ask(point, pose, [&](const Vec3& p, const Transform& t) { return surface_.winding_number(p, t); });
  }

  SignedDistance signed_distance(nb::handle point, nb::handle pose, double max_distance) {
    return ask(point, pose,
               [&](const Vec3& p, const Transform& t) { return surface_.signed_distance(p, t, {max_distance}); });
  }

  nb::object contains_many(nb::handle points, nb::handle pose) {
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

  nb::object signed_distances(nb::handle points, nb::handle pose, double max_distance) {
    const Reading guard = reading(model_);
    const std::vector<Vec3> asked = points_from(points, "points");
    const Transform placed = pose_from(pose, "pose");
    std::vector<SignedDistance> results(asked.size());
    without_gil([&] { surface_.signed_distances(asked, results, placed, {max_distance}); });
    return recorded(results, dtypes().signed_distance, [](const SignedDistance& s) { return record_of(s); });
  }

 private:
  nb::object owner_;
  ModelObject& model_;
  ClosedSurface surface_;
};

void bind_closed_surface(nb::module_& m, double unlimited) {
  nb::class_<ClosedSurfaceObject>(m, "ClosedSurface", docs::ClosedSurface,
                                  nb::type_slots(collectable<ClosedSurfaceObject>))
      .def(nb::init<nb::handle_t<ModelObject>>(), "model"_a, nb::sig("def __init__(self, model: Model) -> None"),
           "Raises ValueError, naming an edge, if the surface is not closed and oriented. Takes O(n log n).")
      .def_prop_ro("model", &ClosedSurfaceObject::model, nb::sig("def model(self) -> Model"), "The model.")
      .def("contains", &ClosedSurfaceObject::contains, "point"_a, "pose"_a = nb::none(),
           nb::sig("def contains(self, point: ArrayLike, pose: PoseLike = None) -> bool"), docs::ClosedSurface_contains)
      .def("contains_many", &ClosedSurfaceObject::contains_many, "points"_a, "pose"_a = nb::none(),
           nb::sig("def contains_many(self, points: ArrayLike, pose: PoseLike = None) -> NDArray[numpy.bool_]"),
           "contains() of each of the points, shape (n, 3), on all threads.")
      .def("winding_number", &ClosedSurfaceObject::winding_number, "point"_a, "pose"_a = nb::none(),
           nb::sig("def winding_number(self, point: ArrayLike, pose: PoseLike = None) -> int | None"),
           docs::ClosedSurface_winding_number)
      .def("signed_distance", &ClosedSurfaceObject::signed_distance, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
           "max_distance"_a = unlimited,
           nb::sig("def signed_distance(self, point: ArrayLike, pose: PoseLike = None, *, "
                   "max_distance: float = float('inf')) -> SignedDistance"),
           docs::ClosedSurface_signed_distance)
      .def("signed_distances", &ClosedSurfaceObject::signed_distances, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
           "max_distance"_a = unlimited,
           nb::sig("def signed_distances(self, points: ArrayLike, pose: PoseLike = None, *, "
                   "max_distance: float = float('inf')) -> RecordArray"),
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
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  m.def("closest_point", &closest_point_of, "model"_a, "point"_a, "pose"_a = nb::none(), nb::kw_only(),
        "max_distance"_a = unlimited,
        nb::sig("def closest_point(model: Model, point: ArrayLike, pose: PoseLike = None, *, "
                "max_distance: float = float('inf')) -> PointResult"),
        docs::closest_point);
  m.def("closest_points", &closest_points_of, "model"_a, "points"_a, "pose"_a = nb::none(), nb::kw_only(),
        "max_distance"_a = unlimited,
        nb::sig("def closest_points(model: Model, points: ArrayLike, pose: PoseLike = None, *, "
                "max_distance: float = float('inf')) -> RecordArray"),
        (std::string(R"(closest_point() of each of the points, on all threads.

Shape    points is (n, 3), of the world.
Returns  An array of n records, limber3d.surface_point_dtype, with these fields. The distance is infinite where nothing
         is as close as max_distance.
Raises   As closest_point(); then nothing is returned.)") +
         surface_point_fields())
            .c_str());
  m.def("winding_number", &winding_number_of, "model"_a, "point"_a, "pose"_a = nb::none(),
        nb::sig("def winding_number(model: Model, point: ArrayLike, pose: PoseLike = None) -> float"),
        docs::winding_number);
  bind_closed_surface(m, unlimited);
}

}  // namespace limber::python

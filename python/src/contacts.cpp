// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "found_pairs.h"
#include "limber/limber.h"
#include "model_object.h"
#include "query_arguments.h"
#include "records.h"

namespace limber::python {
namespace {

PairOptions with_faces(PairOptions options, std::optional<OrientedFaces> oriented_faces) {
  options.oriented_faces = oriented_faces;
  return options;
}

nb::object intersections_of(ModelObject& a, ModelObject& b, nb::handle pose_a, nb::handle pose_b, nb::handle filter,
                            std::optional<std::size_t> max_count) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_pairs(filter, max_count, [&](auto visit, const PairOptions& options) {
    visit_intersections(pair.a(), pair.b(), visit, options);
  });
}

nb::object contacts_of(ModelObject& a, ModelObject& b, double margin, nb::handle pose_a, nb::handle pose_b,
                       nb::handle filter, std::optional<std::size_t> max_count,
                       std::optional<OrientedFaces> oriented_faces) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_contacts(filter, max_count, [&](auto visit, const PairOptions& options) {
    visit_contacts(pair.a(), pair.b(), margin, visit, with_faces(options, oriented_faces));
  });
}

/// As many pairs as there can be: room for more is not needed.
std::size_t most_pairs(const ModelObject& a, const ModelObject& b) {
  return a.model.mesh().triangles().size() * b.model.mesh().triangles().size();
}

nb::object closest_pairs_of(ModelObject& a, ModelObject& b, std::size_t count, nb::handle pose_a, nb::handle pose_b,
                            nb::handle filter, std::optional<OrientedFaces> oriented_faces) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_closest(filter, std::min(count, most_pairs(a, b)),
                       [&](std::span<Contact> room, const PairOptions& options) {
                         return closest_pairs(pair.a(), pair.b(), room, with_faces(options, oriented_faces));
                       });
}

/// The kept contacts and their patches.
nb::tuple reduce(nb::object contacts, double radius, double max_angle, std::size_t max_points) {
  const nb::module_ numpy = nb::module_::import_("numpy");
  const nb::object given = numpy.attr("asarray")(contacts);
  // Arrays that NumPy has put together have the fields, at other places.
  const bool has_fields = given.attr("dtype").attr("names").equal(dtypes().contact.attr("names"));
  if (!has_fields || nb::cast<std::size_t>(given.attr("ndim")) != 1) {
    const nb::object text =
        nb::str("contacts: expected shape (n,) and the fields of contact_dtype; got shape {} and fields {}")
            .format(given.attr("shape"), given.attr("dtype").attr("names"));
    throw nb::value_error(nb::cast<std::string>(text).c_str());
  }
  const nb::object packed = numpy.attr("array")(given, dtypes().contact);
  const auto count = nb::cast<std::size_t>(packed.attr("size"));
  // The copy is this call's own.
  const std::span<Contact> all(static_cast<Contact*>(memory_of(packed, count * sizeof(Contact))), count);
  std::vector<std::uint32_t> patches(count);
  const ReductionOptions options{.radius = radius, .max_angle = max_angle, .max_points = max_points};
  const std::size_t kept = without_gil([&] { return reduce_contacts(all, options, patches); });
  return nb::make_tuple(array_of(std::span<const Contact>(all).first(kept), dtypes().contact),
                        array_of(std::span<const std::uint32_t>(patches).first(kept)));
}

// --- one model with itself ---

CollideResult self_collide_of(ModelObject& model, nb::handle filter, CacheObject* cache) {
  const Reading reading_model = reading(model);
  const TriangleFilter which(filter);
  const Used used(cache);
  return without_gil_unless(which.needs_gil(), [&] { return self_collide(model.model, {which.get(), used.get()}); });
}

DistanceResult self_distance_of(ModelObject& model, double relative_error, double absolute_error, double max_distance,
                                nb::handle filter, CacheObject* cache) {
  const Reading reading_model = reading(model);
  const TriangleFilter which(filter);
  const Used used(cache);
  const SelfDistanceOptions options{relative_error, absolute_error, max_distance, which.get(), used.get()};
  return without_gil_unless(which.needs_gil(), [&] { return self_distance(model.model, options); });
}

nb::object self_intersections_of(ModelObject& model, nb::handle filter, std::optional<std::size_t> max_count) {
  const Reading guard = reading(model);
  return found_pairs(filter, max_count, [&](auto visit, const PairOptions& options) {
    visit_self_intersections(model.model, visit, options);
  });
}

nb::object self_contacts_of(ModelObject& model, double margin, nb::handle filter, std::optional<std::size_t> max_count,
                            std::optional<OrientedFaces> oriented_faces) {
  const Reading guard = reading(model);
  return found_contacts(filter, max_count, [&](auto visit, const PairOptions& options) {
    visit_self_contacts(model.model, margin, visit, with_faces(options, oriented_faces));
  });
}

nb::object self_closest_pairs_of(ModelObject& model, std::size_t count, nb::handle filter,
                                 std::optional<OrientedFaces> oriented_faces) {
  const Reading guard = reading(model);
  return found_closest(filter, std::min(count, most_pairs(model, model)),
                       [&](std::span<Contact> room, const PairOptions& options) {
                         return self_closest_pairs(model.model, room, with_faces(options, oriented_faces));
                       });
}

constexpr const char* filter_note = R"(

Filter   None, a NeighborRings, or a function of two triangle ids: pairs for which it is false do not count. With a
         function the query holds the GIL.
Ctrl-C   Ends the search with KeyboardInterrupt.)";

const std::string faces_note = std::string("\nFaces    oriented_faces: ") + docs::PairOptions_oriented_faces;

std::string pairs_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  Ids of triangles, one pair a row: shape (k, 2), uint32.)";
}

std::string contacts_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + faces_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  An array of k contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

std::string closest_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + faces_note + R"(
Returns  An array of at most `count` contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

}  // namespace

void bind_contacts(nb::module_& m) {
  m.def("intersections", &intersections_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(),
        nb::sig("def intersections(a: Model, b: Model, pose_a: PoseLike = None, pose_b: PoseLike = None, *, "
                "filter: TriangleFilter = None, max_count: int | None = None) -> IdArray"),
        pairs_documentation(docs::visit_intersections).c_str());
  m.def("contacts", &contacts_of, "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(),
        nb::sig("def contacts(a: Model, b: Model, margin: float, pose_a: PoseLike = None, pose_b: PoseLike = None, *, "
                "filter: TriangleFilter = None, max_count: int | None = None, oriented_faces: OrientedFaces | None = "
                "None) -> RecordArray"),
        contacts_documentation(docs::visit_contacts).c_str());
  m.def("closest_pairs", &closest_pairs_of, "a"_a, "b"_a, "count"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "oriented_faces"_a = nb::none(),
        nb::sig("def closest_pairs(a: Model, b: Model, count: int, pose_a: PoseLike = None, pose_b: PoseLike = None, "
                "*, filter: TriangleFilter = None, oriented_faces: OrientedFaces | None = None) -> RecordArray"),
        closest_documentation(docs::closest_pairs).c_str());
  m.def("reduce_contacts", &reduce, "contacts"_a, nb::kw_only(), "radius"_a, "max_angle"_a = 0.5, "max_points"_a = 4,
        nb::sig("def reduce_contacts(contacts: RecordArray, *, radius: float, max_angle: float = 0.5, "
                "max_points: int = 4) -> tuple[RecordArray, IdArray]"),
        (std::string(docs::reduce_contacts) +
         "\n\nReturns  The kept contacts, and the patch of each; the argument is left alone.\n\nradius: " +
         docs::ReductionOptions_radius + "\n\nmax_angle: " + docs::ReductionOptions_max_angle +
         "\n\nmax_points: " + docs::ReductionOptions_max_points)
            .c_str());
}

void bind_self_queries(nb::module_& m) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  m.def("self_collide", &self_collide_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        nb::sig("def self_collide(model: Model, *, filter: TriangleFilter = None, cache: QueryCache | None = None) "
                "-> CollideResult"),
        docs::self_collide);
  m.def("self_distance", &self_distance_of, "model"_a, nb::kw_only(), "relative_error"_a = 0.0,
        "absolute_error"_a = 0.0, "max_distance"_a = unlimited, "filter"_a = nb::none(), "cache"_a = nb::none(),
        nb::sig("def self_distance(model: Model, *, relative_error: float = 0.0, absolute_error: float = 0.0, "
                "max_distance: float = float('inf'), filter: TriangleFilter = None, cache: QueryCache | None = None) "
                "-> DistanceResult"),
        docs::self_distance);
  m.def("self_intersections", &self_intersections_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(),
        nb::sig("def self_intersections(model: Model, *, filter: TriangleFilter = None, "
                "max_count: int | None = None) -> IdArray"),
        pairs_documentation(docs::visit_self_intersections).c_str());
  m.def("self_contacts", &self_contacts_of, "model"_a, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(),
        nb::sig("def self_contacts(model: Model, margin: float, *, filter: TriangleFilter = None, "
                "max_count: int | None = None, oriented_faces: OrientedFaces | None = None) -> RecordArray"),
        contacts_documentation(docs::visit_self_contacts).c_str());
  m.def("self_closest_pairs", &self_closest_pairs_of, "model"_a, "count"_a, nb::kw_only(), "filter"_a = nb::none(),
        "oriented_faces"_a = nb::none(),
        nb::sig("def self_closest_pairs(model: Model, count: int, *, filter: TriangleFilter = None, oriented_faces: "
                "OrientedFaces | None = None) -> RecordArray"),
        closest_documentation(docs::self_closest_pairs).c_str());
}

}  // namespace limber::python

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

using TriangleFilter = Named<"TriangleFilter">;
using Filter = PairFilter<TrianglePairFilter>;

/// The thread that runs handlers of signals, and that does not outlive Python.
unsigned long main_thread = 0;

/// Raises what the handler of a signal raises, such as KeyboardInterrupt. Does nothing except in the main thread.
void look_for_signals() {
  if (PyThread_get_thread_ident() != main_thread) return;
  const nb::gil_scoped_acquire acquired;
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

/// The pairs that search(visitor, options) visits, at most max_count of them. Ctrl-C ends the search. With a filter in
/// Python it stays on one thread, as this one holds the GIL.
template <typename Pair, typename Search>
std::vector<Pair> collected(nb::handle filter, std::optional<OrientedFaces> oriented_faces,
                            std::optional<std::size_t> max_count, bool is_parallel, const Search& search) {
  std::vector<Pair> found;
  if (max_count == 0) return found;
  const Filter which(filter);
  without_gil_unless(which.needs_gil(), [&] {
    search(
        [&](const Pair& pair) {
          found.push_back(pair);
          constexpr std::size_t pairs_between_looks = 1 << 16;  // some ten milliseconds
          if (found.size() % pairs_between_looks == 0) look_for_signals();
          return found.size() != max_count;
        },
        PairOptions{
            .filter = which.get(), .oriented_faces = oriented_faces, .is_parallel = is_parallel && !which.needs_gil()});
  });
  return found;
}

template <typename Search>
IdArray found_pairs(nb::handle filter, std::optional<std::size_t> max_count, bool is_parallel, const Search& search) {
  const std::vector<TrianglePair> found = collected<TrianglePair>(filter, std::nullopt, max_count, is_parallel, search);
  return array_of(std::span<const TrianglePair>(found), nb::str("uint32"), {found.size(), 2});
}

template <typename Search>
RecordArray found_contacts(nb::handle filter, std::optional<OrientedFaces> oriented_faces,
                           std::optional<std::size_t> max_count, bool is_parallel, const Search& search) {
  const std::vector<Contact> found = collected<Contact>(filter, oriented_faces, max_count, is_parallel, search);
  return array_of(std::span<const Contact>(found), dtypes().contact);
}

/// The contacts that search(room, options) writes, for room of that many.
template <typename Search>
RecordArray found_closest(nb::handle filter, double max_distance, std::optional<OrientedFaces> oriented_faces,
                          std::size_t room, const Search& search) {
  const Filter which(filter);
  std::vector<Contact> found(room);
  const ClosestPairsOptions options{
      .max_distance = max_distance, .filter = which.get(), .oriented_faces = oriented_faces};
  const PairCount count = without_gil_unless(which.needs_gil(), [&] { return search(found, options); });
  return array_of(std::span<const Contact>(found).first(count.count), dtypes().contact);
}

IdArray intersections_of(BodyObject& a, BodyObject& b, const PoseLike& pose_a, const PoseLike& pose_b,
                         const TriangleFilter& filter, std::optional<std::size_t> max_count, bool is_parallel) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_pairs(filter, max_count, is_parallel, [&](auto visit, const PairOptions& options) {
    visit_intersections(pair.a(), pair.b(), visit, options);
  });
}

RecordArray contacts_of(BodyObject& a, BodyObject& b, double margin, const PoseLike& pose_a, const PoseLike& pose_b,
                        const TriangleFilter& filter, std::optional<std::size_t> max_count,
                        std::optional<OrientedFaces> oriented_faces, bool is_parallel) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_contacts(filter, oriented_faces, max_count, is_parallel, [&](auto visit, const PairOptions& options) {
    visit_contacts(pair.a(), pair.b(), margin, visit, options);
  });
}

/// As many pairs as there can be: room for more is not needed.
std::size_t most_pairs(const BodyObject& a, const BodyObject& b) {
  return a.body().model().mesh().triangles().size() * b.body().model().mesh().triangles().size();
}

RecordArray closest_pairs_of(BodyObject& a, BodyObject& b, std::size_t count, const PoseLike& pose_a,
                             const PoseLike& pose_b, double max_distance, const TriangleFilter& filter,
                             std::optional<OrientedFaces> oriented_faces) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(a, b)),
                       [&](std::span<Contact> room, const ClosestPairsOptions& options) {
                         return closest_pairs(pair.a(), pair.b(), room, options);
                       });
}

/// The kept contacts and their patches.
std::pair<RecordArray, IdArray> reduce(const RecordArray& contacts, double radius, double max_angle,
                                       std::size_t max_points) {
  const GivenContacts given = contacts_from(contacts, 1);
  const std::span<Contact> all = given.contacts;
  std::vector<std::uint32_t> patches(all.size());
  const ReductionOptions options{.radius = radius, .max_angle = max_angle, .max_points = max_points};
  const std::size_t kept = without_gil([&] { return reduce_contacts(all, options, patches); });
  return {array_of(std::span<const Contact>(all).first(kept), dtypes().contact),
          array_of(std::span<const std::uint32_t>(patches).first(kept))};
}

// --- one model with itself ---

CollideResult self_collide_of(ModelObject& model, const TriangleFilter& filter, QueryCacheObject* cache) {
  const Reading reading_model = reading(model);
  const Filter which(filter);
  const Used used(cache);
  return without_gil_unless(which.needs_gil(), [&] { return self_collide(model.model, {which.get(), used.get()}); });
}

DistanceResult self_distance_of(ModelObject& model, double relative_error, double absolute_error, double max_distance,
                                const TriangleFilter& filter, QueryCacheObject* cache) {
  const Reading reading_model = reading(model);
  const Filter which(filter);
  const Used used(cache);
  const SelfDistanceOptions options{relative_error, absolute_error, max_distance, which.get(), used.get()};
  return without_gil_unless(which.needs_gil(), [&] { return self_distance(model.model, options); });
}

IdArray self_intersections_of(ModelObject& model, const TriangleFilter& filter, std::optional<std::size_t> max_count,
                              bool is_parallel) {
  const Reading guard = reading(model);
  return found_pairs(filter, max_count, is_parallel, [&](auto visit, const PairOptions& options) {
    visit_self_intersections(model.model, visit, options);
  });
}

RecordArray self_contacts_of(ModelObject& model, double margin, const TriangleFilter& filter,
                             std::optional<std::size_t> max_count, std::optional<OrientedFaces> oriented_faces,
                             bool is_parallel) {
  const Reading guard = reading(model);
  return found_contacts(filter, oriented_faces, max_count, is_parallel, [&](auto visit, const PairOptions& options) {
    visit_self_contacts(model.model, margin, visit, options);
  });
}

RecordArray self_closest_pairs_of(ModelObject& model, std::size_t count, double max_distance,
                                  const TriangleFilter& filter, std::optional<OrientedFaces> oriented_faces) {
  const Reading guard = reading(model);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(model, model)),
                       [&](std::span<Contact> room, const ClosestPairsOptions& options) {
                         return self_closest_pairs(model.model, room, options);
                       });
}

constexpr const char* filter_note = R"(

Filter   None, a NeighborRings, or a function of two triangle ids: pairs for which it is false do not count. With a
         function the query holds the GIL.
Ctrl-C   Ends the search with KeyboardInterrupt.)";

const std::string faces_note = std::string("\nFaces    oriented_faces: ") + docs::PairOptions_oriented_faces;

constexpr const char* parallel_note = R"(
Parallel With is_parallel the search is on all threads: for large models with many pairs. Pairs and their order stay the
         same. All are found before max_count counts. With a function as the filter it stays on one thread.)";

std::string pairs_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  Ids of triangles, one pair a row: shape (k, 2), uint32.)";
}

std::string contacts_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + faces_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  An array of k contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

std::string closest_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + faces_note + R"(
Returns  An array of at most `count` contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

void bind_self_queries(nb::module_& m) {
  m.def("self_collide", &self_collide_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        docs::self_collide);
  m.def("self_distance", &self_distance_of, "model"_a, nb::kw_only(), "relative_error"_a = 0.0,
        "absolute_error"_a = 0.0, max_distance_argument(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        docs::self_distance);
  m.def("self_intersections", &self_intersections_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(), "is_parallel"_a = false,
        pairs_documentation(docs::visit_self_intersections).c_str());
  m.def("self_contacts", &self_contacts_of, "model"_a, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(), "is_parallel"_a = false,
        contacts_documentation(docs::visit_self_contacts).c_str());
  m.def("self_closest_pairs", &self_closest_pairs_of, "model"_a, "count"_a, nb::kw_only(), max_distance_argument(),
        "filter"_a = nb::none(), "oriented_faces"_a = nb::none(),
        closest_documentation(docs::self_closest_pairs).c_str());
}

}  // namespace

void bind_contacts(nb::module_& m) {
  main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  m.def("intersections", &intersections_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(), "is_parallel"_a = false,
        pairs_documentation(docs::visit_intersections).c_str());
  m.def("contacts", &contacts_of, "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(),
        "is_parallel"_a = false, contacts_documentation(docs::visit_contacts).c_str());
  m.def("closest_pairs", &closest_pairs_of, "a"_a, "b"_a, "count"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), max_distance_argument(), "filter"_a = nb::none(), "oriented_faces"_a = nb::none(),
        closest_documentation(docs::closest_pairs).c_str());
  m.def("reduce_contacts", &reduce, "contacts"_a, nb::kw_only(), "radius"_a, "max_angle"_a = 0.5, "max_points"_a = 4,
        (std::string(docs::reduce_contacts) +
         "\n\nReturns  The kept contacts, and the patch of each; the argument is left alone.\n\nradius: " +
         docs::ReductionOptions_radius + "\n\nmax_angle: " + docs::ReductionOptions_max_angle +
         "\n\nmax_points: " + docs::ReductionOptions_max_points)
            .c_str());
  bind_self_queries(m);
}

}  // namespace limber::python

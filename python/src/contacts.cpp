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
#include <type_traits>
#include <utility>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "budget.h"
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

/// What a query gives: an array; with a budget also which limit has ended it. The type of the budget tells which.
template <typename Array, typename Budget>
using Found = std::conditional_t<std::is_null_pointer_v<Budget>, Array, std::pair<Array, StoppedBy>>;

template <typename Array, typename Budget>
Found<Array, Budget> found(Array array, Budget, StoppedBy stopped_by) {
  if constexpr (std::is_null_pointer_v<Budget>) {
    return array;
  } else {
    return {std::move(array), stopped_by};
  }
}

/// How pairs are looked for.
struct Wanted {
  std::optional<OrientedFaces> oriented_faces;
  std::optional<std::size_t> max_count;
  bool is_parallel;
};

/// Keeps the pairs that search(visitor, options) visits, at most max_count of them; returns what has ended the search.
/// Ctrl-C ends it. With a filter in Python it stays on one thread, as this one holds the GIL.
template <typename Pair, typename Search>
StoppedBy collect(std::vector<Pair>& pairs, nb::handle filter, const Wanted& wanted, const BudgetObject* budget,
                  const Search& search) {
  if (wanted.max_count == 0) return StoppedBy::nothing;
  const Filter which(filter);
  const auto keep = [&](const Pair& pair) {
    pairs.push_back(pair);
    constexpr std::size_t pairs_between_looks = 1 << 16;  // some ten milliseconds
    if (pairs.size() % pairs_between_looks == 0) look_for_signals();
    return pairs.size() != wanted.max_count;
  };
  const PairOptions options{.filter = which.get(),
                            .oriented_faces = wanted.oriented_faces,
                            .budget = budget_of(budget),
                            .is_parallel = wanted.is_parallel && !which.needs_gil()};
  return without_gil_unless(which.needs_gil(), [&] { return search(keep, options); }).stopped_by;
}

template <typename Budget, typename Search>
Found<IdArray, Budget> found_pairs(nb::handle filter, const Wanted& wanted, Budget budget, const Search& search) {
  std::vector<TrianglePair> pairs;
  const StoppedBy stopped_by = collect(pairs, filter, wanted, budget, search);
  return found<IdArray>(array_of(std::span<const TrianglePair>(pairs), nb::str("uint32"), {pairs.size(), 2}), budget,
                        stopped_by);
}

template <typename Budget, typename Search>
Found<RecordArray, Budget> found_contacts(nb::handle filter, const Wanted& wanted, Budget budget,
                                          const Search& search) {
  std::vector<Contact> contacts;
  const StoppedBy stopped_by = collect(contacts, filter, wanted, budget, search);
  return found(array_of(std::span<const Contact>(contacts), dtypes().contact), budget, stopped_by);
}

/// The contacts that search(room, options) writes, for room of that many.
template <typename Budget, typename Search>
Found<RecordArray, Budget> found_closest(nb::handle filter, double max_distance,
                                         std::optional<OrientedFaces> oriented_faces, std::size_t room, Budget budget,
                                         const Search& search) {
  const Filter which(filter);
  std::vector<Contact> contacts(room);
  const ClosestPairsOptions options{.max_distance = max_distance,
                                    .filter = which.get(),
                                    .oriented_faces = oriented_faces,
                                    .budget = budget_of(budget)};
  const PairCount count = without_gil_unless(which.needs_gil(), [&] { return search(contacts, options); });
  return found(array_of(std::span<const Contact>(contacts).first(count.count), dtypes().contact), budget,
               count.stopped_by);
}

template <typename Budget>
Found<IdArray, Budget> intersections_of(BodyObject& a, BodyObject& b, const PoseLike& pose_a, const PoseLike& pose_b,
                                        const TriangleFilter& filter, std::optional<std::size_t> max_count,
                                        bool is_parallel, Budget budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_pairs(
      filter, {std::nullopt, max_count, is_parallel}, budget,
      [&](auto visit, const PairOptions& options) { return visit_intersections(pair.a(), pair.b(), visit, options); });
}

template <typename Budget>
Found<RecordArray, Budget> contacts_of(BodyObject& a, BodyObject& b, double margin, const PoseLike& pose_a,
                                       const PoseLike& pose_b, const TriangleFilter& filter,
                                       std::optional<std::size_t> max_count,
                                       std::optional<OrientedFaces> oriented_faces, bool is_parallel, Budget budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_contacts(filter, {oriented_faces, max_count, is_parallel}, budget,
                        [&](auto visit, const PairOptions& options) {
                          return visit_contacts(pair.a(), pair.b(), margin, visit, options);
                        });
}

/// As many pairs as there can be: room for more is not needed.
std::size_t most_pairs(const BodyObject& a, const BodyObject& b) {
  return a.body().model().mesh().triangles().size() * b.body().model().mesh().triangles().size();
}

template <typename Budget>
Found<RecordArray, Budget> closest_pairs_of(BodyObject& a, BodyObject& b, std::size_t count, const PoseLike& pose_a,
                                            const PoseLike& pose_b, double max_distance, const TriangleFilter& filter,
                                            std::optional<OrientedFaces> oriented_faces, Budget budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(a, b)), budget,
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
  const ReductionOptions options{.max_angle = max_angle, .max_points = max_points, .patch_ids = patches};
  const std::size_t kept = without_gil([&] { return reduce_contacts(all, radius, options); });
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

template <typename Budget>
Found<IdArray, Budget> self_intersections_of(ModelObject& model, const TriangleFilter& filter,
                                             std::optional<std::size_t> max_count, bool is_parallel, Budget budget) {
  const Reading guard = reading(model);
  return found_pairs(
      filter, {std::nullopt, max_count, is_parallel}, budget,
      [&](auto visit, const PairOptions& options) { return visit_self_intersections(model.model, visit, options); });
}

template <typename Budget>
Found<RecordArray, Budget> self_contacts_of(ModelObject& model, double margin, const TriangleFilter& filter,
                                            std::optional<std::size_t> max_count,
                                            std::optional<OrientedFaces> oriented_faces, bool is_parallel,
                                            Budget budget) {
  const Reading guard = reading(model);
  return found_contacts(
      filter, {oriented_faces, max_count, is_parallel}, budget,
      [&](auto visit, const PairOptions& options) { return visit_self_contacts(model.model, margin, visit, options); });
}

template <typename Budget>
Found<RecordArray, Budget> self_closest_pairs_of(ModelObject& model, std::size_t count, double max_distance,
                                                 const TriangleFilter& filter,
                                                 std::optional<OrientedFaces> oriented_faces, Budget budget) {
  const Reading guard = reading(model);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(model, model)), budget,
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
         same. All are found before max_count counts. With a function as the filter, or a budget, it stays on one
         thread.)";

constexpr const char* budget_note = R"(
Budget   With a QueryBudget the answer is a tuple: the array, and the StoppedBy that has ended the search. If that is
         not `nothing`, the array has some of all pairs, each right, none twice; of closest pairs the closest of those
         that were compared. The next call starts anew.)";

std::string pairs_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + budget_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  Ids of triangles, one pair a row: shape (k, 2), uint32.)";
}

std::string contacts_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + budget_note + faces_note + R"(
Limit    The search ends where max_count pairs have been found.
Returns  An array of k contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

std::string closest_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + budget_note + faces_note + R"(
Returns  An array of at most `count` contacts, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

/// Binds a query without a budget, and with one.
template <typename Plain, typename Limited, typename... Arguments>
void bind_query(nb::module_& m, const char* name, Plain plain, Limited limited, const std::string& documentation,
                const Arguments&... arguments) {
  m.def(name, plain, arguments..., "budget"_a = nb::none(), documentation.c_str());
  m.def(name, limited, arguments..., "budget"_a, documentation.c_str());
}
using NoBudget = std::nullptr_t;
using WithBudget = const BudgetObject*;

void bind_self_queries(nb::module_& m) {
  m.def("self_collide", &self_collide_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        docs::self_collide);
  m.def("self_distance", &self_distance_of, "model"_a, nb::kw_only(), "relative_error"_a = 0.0,
        "absolute_error"_a = 0.0, max_distance_argument(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        docs::self_distance);
  bind_query(m, "self_intersections", &self_intersections_of<NoBudget>, &self_intersections_of<WithBudget>,
             pairs_documentation(docs::visit_self_intersections), "model"_a, nb::kw_only(), "filter"_a = nb::none(),
             "max_count"_a = nb::none(), "is_parallel"_a = false);
  bind_query(m, "self_contacts", &self_contacts_of<NoBudget>, &self_contacts_of<WithBudget>,
             contacts_documentation(docs::visit_self_contacts), "model"_a, "margin"_a, nb::kw_only(),
             "filter"_a = nb::none(), "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(),
             "is_parallel"_a = false);
  bind_query(m, "self_closest_pairs", &self_closest_pairs_of<NoBudget>, &self_closest_pairs_of<WithBudget>,
             closest_documentation(docs::self_closest_pairs), "model"_a, "count"_a, nb::kw_only(),
             max_distance_argument(), "filter"_a = nb::none(), "oriented_faces"_a = nb::none());
}

}  // namespace

void bind_contacts(nb::module_& m) {
  main_thread = nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  bind_query(m, "intersections", &intersections_of<NoBudget>, &intersections_of<WithBudget>,
             pairs_documentation(docs::visit_intersections), "a"_a, "b"_a, "pose_a"_a = nb::none(),
             "pose_b"_a = nb::none(), nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(),
             "is_parallel"_a = false);
  bind_query(m, "contacts", &contacts_of<NoBudget>, &contacts_of<WithBudget>,
             contacts_documentation(docs::visit_contacts), "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(),
             "pose_b"_a = nb::none(), nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(),
             "oriented_faces"_a = nb::none(), "is_parallel"_a = false);
  bind_query(m, "closest_pairs", &closest_pairs_of<NoBudget>, &closest_pairs_of<WithBudget>,
             closest_documentation(docs::closest_pairs), "a"_a, "b"_a, "count"_a, "pose_a"_a = nb::none(),
             "pose_b"_a = nb::none(), nb::kw_only(), max_distance_argument(), "filter"_a = nb::none(),
             "oriented_faces"_a = nb::none());
  m.def("reduce_contacts", &reduce, "contacts"_a, "radius"_a, nb::kw_only(), "max_angle"_a = 0.5, "max_points"_a = 4,
        (std::string(docs::reduce_contacts) +
         "\n\nReturns  The kept contacts, and the patch of each; the argument is left alone.\n\nmax_angle: " +
         docs::ReductionOptions_max_angle + "\n\nmax_points: " + docs::ReductionOptions_max_points)
            .c_str());
  bind_self_queries(m);
}

}  // namespace limber::python

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <cstddef>
#include <deque>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "budget.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

using TriangleFilter = Named<"TriangleFilter">;
using Filter = PairFilter<TrianglePairFilter>;

using TrianglePairs = Named<"TrianglePairs">;
using Contacts = Named<"Contacts">;
using ReducedContacts = Named<"ReducedContacts">;

/// How pairs are looked for.
struct Wanted {
  std::optional<OrientedFaces> oriented_faces;
  std::optional<std::size_t> max_count;
  bool parallel;
};

/// Keeps the pairs that search(visitor, options) visits, at most max_count of them; returns what the search did. Ctrl-C
/// ends it. With a filter in Python it stays on one thread, as this one holds the GIL.
template <typename Pair, typename Search>
PairCount collect(std::deque<Pair>& pairs, nb::handle filter, const Wanted& wanted, const BudgetObject* budget,
                  const Search& search) {
  if (wanted.max_count == 0) return {.is_complete = false};
  const Filter which(filter);
  PairOptions options{.filter = which.get(),
                      .oriented_faces = wanted.oriented_faces,
                      .budget = {},
                      .parallel = wanted.parallel && !which.needs_gil()};
  const auto find = [&](const QueryBudget& limits) {
    const auto keep = [&](const Pair& pair) {
      pairs.push_back(pair);
      return pairs.size() != wanted.max_count && !*limits.abandon;
    };
    pairs.clear(), options.budget = limits;
    return search(keep, options);
  };
  return interruptible(budget, find, which.needs_gil());
}

template <typename Search>
TrianglePairs found_pairs(nb::handle filter, const Wanted& wanted, const BudgetObject* budget, const Search& search) {
  std::deque<TrianglePair> pairs;
  const PairCount count = collect(pairs, filter, wanted, budget, search);
  return found("TrianglePairs", array_of(pairs, nb::str("uint32"), {pairs.size(), 2}), count);
}

template <typename Search>
Contacts found_contacts(nb::handle filter, const Wanted& wanted, const BudgetObject* budget, const Search& search) {
  std::deque<Contact> contacts;
  const PairCount count = collect(contacts, filter, wanted, budget, search);
  return found("Contacts", array_of(contacts, dtypes().contact), count);
}

/// The contacts that search(room, options) writes, for room of that many.
template <typename Search>
Contacts found_closest(nb::handle filter, double max_distance, std::optional<OrientedFaces> oriented_faces,
                       std::size_t room, const BudgetObject* budget, const Search& search) {
  const Filter which(filter);
  std::vector<Contact> contacts;
  contacts.reserve(room);
  in_pieces(room, [&](std::size_t, std::size_t end) { contacts.resize(end); });
  const auto find = [&](const QueryBudget& limits) {
    return search(contacts, ClosestPairsOptions{max_distance, which.get(), oriented_faces, limits});
  };
  const PairCount count = interruptible(budget, find, which.needs_gil());
  return found("Contacts", array_of(std::span<const Contact>(contacts).first(count.count), dtypes().contact), count);
}

TrianglePairs intersections_of(BodyObject& a, BodyObject& b, const PoseLike& pose_a, const PoseLike& pose_b,
                               const TriangleFilter& filter, std::optional<std::size_t> max_count, bool parallel,
                               const BudgetObject* budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_pairs(filter, {std::nullopt, max_count, parallel}, budget, [&](auto visit, const PairOptions& options) {
    return visit_intersections(pair.a(), pair.b(), visit, options);
  });
}

Contacts contacts_of(BodyObject& a, BodyObject& b, double margin, const PoseLike& pose_a, const PoseLike& pose_b,
                     const TriangleFilter& filter, std::optional<std::size_t> max_count,
                     std::optional<OrientedFaces> oriented_faces, bool parallel, const BudgetObject* budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_contacts(filter, {oriented_faces, max_count, parallel}, budget,
                        [&](auto visit, const PairOptions& options) {
                          return visit_contacts(pair.a(), pair.b(), margin, visit, options);
                        });
}

/// As many pairs as there can be: room for more is not needed.
std::size_t most_pairs(const BodyObject& a, const BodyObject& b) {
  return a.body().model().mesh().triangles().size() * b.body().model().mesh().triangles().size();
}

Contacts closest_pairs_of(BodyObject& a, BodyObject& b, std::size_t count, const PoseLike& pose_a,
                          const PoseLike& pose_b, double max_distance, const TriangleFilter& filter,
                          std::optional<OrientedFaces> oriented_faces, const BudgetObject* budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(a, b)), budget,
                       [&](std::span<Contact> room, const ClosestPairsOptions& options) {
                         return closest_pairs(pair.a(), pair.b(), room, options);
                       });
}

ReducedContacts reduce(const ContactsLike& contacts, double radius, double max_angle, std::size_t max_points) {
  const GivenContacts given = contacts_from(contacts, 1);
  const std::vector<std::uint32_t> patch_ids = aside(given.contacts.size(), [=] {
    std::vector<std::uint32_t> patches(given.contacts.size());
    patches.resize(reduce_contacts(given.contacts, radius, {max_angle, max_points, patches}));
    return patches;
  });
  return result(
      "ReducedContacts",
      "records"_a = array_of(std::span<const Contact>(given.contacts).first(patch_ids.size()), dtypes().contact),
      "patch_ids"_a = array_of(std::span<const std::uint32_t>(patch_ids)));
}

// --- one model with itself ---

CollideResult self_collide_of(ModelObject& model, const TriangleFilter& filter, QueryCacheObject* cache,
                              const BudgetObject* budget) {
  const Reading reading_model = reading(model);
  const Filter which(filter);
  const Used used(cache);
  return interruptible(true, which.needs_gil(), budget, used.get(), [&](const QueryBudget& limits) {
    return self_collide(model.model, {which.get(), used.get(), limits});
  });
}

DistanceResult self_distance_of(ModelObject& model, double relative_error, double absolute_error, double max_distance,
                                const TriangleFilter& filter, QueryCacheObject* cache, const BudgetObject* budget) {
  const Reading reading_model = reading(model);
  const Filter which(filter);
  const Used used(cache);
  return interruptible(true, which.needs_gil(), budget, used.get(), [&](const QueryBudget& limits) {
    return self_distance(model.model, {relative_error, absolute_error, max_distance, which.get(), used.get(), limits});
  });
}

TrianglePairs self_intersections_of(ModelObject& model, const TriangleFilter& filter,
                                    std::optional<std::size_t> max_count, bool parallel, const BudgetObject* budget) {
  const Reading guard = reading(model);
  return found_pairs(filter, {std::nullopt, max_count, parallel}, budget, [&](auto visit, const PairOptions& options) {
    return visit_self_intersections(model.model, visit, options);
  });
}

Contacts self_contacts_of(ModelObject& model, double margin, const TriangleFilter& filter,
                          std::optional<std::size_t> max_count, std::optional<OrientedFaces> oriented_faces,
                          bool parallel, const BudgetObject* budget) {
  const Reading guard = reading(model);
  return found_contacts(
      filter, {oriented_faces, max_count, parallel}, budget,
      [&](auto visit, const PairOptions& options) { return visit_self_contacts(model.model, margin, visit, options); });
}

Contacts self_closest_pairs_of(ModelObject& model, std::size_t count, double max_distance, const TriangleFilter& filter,
                               std::optional<OrientedFaces> oriented_faces, const BudgetObject* budget) {
  const Reading guard = reading(model);
  return found_closest(filter, max_distance, oriented_faces, std::min(count, most_pairs(model, model)), budget,
                       [&](std::span<Contact> room, const ClosestPairsOptions& options) {
                         return self_closest_pairs(model.model, room, options);
                       });
}

constexpr const char* filter_note = R"(

Filter   None, a NeighborRings, or a function of two triangle ids: pairs for which it is false do not count. With a
         function the query holds the GIL.)";

const std::string faces_note = std::string("\nFaces    oriented_faces: ") + docs::PairOptions_oriented_faces;

constexpr const char* parallel_note = R"(
Parallel With parallel the search is on all threads: for large models with many pairs. Pairs and their order stay the
         same. All are found before max_count counts. With a function as the filter, or a budget, it stays on one
         thread.)";

constexpr const char* limit_note = R"(
Limit    The search ends where max_count pairs have been found. There may be more then, so is_complete is false.)";

std::string pairs_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + limit_note + R"(
Returns  Ids of triangles, one pair a row: records of shape (k, 2), uint32.)";
}

std::string contacts_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + parallel_note + faces_note + limit_note + R"(
Returns  k records, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

std::string closest_documentation(const char* documentation) {
  return std::string(documentation) + filter_note + faces_note + R"(
Returns  At most `count` records, limber3d.contact_dtype, with these fields.)" +
         contact_fields();
}

void bind_self_queries(nb::module_& m) {
  m.def("self_collide", &self_collide_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        "budget"_a = nb::none(), docs::self_collide);
  m.def("self_distance", &self_distance_of, "model"_a, nb::kw_only(), "relative_error"_a = 0.0,
        "absolute_error"_a = 0.0, max_distance_argument(), "filter"_a = nb::none(), "cache"_a = nb::none(),
        "budget"_a = nb::none(), docs::self_distance);
  m.def("self_intersections", &self_intersections_of, "model"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(), "parallel"_a = false, "budget"_a = nb::none(),
        pairs_documentation(docs::visit_self_intersections).c_str());
  m.def("self_contacts", &self_contacts_of, "model"_a, "margin"_a, nb::kw_only(), "filter"_a = nb::none(),
        "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(), "parallel"_a = false, "budget"_a = nb::none(),
        contacts_documentation(docs::visit_self_contacts).c_str());
  m.def("self_closest_pairs", &self_closest_pairs_of, "model"_a, "count"_a, nb::kw_only(), max_distance_argument(),
        "filter"_a = nb::none(), "oriented_faces"_a = nb::none(), "budget"_a = nb::none(),
        closest_documentation(docs::self_closest_pairs).c_str());
}

}  // namespace

void bind_contacts(nb::module_& m) {
  m.def("intersections", &intersections_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(), "parallel"_a = false,
        "budget"_a = nb::none(), pairs_documentation(docs::visit_intersections).c_str());
  m.def("contacts", &contacts_of, "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "filter"_a = nb::none(), "max_count"_a = nb::none(), "oriented_faces"_a = nb::none(),
        "parallel"_a = false, "budget"_a = nb::none(), contacts_documentation(docs::visit_contacts).c_str());
  m.def("closest_pairs", &closest_pairs_of, "a"_a, "b"_a, "count"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), max_distance_argument(), "filter"_a = nb::none(), "oriented_faces"_a = nb::none(),
        "budget"_a = nb::none(), closest_documentation(docs::closest_pairs).c_str());
  m.def("reduce_contacts", &reduce, "contacts"_a, "radius"_a, nb::kw_only(), "max_angle"_a = 0.5, "max_points"_a = 4,
        (std::string(docs::reduce_contacts) +
         "\n\nReturns  The kept contacts, as records, and patch_ids; the argument is left alone.\n\nmax_angle: " +
         docs::ReductionOptions_max_angle + "\n\nmax_points: " + docs::ReductionOptions_max_points)
            .c_str());
  bind_self_queries(m);
}

}  // namespace limber::python

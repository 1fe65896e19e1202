// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <optional>
#include <string>

#include "arguments.h"
#include "bindings.h"
#include "budget.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"

namespace limber::python {
namespace {

template <typename Query>
auto ask(const PlacedPair& pair, const BudgetObject* budget, const Used<QueryCache>& used, const Query& query) {
  return interruptible(may_take_long(pair.a().body(), pair.b().body()), false, budget, used.get(), query);
}

DistanceResult distance_of(BodyObject& a, BodyObject& b, const PoseLike& pose_a, const PoseLike& pose_b,
                           double relative_error, double absolute_error, double max_distance,
                           const BudgetObject* budget, QueryCacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  return ask(pair, budget, used, [&](const QueryBudget& limits) {
    return distance(pair.a(), pair.b(), {relative_error, absolute_error, max_distance, used.get(), limits});
  });
}

CollideResult collide_of(BodyObject& a, BodyObject& b, const PoseLike& pose_a, const PoseLike& pose_b,
                         const BudgetObject* budget, QueryCacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  return ask(pair, budget, used, [&](const QueryBudget& limits) {
    return collide(pair.a(), pair.b(), {used.get(), limits});
  });
}

CollideResult within_of(BodyObject& a, BodyObject& b, double max_distance, const PoseLike& pose_a,
                        const PoseLike& pose_b, const BudgetObject* budget, QueryCacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  return ask(pair, budget, used, [&](const QueryBudget& limits) {
    return within(pair.a(), pair.b(), max_distance, {used.get(), limits});
  });
}

void bind_arguments(nb::module_& m) {
  nb::class_<QueryCacheObject>(m, "QueryCache", docs::QueryCache)
      .def(nb::init<>())
      .def("clear", &clear<QueryCache>, docs::QueryCache_clear);
  nb::class_<CancelFlag>(m, "CancelFlag", "Ends queries from another thread: those whose budget was given it.")
      .def(nb::init<>())
      .def(
          "set", [](CancelFlag& self) { self.flag = true; }, "Ends the queries.")
      .def(
          "clear", [](CancelFlag& self) { self.flag = false; }, "Lets queries run again.")
      .def(
          "is_set", [](const CancelFlag& self) { return self.flag.load(); }, "Whether queries are to end.");
  nb::class_<BudgetObject>(
      m, "QueryBudget",
      (std::string(docs::QueryBudget) + "\n\nA deadline is a value of time.monotonic(), in seconds.").c_str())
      .def(nb::init<std::optional<double>, std::optional<std::uint64_t>, const CancelFlag*>(), nb::kw_only(),
           nb::keep_alive<1, 4>(), "deadline"_a = nb::none(), "max_steps"_a = nb::none(), "cancel"_a = nb::none());
}

}  // namespace

void bind_queries(nb::module_& m) {
  bind_arguments(m);
  m.def("distance", &distance_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "relative_error"_a = 0.0, "absolute_error"_a = 0.0, max_distance_argument(), "budget"_a = nb::none(),
        "cache"_a = nb::none(),
        (std::string(docs::distance) + "\n\nrelative_error: " + docs::DistanceOptions_relative_error +
         "\n\nabsolute_error: " + docs::DistanceOptions_absolute_error +
         "\n\nmax_distance: " + docs::DistanceOptions_max_distance)
            .c_str());
  m.def("collide", &collide_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "budget"_a = nb::none(), "cache"_a = nb::none(), docs::collide);
  m.def("within", &within_of, "a"_a, "b"_a, "max_distance"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "budget"_a = nb::none(), "cache"_a = nb::none(), docs::within);
}

}  // namespace limber::python

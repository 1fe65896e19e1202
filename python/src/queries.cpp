// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <limits>
#include <optional>
#include <string>

#include "bindings.h"
#include "docstrings.h"
#include "limber/limber.h"
#include "model_object.h"
#include "poses.h"
#include "query_arguments.h"

namespace limber::python {
namespace {

DistanceResult distance(ModelObject& a, ModelObject& b, nb::handle pose_a, nb::handle pose_b, double relative_error,
                        double absolute_error, double max_distance, const BudgetObject* budget, CacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  const DistanceOptions options{relative_error, absolute_error, max_distance, used.get(), budget_of(budget)};
  return without_gil([&] { return limber::distance(pair.a(), pair.b(), options); });
}

CollideResult collide(ModelObject& a, ModelObject& b, nb::handle pose_a, nb::handle pose_b, const BudgetObject* budget,
                      CacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  return without_gil([&] { return limber::collide(pair.a(), pair.b(), {used.get(), budget_of(budget)}); });
}

CollideResult within(ModelObject& a, ModelObject& b, double max_distance, nb::handle pose_a, nb::handle pose_b,
                     const BudgetObject* budget, CacheObject* cache) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  const Used used(cache);
  return without_gil([&] { return limber::within(pair.a(), pair.b(), max_distance, {used.get(), budget_of(budget)}); });
}

void bind_arguments(nb::module_& m) {
  nb::class_<CacheObject>(m, "QueryCache", docs::QueryCache)
      .def(nb::init<>())
      .def(
          "clear",
          [](CacheObject& self) {
            const Used used(&self);
            used.get()->clear();
          },
          docs::QueryCache_clear);
  nb::class_<CancelFlag>(m, "CancelFlag", "Ends queries from another thread: those whose budget was given it.")
      .def(nb::init<>())
      .def("set", &CancelFlag::set, "Ends the queries.")
      .def("clear", &CancelFlag::clear, "Lets queries run again.")
      .def("is_set", &CancelFlag::is_set, "Whether queries are to end.");
  nb::class_<BudgetObject>(
      m, "QueryBudget",
      (std::string(docs::QueryBudget) + "\n\nA deadline is a value of time.monotonic(), in seconds.").c_str())
      .def(nb::init<std::optional<double>, std::optional<std::uint64_t>, const CancelFlag*>(), nb::kw_only(),
           nb::keep_alive<1, 4>(), "deadline"_a = nb::none(), "max_steps"_a = nb::none(), "cancel"_a = nb::none(),
           nb::sig("def __init__(self, *, deadline: float | None = None, max_steps: int | None = None, "
                   "cancel: CancelFlag | None = None) -> None"));
}

}  // namespace

void bind_queries(nb::module_& m) {
  constexpr double unlimited = std::numeric_limits<double>::infinity();
  bind_arguments(m);
  m.def("distance", &distance, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "relative_error"_a = 0.0, "absolute_error"_a = 0.0, "max_distance"_a = unlimited, "budget"_a = nb::none(),
        "cache"_a = nb::none(),
        nb::sig("def distance(a: Model, b: Model, pose_a: PoseLike = None, pose_b: PoseLike = None, *, "
                "relative_error: float = 0.0, absolute_error: float = 0.0, max_distance: float = float('inf'), "
                "budget: QueryBudget | None = None, cache: QueryCache | None = None) -> DistanceResult"),
        (std::string(docs::distance) + "\n\nrelative_error: " + docs::DistanceOptions_relative_error +
         "\n\nabsolute_error: " + docs::DistanceOptions_absolute_error +
         "\n\nmax_distance: " + docs::DistanceOptions_max_distance)
            .c_str());
  m.def("collide", &collide, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "budget"_a = nb::none(), "cache"_a = nb::none(),
        nb::sig("def collide(a: Model, b: Model, pose_a: PoseLike = None, pose_b: PoseLike = None, *, "
                "budget: QueryBudget | None = None, cache: QueryCache | None = None) -> CollideResult"),
        docs::collide);
  m.def("within", &within, "a"_a, "b"_a, "max_distance"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "budget"_a = nb::none(), "cache"_a = nb::none(),
        nb::sig("def within(a: Model, b: Model, max_distance: float, pose_a: PoseLike = None, pose_b: PoseLike = None, "
                "*, budget: QueryBudget | None = None, cache: QueryCache | None = None) -> CollideResult"),
        docs::within);
}

}  // namespace limber::python

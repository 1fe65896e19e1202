// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdio>
#include <string>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "errors.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

std::string text_of(double number) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", number);
  return text;
}

template <typename Enum>
std::string name_of(Enum value) {
  return nb::cast<std::string>(nb::cast(value).attr("name"));
}

/// The truth of an answer that may be unknown.
bool truth_of(const BudgetedAnswer& answer) {
  if (answer.answer != Answer::unknown) return answer.answer == Answer::yes;
  PyErr_SetString(PyExc_RuntimeError, "the budget was spent before there was an answer; see stopped_by");
  throw nb::python_error();
}

void bind_enums(nb::module_& m) {
  nb::enum_<Status>(m, "Status", nb::is_arithmetic(), docs::Status)
      .value("exact", Status::exact, docs::Status_exact)
      .value("within_error", Status::within_error, docs::Status_within_error)
      .value("collision", Status::collision, docs::Status_collision)
      .value("beyond_limit", Status::beyond_limit, docs::Status_beyond_limit)
      .value("interrupted", Status::interrupted, docs::Status_interrupted);
  nb::enum_<StoppedBy>(m, "StoppedBy", nb::is_arithmetic(), "Which limit of its budget has ended a query.")
      .value("nothing", StoppedBy::nothing)
      .value("deadline", StoppedBy::deadline)
      .value("max_steps", StoppedBy::max_steps)
      .value("cancel", StoppedBy::cancel);
  nb::enum_<Answer>(m, "Answer", nb::is_arithmetic(), docs::Answer)
      .value("no", Answer::no)
      .value("yes", Answer::yes)
      .value("unknown", Answer::unknown, docs::Answer_unknown);
  nb::enum_<FeatureKind>(m, "FeatureKind", nb::is_arithmetic(), "A part of a triangle.")
      .value("vertex", FeatureKind::vertex)
      .value("edge", FeatureKind::edge)
      .value("face", FeatureKind::face);
}

void bind_parts(nb::module_& m) {
  const nb::sig point_a("def point_a(self) -> FloatArray"), point_b("def point_b(self) -> FloatArray");
  nb::class_<Witness>(m, "Witness", docs::Witness)
      .def_prop_ro(
          "point_a", [](const Witness& w) { return array_of(w.point_a); }, point_a, "The point on model a.")
      .def_prop_ro(
          "point_b", [](const Witness& w) { return array_of(w.point_b); }, point_b, "The point on model b.")
      .def_ro("triangle_a", &Witness::triangle_a, docs::Witness_triangle_a)
      .def_ro("triangle_b", &Witness::triangle_b, docs::Witness_triangle_a);
  nb::class_<QueryStats>(m, "QueryStats", docs::QueryStats)
      .def_ro("node_tests", &QueryStats::node_tests, docs::QueryStats_node_tests)
      .def_ro("triangle_tests", &QueryStats::triangle_tests, docs::QueryStats_triangle_tests);
  nb::class_<Feature>(m, "Feature", docs::Feature)
      .def_ro("kind", &Feature::kind, "Vertex, edge or face.")
      .def_ro("index", &Feature::index, docs::Feature_index);
}

void bind_answers(nb::module_& m) {
  nb::class_<DistanceResult>(m, "DistanceResult", "What distance() has found.")
      .def_ro("lower", &DistanceResult::lower, docs::DistanceResult_lower)
      .def_ro("upper", &DistanceResult::upper, docs::DistanceResult_upper)
      .def_ro("status", &DistanceResult::status, docs::Status)
      .def_ro("witness", &DistanceResult::witness, docs::DistanceResult_witness)
      .def_ro("stopped_by", &DistanceResult::stopped_by, docs::DistanceResult_stopped_by)
      .def_ro("stats", &DistanceResult::stats, docs::QueryStats)
      .def("__repr__", [](const DistanceResult& r) {
        return std::string("DistanceResult(lower=") + text_of(r.lower) + ", upper=" + text_of(r.upper) +
               ", status=" + name_of(r.status) + ")";
      });
  nb::class_<CollideResult>(m, "CollideResult", "What collide() has found. Its truth is that of `collision`.")
      .def_ro("collision", &CollideResult::collision, "Whether the models meet.")
      .def_ro("witness", &CollideResult::witness, docs::CollideResult_witness)
      .def_ro("stats", &CollideResult::stats, docs::QueryStats)
      .def("__bool__", [](const CollideResult& r) { return r.collision; })
      .def("__repr__", [](const CollideResult& r) {
        return std::string("CollideResult(collision=") + (r.collision ? "True" : "False") + ")";
      });
  nb::class_<WithinResult>(m, "WithinResult", "What within() has found. Its truth is that of `within`.")
      .def_ro("within", &WithinResult::within, "Whether the models are that close.")
      .def_ro("witness", &WithinResult::witness, docs::WithinResult_witness)
      .def_ro("stats", &WithinResult::stats, docs::QueryStats)
      .def("__bool__", [](const WithinResult& r) { return r.within; })
      .def("__repr__", [](const WithinResult& r) {
        return std::string("WithinResult(within=") + (r.within ? "True" : "False") + ")";
      });
  nb::class_<BudgetedAnswer>(
      m, "BudgetedAnswer",
      "What collide() or within() has found within a budget. It is true where the answer is yes, "
      "false where it is no; its truth raises RuntimeError where the answer is unknown.")
      .def_ro("answer", &BudgetedAnswer::answer, docs::Answer)
      .def_ro("witness", &BudgetedAnswer::witness, docs::BudgetedAnswer_witness)
      .def_ro("stopped_by", &BudgetedAnswer::stopped_by, docs::BudgetedAnswer_stopped_by)
      .def_ro("stats", &BudgetedAnswer::stats, docs::QueryStats)
      .def("__bool__", &truth_of)
      .def("__repr__",
           [](const BudgetedAnswer& r) { return std::string("BudgetedAnswer(answer=") + name_of(r.answer) + ")"; });
}

void bind_points_found(nb::module_& m) {
  nb::class_<SurfacePoint>(m, "SurfacePoint", docs::SurfacePoint)
      .def_ro("distance", &SurfacePoint::distance, docs::SurfacePoint_distance)
      .def_prop_ro(
          "position", [](const SurfacePoint& p) { return array_of(p.position); },
          nb::sig("def position(self) -> FloatArray"), "The point of the model, in the world.")
      .def_ro("triangle", &SurfacePoint::triangle, "The triangle that it lies on.")
      .def_prop_ro(
          "barycentric",
          [](const SurfacePoint& p) {
            return array_of(std::span<const double>(p.barycentric), nb::str("float64"), {3});
          },
          nb::sig("def barycentric(self) -> FloatArray"),
          "Weights of the triangle's corners: >= 0, together 1 up to rounding.")
      .def_ro("feature", &SurfacePoint::feature, docs::SurfacePoint_feature);
  nb::class_<PointResult>(m, "PointResult", "What closest_point() has found.")
      .def_ro("closest", &PointResult::closest, docs::PointResult_closest)
      .def_ro("stats", &PointResult::stats, docs::QueryStats);
  nb::class_<SignedDistance>(m, "SignedDistance", "What ClosedSurface.signed_distance() has found.")
      .def_ro("is_inside", &SignedDistance::is_inside, docs::SignedDistance_is_inside)
      .def_ro("closest", &SignedDistance::closest, docs::SignedDistance_closest)
      .def_prop_ro(
          "distance", [](const SignedDistance& s) { return s.closest ? std::optional(s.distance()) : std::nullopt; },
          "Negative inside; on the surface 0, which may have a minus sign. None without a closest point.")
      .def_ro("stats", &SignedDistance::stats, docs::QueryStats);
}

void bind_shapes(nb::module_& m) {
  nb::class_<Box>(m, "Box", docs::Box)
      .def_prop_ro(
          "low", [](const Box& b) { return array_of(b.low); }, nb::sig("def low(self) -> FloatArray"))
      .def_prop_ro(
          "high", [](const Box& b) { return array_of(b.high); }, nb::sig("def high(self) -> FloatArray"));
  nb::class_<Sphere>(m, "Sphere", "The points at most `radius` away from `center`.")
      .def_prop_ro(
          "center", [](const Sphere& s) { return array_of(s.center); }, nb::sig("def center(self) -> FloatArray"))
      .def_ro("radius", &Sphere::radius);
}

nb::object orthonormalized_of(nb::handle matrix) {
  const Array array(matrix, "matrix", "shape (3, 3) and dtype float32 or float64", "float64");
  if (!array.has_floats({3, 3})) array.refuse();
  const auto at = [&](std::ptrdiff_t row, std::ptrdiff_t column) {
    return array.real(array.data() + row * array.stride(0) + column * array.stride(1));
  };
  const Mat3 rotation = value_or_raise(orthonormalized(
      {{at(0, 0), at(0, 1), at(0, 2)}, {at(1, 0), at(1, 1), at(1, 2)}, {at(2, 0), at(2, 1), at(2, 2)}}));
  const std::array<Vec3, 3> rows{rotation.row0, rotation.row1, rotation.row2};
  return array_of(std::span<const Vec3>(rows));
}

}  // namespace

void bind_results(nb::module_& m) {
  bind_enums(m);
  bind_parts(m);
  bind_answers(m);
  bind_points_found(m);
  bind_shapes(m);
  m.def("orthonormalized", &orthonormalized_of, nb::arg("matrix"),
        nb::sig("def orthonormalized(matrix: ArrayLike) -> FloatArray"), docs::orthonormalized);
}

}  // namespace limber::python

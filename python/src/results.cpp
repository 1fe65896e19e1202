// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include <array>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "arrays.h"
#include "bindings.h"
#include "docstrings.h"
#include "limber/limber.h"
#include "records.h"
#include "value_class.h"

namespace limber::python {
namespace {

/// The truth of an answer that may be undecided.
bool truth_of(const CollideResult& answer) {
  if (answer.answer != Answer::undecided) return answer.answer == Answer::yes;
  PyErr_SetString(PyExc_RuntimeError, "the budget was spent before there was an answer; see stopped_by");
  throw nb::python_error();
}

void bind_enums(nb::module_& m) {
  nb::enum_<DistanceStatus>(m, "DistanceStatus", nb::is_arithmetic(), docs::DistanceStatus)
      .value("exact", DistanceStatus::exact, docs::DistanceStatus_exact)
      .value("within_error", DistanceStatus::within_error, docs::DistanceStatus_within_error)
      .value("collision", DistanceStatus::collision, docs::DistanceStatus_collision)
      .value("beyond_limit", DistanceStatus::beyond_limit, docs::DistanceStatus_beyond_limit)
      .value("interrupted", DistanceStatus::interrupted, docs::DistanceStatus_interrupted);
  nb::enum_<StoppedBy>(m, "StoppedBy", nb::is_arithmetic(), "Which limit of its budget has ended a query.")
      .value("nothing", StoppedBy::nothing)
      .value("deadline", StoppedBy::deadline)
      .value("max_steps", StoppedBy::max_steps)
      .value("cancel", StoppedBy::cancel);
  nb::enum_<Answer>(m, "Answer", nb::is_arithmetic(), docs::Answer)
      .value("no", Answer::no)
      .value("yes", Answer::yes)
      .value("undecided", Answer::undecided, docs::Answer_undecided);
  nb::enum_<FeatureKind>(m, "FeatureKind", nb::is_arithmetic(), "A part of a triangle.")
      .value("vertex", FeatureKind::vertex)
      .value("edge", FeatureKind::edge)
      .value("face", FeatureKind::face);
  nb::enum_<NormalSide>(m, "NormalSide", nb::is_arithmetic(), docs::NormalSide)
      .value("unknown", NormalSide::unknown, docs::NormalSide_unknown)
      .value("outward", NormalSide::outward, docs::NormalSide_outward)
      .value("inward", NormalSide::inward, docs::NormalSide_inward);
  nb::enum_<OrientedFaces>(m, "OrientedFaces", docs::OrientedFaces)
      .value("none", OrientedFaces::none, docs::OrientedFaces_none)
      .value("of_a", OrientedFaces::of_a, docs::OrientedFaces_of_a)
      .value("of_b", OrientedFaces::of_b, docs::OrientedFaces_of_b)
      .value("both", OrientedFaces::both, docs::OrientedFaces_both);
}

void bind_parts(nb::module_& m) {
  ValueClass<Witness>(m, "Witness", docs::Witness)
      .field("point_a", &Witness::point_a, "The point on model a.")
      .field("point_b", &Witness::point_b, "The point on model b.")
      .field("triangle_a", &Witness::triangle_a, docs::Witness_triangle_a)
      .field("triangle_b", &Witness::triangle_b, docs::Witness_triangle_a);
  ValueClass<QueryStats>(m, "QueryStats", docs::QueryStats)
      .field("node_tests", &QueryStats::node_tests, docs::QueryStats_node_tests)
      .field("primitive_tests", &QueryStats::primitive_tests, docs::QueryStats_primitive_tests);
  ValueClass<Feature>(m, "Feature", docs::Feature)
      .field("kind", &Feature::kind, "Vertex, edge or face.")
      .field("index", &Feature::index, docs::Feature_index);
}

void bind_answers(nb::module_& m) {
  ValueClass<DistanceResult>(m, "DistanceResult", "What distance() has found.")
      .field("lower", &DistanceResult::lower, docs::DistanceResult_lower)
      .field("upper", &DistanceResult::upper, docs::DistanceResult_upper)
      .field("status", &DistanceResult::status, docs::DistanceStatus)
      .field("witness", &DistanceResult::witness, docs::DistanceResult_witness)
      .field("stopped_by", &DistanceResult::stopped_by, docs::DistanceResult_stopped_by)
      .field("stats", &DistanceResult::stats, docs::QueryStats);
  ValueClass<CollideResult>(m, "CollideResult",
                            "The answer of collide() and within(). It is true where the answer is yes, false where it "
                            "is no. Its truth raises RuntimeError where the answer is undecided, which takes a budget.")
      .field("answer", &CollideResult::answer, docs::Answer)
      .field("witness", &CollideResult::witness, docs::CollideResult_witness)
      .field("stopped_by", &CollideResult::stopped_by, docs::CollideResult_stopped_by)
      .field("stats", &CollideResult::stats, docs::QueryStats)
      .binding()
      .def_prop_ro("is_yes", &CollideResult::is_yes, "Whether the answer is yes.")
      .def_prop_ro("is_no", &CollideResult::is_no, "Whether the answer is no.")
      .def("__bool__", &truth_of);
}

void bind_points_found(nb::module_& m) {
  ValueClass<SurfacePoint>(m, "SurfacePoint", docs::SurfacePoint)
      .field("distance", &SurfacePoint::distance, docs::SurfacePoint_distance)
      .field("position", &SurfacePoint::position, "The point of the model, in the world.")
      .field("triangle", &SurfacePoint::triangle, "The triangle that it lies on.")
      .field("weights", &SurfacePoint::weights, docs::SurfacePoint_weights)
      .field("feature", &SurfacePoint::feature, docs::SurfacePoint_feature);
  ValueClass<PointResult>(m, "PointResult", "What closest_point() has found.")
      .field("closest", &PointResult::closest, docs::PointResult_closest)
      .field("stats", &PointResult::stats, docs::QueryStats);
  ValueClass<SignedDistance>(m, "SignedDistance", "What ClosedSurface.signed_distance() has found.")
      .field("is_inside", &SignedDistance::is_inside, docs::SignedDistance_is_inside)
      .field("closest", &SignedDistance::closest, docs::SignedDistance_closest)
      .field("stats", &SignedDistance::stats, docs::QueryStats)
      .binding()
      .def_prop_ro(
          "distance",
          [](const SignedDistance& s) { return s.closest ? s.distance() : std::numeric_limits<double>::infinity(); },
          "Negative inside, 0 on the surface; infinite without a closest point.");
}

void bind_shapes(nb::module_& m) {
  ValueClass<Box>(m, "Box", docs::Box)
      .field("low", &Box::low, "The least of each coordinate.")
      .field("high", &Box::high, "The largest of each coordinate.");
  ValueClass<Sphere>(m, "Sphere", "The points at most `radius` away from `center`.")
      .field("center", &Sphere::center, "Its center.")
      .field("radius", &Sphere::radius, "Its radius.");
}

FloatArray orthonormalized_of(const ArrayLike& matrix) {
  const Array given(matrix, "matrix", "shape (3, 3) or (4, 4) of floats or integers", Lists::floats);
  const bool is_pose = given.has_floats({4, 4});
  if (!is_pose && !given.has_floats({3, 3})) given.refuse();
  const auto& [x, y, z] = value_or_raise(orthonormalized(matrix_from(given)));
  if (!is_pose) return array_of(std::span<const Vec3>(std::array{x, y, z}));
  const std::vector<double> m = given.numbers();
  const std::array<double, 16> pose{x.x, x.y, x.z, m[3],  y.x,   y.y,   y.z,   m[7],
                                    z.x, z.y, z.z, m[11], m[12], m[13], m[14], m[15]};
  (void)value_or_raise(transform_from_matrix(pose, MatrixOrder::row_major));  // its last row, and finite numbers
  return array_of(std::span<const double>(pose), nb::str("float64"), {4, 4});
}

}  // namespace

void bind_results(nb::module_& m) {
  bind_enums(m);
  bind_parts(m);
  bind_answers(m);
  bind_points_found(m);
  bind_shapes(m);
  m.def("orthonormalized", &orthonormalized_of, "matrix"_a,
        (std::string(docs::orthonormalized) + "\n\nPoses    Of a 4 x 4 matrix the rotation; all else stays as it is.")
            .c_str());
}

}  // namespace limber::python

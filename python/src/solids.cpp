// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>
#include <nanobind/stl/optional.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "arguments.h"
#include "arrays.h"
#include "bindings.h"
#include "budget.h"
#include "closed_surface.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"
#include "value_class.h"

namespace limber::python {
namespace {

/// Two closed surfaces whose models are read until the call returns, and where they stand.
class SurfacePair {
 public:
  SurfacePair(ClosedSurfaceObject& a, ClosedSurfaceObject& b, nb::handle pose_a, nb::handle pose_b)
      : reading_a_(a.reading_model()),
        reading_b_(b.reading_model()),
        a_(a.surface(), pose_from(pose_a, "pose_a")),
        b_(b.surface(), pose_from(pose_b, "pose_b")) {}

  /// Calls query(a, b, budget), both placed, without the GIL.
  template <typename Query>
  auto ask(const BudgetObject* given, const Query& query) const {
    return interruptible(given, [&](const QueryBudget& budget) { return query(a_, b_, budget); });
  }

 private:
  Reading reading_a_, reading_b_;
  PlacedSurface a_, b_;
};

SolidRelationResult relation_of(ClosedSurfaceObject& a, ClosedSurfaceObject& b, const PoseLike& pose_a,
                                const PoseLike& pose_b, const BudgetObject* budget) {
  return SurfacePair(a, b, pose_a, pose_b)
      .ask(budget, [](const PlacedSurface& placed_a, const PlacedSurface& placed_b, const QueryBudget& limits) {
        return solid_relation(placed_a, placed_b, {limits});
      });
}

using Surfaces = Named<"Iterable[ClosedSurface | None]">;

RecordArray relations_of(const Surfaces& surfaces, const ArrayLike& pairs, const PosesLike& poses,
                         const BudgetObject* budget) {
  std::vector<nb::object> owners;  // the caller's list may change meanwhile
  for (const nb::handle surface : nb::iter(surfaces)) owners.push_back(nb::borrow(surface));
  const PoseList standing(poses, "poses");
  if (!standing.is_one_for_all() && standing.size() != owners.size()) {
    throw nb::value_error("poses: expected one for all surfaces, or as many as surfaces");
  }
  std::vector<Reading> guards;
  std::vector<std::optional<PlacedSurface>> placed(owners.size());
  for (std::size_t i = 0; i < owners.size(); ++i) {
    if (owners[i].is_none()) continue;
    auto& surface = nb::cast<ClosedSurfaceObject&>(owners[i]);
    guards.push_back(surface.reading_model());
    placed[i] = PlacedSurface(surface.surface(), standing[i]);
  }
  const std::vector<ObjectPair> asked = id_pairs_from(pairs, "pairs");
  const auto names_surface = [&](std::uint32_t id) { return id < placed.size() && placed[id].has_value(); };
  const bool is_refused = !std::all_of(asked.begin(), asked.end(), [&](const ObjectPair& pair) {
    return names_surface(pair.a) && names_surface(pair.b);
  });
  const auto ask = [&](auto part, auto results, const QueryBudget& limits) {
    solid_relation_many(placed, part, results, {limits});
  };
  return recorded_in_parts<SolidRelationResult>(asked, is_refused, budget, Spent::is_told, dtypes().solid_relation,
                                                ask);
}

DeepestVertices deepest_of(ClosedSurfaceObject& a, ClosedSurfaceObject& b, const PoseLike& pose_a,
                           const PoseLike& pose_b, const BudgetObject* budget) {
  return SurfacePair(a, b, pose_a, pose_b)
      .ask(budget, [](const PlacedSurface& placed_a, const PlacedSurface& placed_b, const QueryBudget& limits) {
        return deepest_vertices(placed_a, placed_b, limits);
      });
}

SeparatingTranslation separating_of(ClosedSurfaceObject& a, ClosedSurfaceObject& b, const ArrayLike& direction,
                                    const PoseLike& pose_a, const PoseLike& pose_b, const BudgetObject* budget) {
  const Vec3 along = point_from(direction, "direction");
  return SurfacePair(a, b, pose_a, pose_b)
      .ask(budget, [&](const PlacedSurface& placed_a, const PlacedSurface& placed_b, const QueryBudget& limits) {
        return separating_translation(placed_a, placed_b, along, limits);
      });
}

SolidDistance signed_distance_of(ClosedSurfaceObject& a, ClosedSurfaceObject& b, const PoseLike& pose_a,
                                 const PoseLike& pose_b, double relative_error, const BudgetObject* budget) {
  return SurfacePair(a, b, pose_a, pose_b)
      .ask(budget, [&](const PlacedSurface& placed_a, const PlacedSurface& placed_b, const QueryBudget& limits) {
        return signed_distance(placed_a, placed_b, {relative_error, limits});
      });
}

void bind_relations(nb::module_& m) {
  nb::enum_<SolidRelation>(m, "SolidRelation", nb::is_arithmetic(), docs::SolidRelation)
      .value("apart", SolidRelation::apart, docs::SolidRelation_apart)
      .value("touching", SolidRelation::touching, docs::SolidRelation_touching)
      .value("overlapping", SolidRelation::overlapping, docs::SolidRelation_overlapping)
      .value("a_inside_b", SolidRelation::a_inside_b, docs::SolidRelation_a_inside_b)
      .value("b_inside_a", SolidRelation::b_inside_a, docs::SolidRelation_b_inside_a)
      .value("equal", SolidRelation::equal, docs::SolidRelation_equal)
      .value("undecided", SolidRelation::undecided, docs::SolidRelation_undecided);
  ValueClass<SolidRelationResult>(m, "SolidRelationResult", "What solid_relation() has found.")
      .field("relation", &SolidRelationResult::relation, docs::SolidRelation)
      .field("witness", &SolidRelationResult::witness, docs::SolidRelationResult_witness)
      .field("stopped_by", &SolidRelationResult::stopped_by, docs::SolidRelationResult_stopped_by)
      .field("stats", &SolidRelationResult::stats, docs::QueryStats);
  m.def("solid_relation", &relation_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "budget"_a = nb::none(), docs::solid_relation);
  m.def("solid_relation_many", &relations_of, "surfaces"_a, "pairs"_a, "poses"_a = nb::none(), nb::kw_only(),
        "budget"_a = nb::none(),
        (std::string(R"(solid_relation() of many pairs, on all threads.

Pairs    name surfaces by their place in the list, (n, 2). If surfaces[id] is that of object `id` of a Scene, and
         poses[id] its pose, they may be those of Scene.candidate_pairs(). A surface may be None where no pair names it.
Shape    poses are one for each surface, or one for all.
Returns  An array of n records, limber3d.solid_relation_dtype, with these fields.
Raises   As solid_relation(), or if a pair names no surface; then nothing is returned.)") +
         solid_relation_fields())
            .c_str());
}

void bind_penetration(nb::module_& m) {
  ValueClass<DeepestVertex>(m, "DeepestVertex", docs::DeepestVertex)
      .field("vertex", &DeepestVertex::vertex, "Its id in the mesh of its own body.")
      .field("depth", &DeepestVertex::depth, docs::DeepestVertex_depth)
      .field("position", &DeepestVertex::position, "Where it is, in the world.")
      .field("closest", &DeepestVertex::closest, docs::DeepestVertex_closest)
      .field("direction", &DeepestVertex::direction, docs::DeepestVertex_direction);
  using Deepest = std::optional<DeepestVertex>;
  ValueClass<DeepestPair>(m, "DeepestPair", docs::DeepestPair)
      .field("of_a", &DeepestPair::of_a, docs::DeepestPair_of_a)
      .field("of_b", &DeepestPair::of_b, docs::DeepestPair_of_b)
      .field("max_depth", &DeepestPair::max_depth, docs::DeepestPair_max_depth);
  ValueClass<DeepestVertices>(m, "DeepestVertices", docs::DeepestVertices)
      .field<Deepest>("of_a", &DeepestVertices::of_a, docs::DeepestPair_of_a)
      .field<Deepest>("of_b", &DeepestVertices::of_b, docs::DeepestPair_of_b)
      .field<double>("max_depth", &DeepestVertices::max_depth, docs::DeepestPair_max_depth)
      .field("stopped_by", &DeepestVertices::stopped_by, "Which limit of its budget has ended it.")
      .field("stats", &DeepestVertices::stats, docs::QueryStats);
  ValueClass<SeparatingTranslation>(m, "SeparatingTranslation", docs::SeparatingTranslation)
      .field("direction", &SeparatingTranslation::direction, docs::SeparatingTranslation_direction)
      .field("lower", &SeparatingTranslation::lower, docs::SeparatingTranslation_lower)
      .field("upper", &SeparatingTranslation::upper, docs::SeparatingTranslation_upper)
      .field("witness", &SeparatingTranslation::witness, docs::SeparatingTranslation_witness)
      .field("stopped_by", &SeparatingTranslation::stopped_by, "Which limit of its budget has ended it.")
      .field("stats", &SeparatingTranslation::stats, docs::QueryStats);
  ValueClass<SolidDistance>(m, "SolidDistance", docs::SolidDistance)
      .field("lower", &SolidDistance::lower, docs::SolidDistance_lower)
      .field("upper", &SolidDistance::upper, docs::SolidDistance_lower)  // one text for both
      .field("translation", &SolidDistance::translation, docs::SolidDistance_translation)
      .field("witness", &SolidDistance::witness, docs::SolidDistance_witness)
      .field("deepest", &SolidDistance::deepest, docs::SolidDistance_deepest)
      .field("stopped_by", &SolidDistance::stopped_by, "Which limit of its budget has ended it.")
      .field("stats", &SolidDistance::stats, docs::QueryStats)
      .binding()
      .def_prop_ro("are_apart", &SolidDistance::are_apart, "Whether the bodies are known to be apart: lower > 0.");
  m.def("deepest_vertices", &deepest_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(), nb::kw_only(),
        "budget"_a = nb::none(), docs::deepest_vertices);
  m.def("separating_translation", &separating_of, "a"_a, "b"_a, "direction"_a, "pose_a"_a = nb::none(),
        "pose_b"_a = nb::none(), nb::kw_only(), "budget"_a = nb::none(), docs::separating_translation);
  m.def("signed_distance", &signed_distance_of, "a"_a, "b"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "relative_error"_a = SolidDistanceOptions{}.relative_error, "budget"_a = nb::none(),
        (std::string(docs::signed_distance) + "\n\nrelative_error: " + docs::SolidDistanceOptions_relative_error +
         "\n\nbudget: " + docs::SolidDistanceOptions_budget)
            .c_str());
}

}  // namespace

void bind_solids(nb::module_& m) {
  bind_relations(m);
  bind_penetration(m);
}

}  // namespace limber::python

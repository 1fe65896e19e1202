// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/nanobind.h>

#include <deque>
#include <string>

#include "arguments.h"
#include "bindings.h"
#include "budget.h"
#include "docstrings.h"
#include "interrupts.h"
#include "limber/limber.h"
#include "records.h"

namespace limber::python {
namespace {

using ElementPairs = Named<"ElementPairs">;
using FeaturePairRecords = Named<"FeaturePairs">;

/// The pairs that search(visitor, visitor, options) visits, without the GIL.
template <typename Search>
ElementPairs found_elements(bool parallel, const BudgetObject* budget, const Search& search) {
  std::deque<VertexFacePair> vertex_face;
  std::deque<EdgeEdgePair> edge_edge;
  const ElementPairCount count = interruptible(budget, [&](const QueryBudget& limits) {
    vertex_face.clear(), edge_edge.clear();
    return search([&](const VertexFacePair& pair) { return vertex_face.push_back(pair), !*limits.abandon; },
                  [&](const EdgeEdgePair& pair) { return edge_edge.push_back(pair), !*limits.abandon; },
                  ElementPairOptions{limits, parallel});
  });
  return result("ElementPairs", "vertex_face"_a = array_of(vertex_face, dtypes().vertex_face),
                "edge_edge"_a = array_of(edge_edge, dtypes().edge_edge), "is_complete"_a = count.is_complete,
                "stopped_by"_a = count.stopped_by, "stats"_a = count.stats);
}

ElementPairs element_pairs_of(ModelObject& a, ModelObject& b, double margin, const PoseLike& pose_a,
                              const PoseLike& pose_b, bool parallel, const BudgetObject* budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_elements(parallel, budget, [&](auto vertex_face, auto edge_edge, const ElementPairOptions& options) {
    return visit_element_pairs(pair.a(), pair.b(), margin, vertex_face, edge_edge, options);
  });
}

ElementPairs self_element_pairs_of(ModelObject& model, double margin, bool parallel, const BudgetObject* budget) {
  const Reading guard = reading(model);
  return found_elements(parallel, budget, [&](auto vertex_face, auto edge_edge, const ElementPairOptions& options) {
    return visit_self_element_pairs(model.model, margin, vertex_face, edge_edge, options);
  });
}

/// The pairs that search(pairs, options) finds, without the GIL.
template <typename Search>
FeaturePairRecords found_features(const BudgetObject* budget, const Search& search) {
  FeaturePairs pairs;
  const ElementPairCount count = interruptible(
      budget, [&](const QueryBudget& limits) { return search(pairs, FeaturePairOptions{.budget = limits}); });
  return result("FeaturePairs", "records"_a = array_of(pairs.list(), dtypes().feature_pair),
                "is_complete"_a = count.is_complete, "stopped_by"_a = count.stopped_by, "stats"_a = count.stats);
}

FeaturePairRecords feature_pairs_of(ModelObject& a, ModelObject& b, double margin, const PoseLike& pose_a,
                                    const PoseLike& pose_b, const BudgetObject* budget) {
  const PlacedPair pair(a, b, pose_a, pose_b);
  return found_features(budget, [&](FeaturePairs& found, const FeaturePairOptions& options) {
    return feature_pairs(pair.a(), pair.b(), margin, found, options);
  });
}

FeaturePairRecords self_feature_pairs_of(ModelObject& model, double margin, const BudgetObject* budget) {
  const Reading guard = reading(model);
  return found_features(budget, [&](FeaturePairs& found, const FeaturePairOptions& options) {
    return self_feature_pairs(model.model, margin, found, options);
  });
}

NeighborRings rings_of(ModelObject& model, std::uint32_t edges) {
  return aside(model.model.mesh().triangles().size(),
               [&mesh = model.model.mesh(), edges, use = InUse(model)] { return NeighborRings(mesh, edges); });
}

std::string element_pairs_documentation(const char* documentation) {
  return std::string(documentation) + "\n\nparallel: " + docs::ElementPairOptions_parallel + R"(

Returns  vertex_face, records of limber3d.vertex_face_dtype, and edge_edge, of limber3d.edge_edge_dtype.

Fields of pairs of a vertex and a face)" +
         vertex_face_fields() + "\n\nFields of pairs of edges" + edge_edge_fields();
}

std::string feature_pairs_documentation(const char* documentation) {
  return std::string(documentation) + "\n\nReturns  Records of limber3d.feature_pair_dtype." + feature_pair_fields();
}

}  // namespace

void bind_elements(nb::module_& m) {
  nb::class_<NeighborRings>(m, "NeighborRings", docs::NeighborRings)
      .def(
          "__init__",
          [](NeighborRings* self, ModelObject& model, std::uint32_t max_edges) {
            new (self) NeighborRings(rings_of(model, max_edges));
          },
          "model"_a, "max_edges"_a, docs::NeighborRings_init)
      .def("are_near", &NeighborRings::are_near, "a"_a, "b"_a, docs::NeighborRings_are_near)
      .def("__call__", &NeighborRings::operator(), "a"_a, "b"_a, docs::NeighborRings_operator)
      .def_prop_ro("triangle_count", &NeighborRings::triangle_count, "Triangles of the mesh.")
      .def_prop_ro("pair_count", &NeighborRings::pair_count, docs::NeighborRings_pair_count);
  m.def("element_pairs", &element_pairs_of, "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "parallel"_a = false, "budget"_a = nb::none(),
        element_pairs_documentation(docs::visit_element_pairs).c_str());
  m.def("self_element_pairs", &self_element_pairs_of, "model"_a, "margin"_a, nb::kw_only(), "parallel"_a = false,
        "budget"_a = nb::none(), element_pairs_documentation(docs::visit_self_element_pairs).c_str());
  m.def("feature_pairs", &feature_pairs_of, "a"_a, "b"_a, "margin"_a, "pose_a"_a = nb::none(), "pose_b"_a = nb::none(),
        nb::kw_only(), "budget"_a = nb::none(), feature_pairs_documentation(docs::feature_pairs).c_str());
  m.def("self_feature_pairs", &self_feature_pairs_of, "model"_a, "margin"_a, nb::kw_only(), "budget"_a = nb::none(),
        feature_pairs_documentation(docs::self_feature_pairs).c_str());
}

}  // namespace limber::python

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/distance_report.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "limber/contacts.h"
#include "reports/page_data.h"
#include "verbs/closed_mesh.h"
#include "verbs/distance_map.h"

namespace limber::program {
namespace {

/// Meshes of more triangles are shown as they are; what a page of smaller ones may grow to.
constexpr std::size_t most_triangles = 100'000;
/// Of the diagonal of the smaller model's box: shorter edges are not divided for the map.
constexpr double shortest_edge_part = 1.0 / 256;

/// A model for point queries and contacts, which only the fast engine has.
class FastModel {
 public:
  FastModel(const PlacedModel& model, Engine engine) : pose_(model.pose) {
    if (engine == Engine::fast) {
      model_ = &model.model.fast();
    } else {
      model_ = &own_.emplace(model.model.mesh());
    }
  }
  FastModel(const FastModel&) = delete;
  FastModel& operator=(const FastModel&) = delete;

  Placed placed() const { return {*model_, pose_}; }

 private:
  Transform pose_;
  std::optional<Model> own_;
  const Model* model_;
};

double diagonal_of(const Box& box) { return length(box.high - box.low); }

/// The triangles of each model that intersect the other, and how many pairs of them there are.
struct Intersections {
  std::size_t pair_count = 0;
  std::vector<TriangleId> a, b;
  std::optional<Vec3> normal;  ///< of the deepest pair, from A to B
};

std::vector<TriangleId> marked_ids(const std::vector<bool>& is_marked) {
  std::vector<TriangleId> ids;
  for (TriangleId t = 0; t < is_marked.size(); ++t) {
    if (is_marked[t]) ids.push_back(t);
  }
  return ids;
}

Intersections intersections_of(const Placed& a, const Placed& b) {
  std::vector<bool> meets_b(a.model().mesh().triangles().size()), meets_a(b.model().mesh().triangles().size());
  Intersections found;
  double deepest = -1;
  const auto visit = [&](const Contact& contact) {
    meets_b[contact.triangle_a] = true;
    meets_a[contact.triangle_b] = true;
    if (contact.depth > deepest) {
      deepest = contact.depth;
      found.normal = contact.normal;
    }
    return true;
  };
  found.pair_count = visit_contacts(a, b, 0, visit).count;
  found.a = marked_ids(meets_b);
  found.b = marked_ids(meets_a);
  return found;
}

Json json_of_model(const std::string& name, const PlacedModel& model, const Placed& other, double shortest_edge,
                   const std::vector<TriangleId>& intersecting) {
  const Mesh& mesh = model.model.mesh();
  const DistanceMap map =
      distance_map(mesh, model.pose, other, shortest_edge, std::max(most_triangles, mesh.triangles().size()));
  const MeshView shown{map.positions, map.triangles};
  const Box box = box_of(shown);
  const PageTriangles triangles(shown);
  Json json = {{"name", shown_name(name)},
               {"triangles", mesh.triangles().size()},
               {"vertices", mesh.positions().size()},
               {"faces", model.model.face_count()},
               {"closed", model.model.is_closed()},
               {"low", to_json(box.low)},
               {"high", to_json(box.high)},
               {"positions", quantized(triangles.in_order(shown.positions))},
               {"corners", base64_of(triangles.corners)},
               {"distances", quantized(triangles.in_order(std::span<const double>(map.distances)))},
               {"intersecting", increasing_ids(intersecting)}};
  if (map.triangles.size() > mesh.triangles().size()) {
    Bytes parts;
    for (const std::uint32_t count : map.parts_of) append_count(parts, count);
    json["parts"] = base64_of(parts);
  }
  return json;
}

/// The corners of the triangles that the closest points lie on.
Json json_of_witness_corners(const Pair& pair, const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  Json json = Json::array();
  for (const auto& [model, id] :
       {std::pair(pair.a(), witness->witness.triangle_a), std::pair(pair.b(), witness->witness.triangle_b)}) {
    const Triangle triangle = model.model.mesh().triangle(id);
    Json corners = Json::array();
    for (std::size_t i = 0; i < 3; ++i) corners.push_back(to_json(model.pose(triangle[i])));
    json.push_back(corners);
  }
  return json;
}

}  // namespace

Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer) {
  const FastModel a(pair.a(), arguments.engine), b(pair.b(), arguments.engine);
  Intersections found;
  if (answer.result.status == Status::collision) found = intersections_of(a.placed(), b.placed());
  const double shortest_edge =
      shortest_edge_part * std::min(diagonal_of(pair.a().model.box()), diagonal_of(pair.b().model.box()));
  Json json;
  append_answer(json, answer);
  append_work(json, answer.result.stats, pair.build_us(), answer.elapsed_us);
  json["min_clearance"] = to_json(question.min_clearance);
  json["max_distance"] =
      std::isfinite(question.options.max_distance) ? Json(question.options.max_distance) : Json(nullptr);
  json["relative_error"] = question.options.relative_error;
  json["absolute_error"] = question.options.absolute_error;
  json["intersections"] = found.pair_count;
  json["contact_normal"] = found.normal ? to_json(*found.normal) : Json(nullptr);
  json["witness_corners"] = json_of_witness_corners(pair, answer.witness);
  json["models"] = {json_of_model(arguments.a, pair.a(), b.placed(), shortest_edge, found.a),
                    json_of_model(arguments.b, pair.b(), a.placed(), shortest_edge, found.b)};
  return json;
}

}  // namespace limber::program

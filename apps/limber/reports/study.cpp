// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/study.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "command/text.h"
#include "formats/position_frames.h"
#include "reports/distance_report.h"
#include "reports/page_data.h"
#include "reports/page_template.h"

namespace limber::program {
namespace {

/// What the triangles that intersect may take in a page, and in one row of it.
constexpr std::size_t most_triangle_bytes = 1'000'000, most_triangle_bytes_of_row = 20'000;

constexpr std::array row_names = {"a",      "b",         "status", "lower",     "upper",        "witness", "clash",
                                  "solids", "too_close", "inside", "max_depth", "intersecting", "query_us"};

/// Both points, then triangles and faces: of a, of b.
Json json_of_witness(const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  const auto& [found, face_a, face_b] = *witness;
  const auto& [a, b, triangle_a, triangle_b] = found;
  return {a.x, a.y, a.z, b.x, b.y, b.z, triangle_a, triangle_b, face_a, face_b};
}

Json json_of_model(const std::string& file, const RigidModel& model) {
  const Mesh& mesh = model.mesh();
  const PageTriangles triangles(mesh);
  return {{"name", shown_name(file)},
          {"triangles", mesh.triangles().size()},
          {"vertices", mesh.positions().size()},
          {"faces", model.face_count()},
          {"closed", model.is_closed()},
          {"low", to_json(model.box().low)},
          {"high", to_json(model.box().high)},
          {"positions", quantized(triangles.in_order(MeshView(mesh).positions))},
          {"corners", base64_of(triangles.corners)}};
}

}  // namespace

Study::Study(StudyKind kind, const DistanceQuestion& question, std::vector<StudyPart> parts, std::size_t pair_count)
    : kind_(kind), question_(question), parts_(std::move(parts)) {
  if (pair_count > most_rows) {
    throw BadInput(fmt::format("--report: a page has room for {} pairs, and there are {}", most_rows, pair_count));
  }
  for (const char* const name : row_names) rows_[name] = Json::array();
}

void Study::add(const PartPair& pair, const DistanceAnswer& answer) {
  Json json;
  append_answer(json, answer);
  json["a"] = pair[0];
  json["b"] = pair[1];
  json["witness"] = json_of_witness(answer.witness);
  json["intersecting"] = answer.relation.surfaces_meet ? intersecting_triangles(pair) : Json(nullptr);
  json["query_us"] = answer.elapsed_us;
  for (const char* const name : row_names) rows_[name].push_back(std::move(json[name]));
}

Json Study::intersecting_triangles(const PartPair& pair) {
  const auto& [a, b] = pair;
  const IntersectingTriangles found = intersecting_triangles_of({parts_[a].model->in_fast_engine(), parts_[a].pose},
                                                                {parts_[b].model->in_fast_engine(), parts_[b].pose});
  std::array<std::string, 2> texts = {increasing_ids(found.a), increasing_ids(found.b)};
  const std::size_t byte_count = texts[0].size() + texts[1].size();
  if (byte_count > most_triangle_bytes_of_row || triangle_bytes_ + byte_count > most_triangle_bytes) return nullptr;
  triangle_bytes_ += byte_count;
  return texts;
}

Json Study::to_json() const {
  std::vector<const RigidModel*> models;
  Json names = Json::array(), files = Json::array(), numbers = Json::array(), json_of_models = Json::array();
  std::vector<Transform> poses;
  for (const StudyPart& part : parts_) {
    const auto found = std::find(models.begin(), models.end(), part.model);
    numbers.push_back(found - models.begin());
    if (found == models.end()) {
      models.push_back(part.model);
      json_of_models.push_back(json_of_model(part.file, *part.model));
    }
    names.push_back(part.name);
    files.push_back(part.file);
    poses.push_back(part.pose);
  }
  const DistanceOptions& options = question_.options;
  return {{"study",
           {{"kind", kind_ == StudyKind::pairs ? "pairs" : "parts"},
            {"min_clearance", program::to_json(question_.min_clearance)},
            {"max_distance", std::isfinite(options.max_distance) ? Json(options.max_distance) : Json(nullptr)},
            {"relative_error", options.relative_error},
            {"absolute_error", options.absolute_error},
            {"parts", {{"name", names}, {"file", files}, {"model", numbers}, {"poses", poses_json(poses)}}},
            {"rows", rows_}}},
          {"models", json_of_models}};
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/study.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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

constexpr std::array row_names = {"a",       "b",        "status",       "lower",     "upper",
                                  "witness", "clash",    "solids",       "too_close", "inside",
                                  "depth",   "accepted", "intersecting", "query_us",  "row"};

/// Both points, then triangles and faces: of a, of b.
Json json_of_witness(const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  const auto& [a, b, triangle_a, triangle_b] = witness->witness;
  return {a.x, a.y, a.z, b.x, b.y, b.z, triangle_a, triangle_b, witness->face_a, witness->face_b};
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

Study::Study(StudyKind kind, const DistanceQuestion& question, std::vector<StudyPart> parts)
    : kind_(kind), question_(question), parts_(std::move(parts)) {}

void Study::add(std::size_t number, const PartPair& pair, const DistanceAnswer& answer,
                const std::optional<std::size_t>& accepted) {
  const std::string word = to_text(*answer.clash);
  if (accepted) {
    ++accepted_;
  } else {
    counts_[word] = counts_.value(word, 0) + 1;
    if (answer.too_close.value_or(false)) ++too_close_;
  }
  // Accepted ones come after all others that are not clear, which are told apart by their distance alone.
  constexpr double clear = static_cast<double>(Clash::clear);
  const double kind = accepted ? clear - 0.5 : std::min(clear, static_cast<double>(*answer.clash));
  Json json;
  json["row"] = number;
  append_answer(json, answer);
  json["accepted"] = program::to_json(accepted);
  json["a"] = pair[0];
  json["b"] = pair[1];
  json["witness"] = json_of_witness(answer.witness);
  json["intersecting"] =
      answer.result.status == DistanceStatus::collision ? intersecting_triangles(pair) : Json(nullptr);
  json["query_us"] = answer.elapsed_us;
  const Badness badness{kind, -answer.depth.value_or(0), answer.result.lower, answer.result.upper,
                        static_cast<double>(number)};
  rows_.emplace_back(badness, std::move(json));
  if (rows_.size() == 2 * most_rows) keep_worst();
}

void Study::keep_worst() {
  std::sort(rows_.begin(), rows_.end(), [](const Row& a, const Row& b) { return a.first < b.first; });
  rows_.resize(std::min(rows_.size(), most_rows));
}

Json Study::intersecting_triangles(const PartPair& pair) {
  const auto& [a, b] = pair;
  const IntersectingTriangles found =
      intersecting_triangles_of({parts_[a].model->model(), parts_[a].pose}, {parts_[b].model->model(), parts_[b].pose});
  std::array<std::string, 2> texts = {increasing_ids(found.a), increasing_ids(found.b)};
  const std::size_t byte_count = texts[0].size() + texts[1].size();
  if (byte_count > most_triangle_bytes_of_row || triangle_bytes_ + byte_count > most_triangle_bytes) return nullptr;
  triangle_bytes_ += byte_count;
  return texts;
}

Json Study::to_json() {
  keep_worst();
  std::vector<std::size_t> places(rows_.size());  // among the worst, by the order of the table
  std::iota(places.begin(), places.end(), std::size_t{0});
  std::sort(places.begin(), places.end(),
            [&](std::size_t i, std::size_t j) { return rows_[i].first.back() < rows_[j].first.back(); });
  Json rows, worst_first = std::vector<std::size_t>(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) worst_first[places[i]] = i;
  for (const char* const name : row_names) {
    rows[name] = Json::array();
    for (const std::size_t place : places) rows[name].push_back(std::move(rows_[place].second[name]));
  }
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
            {"tolerance", question_.tolerances.overlap},
            {"mesh_error", question_.tolerances.mesh_error},
            {"counts", counts_},
            {"accepted", accepted_},
            {"too_close", too_close_},
            {"worst_first", worst_first},
            {"rows", rows}}},
          {"models", json_of_models}};
}

}  // namespace limber::program

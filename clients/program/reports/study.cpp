// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "reports/study.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "command/text.h"
#include "limber/contacts.h"
#include "reports/page_data.h"

namespace limber::program {
namespace {

/// What the triangles that intersect may take in a page, and in one row of it.
constexpr std::size_t most_triangle_bytes = 1'000'000, most_triangle_bytes_of_row = 20'000;

constexpr std::array names_of_rows = {"a",       "b",        "status",       "lower",     "upper",
                                      "witness", "clash",    "solids",       "too_close", "inside",
                                      "depth",   "accepted", "intersecting", "query_us",  "row"};

constexpr std::array kind_names = {"pair", "pairs", "parts"};

/// The triangles of each model that intersect the other, in the order of their ids.
std::array<std::vector<TriangleId>, 2> intersecting_triangles_of(const Placed& a, const Placed& b) {
  std::array<std::vector<TriangleId>, 2> ids;
  visit_intersections(a, b, [&](const TrianglePair& pair) {
    ids[0].push_back(pair.a);
    ids[1].push_back(pair.b);
    return true;
  });
  for (std::vector<TriangleId>& of_side : ids) {
    std::sort(of_side.begin(), of_side.end());
    of_side.erase(std::unique(of_side.begin(), of_side.end()), of_side.end());
  }
  return ids;
}

Json json_of_model(const std::string& file, const RigidModel& model) {
  const Mesh& mesh = model.mesh();
  const PageTriangles triangles(mesh);
  return {{"name", shown_name(file)},
          {"triangles", mesh.triangles().size()},
          {"vertices", mesh.positions().size()},
          {"faces", model.face_count()},
          {"closed", static_cast<bool>(model.surface())},
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
  json["witness"] = flat_witness(answer.witness);
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
  const auto found = intersecting_triangles_of(parts_[pair[0]].placed(), parts_[pair[1]].placed());
  std::array<std::string, 2> texts = {increasing_ids(found[0]), increasing_ids(found[1])};
  const std::size_t byte_count = texts[0].size() + texts[1].size();
  if (kind_ == StudyKind::pair) return texts;
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
  for (const char* const name : names_of_rows) rows[name] = Json::array();
  for (std::size_t i = 0; i < places.size(); ++i) {
    worst_first[places[i]] = i;
    append_row(rows, std::move(rows_[places[i]].second), names_of_rows);
  }
  std::vector<const RigidModel*> models;
  Json json = {{"kind", kind_names.at(static_cast<std::size_t>(kind_))}};
  json.update(settings_of(question_.options, question_.min_clearance));
  json.update({{"tolerance", question_.tolerances.overlap},
               {"mesh_error", question_.tolerances.mesh_error},
               {"counts", counts_},
               {"accepted", accepted_},
               {"too_close", too_close_},
               {"worst_first", worst_first},
               {"rows", rows}});
  for (const StudyPart& part : parts_) {
    const auto found = std::find(models.begin(), models.end(), part.model);
    const auto number = found - models.begin();
    if (found == models.end()) {
      models.push_back(part.model);
      json["models"].push_back(json_of_model(part.file, *part.model));
    }
    const Transform pose[] = {part.pose};
    append_row(json["parts"],
               {{"name", part.name}, {"file", part.file}, {"model", number}, {"poses", poses_json(pose)}}, part_names);
  }
  return json;
}

Json distance_report(const PlacedArguments& arguments, const Pair& pair, const DistanceQuestion& question,
                     const DistanceAnswer& answer) {
  const PlacedModel a = pair.a(), b = pair.b();
  Study study(StudyKind::pair, question,
              {{shown_name(arguments.a), arguments.a, &a.model, a.pose},
               {shown_name(arguments.b), arguments.b, &b.model, b.pose}});
  study.add(0, {0, 1}, answer, std::nullopt);
  Json json = study.to_json(), &extra = json["pair"];
  append_work(extra, answer.result.stats, pair.build_us(), answer.elapsed_us);
  const bool meet = answer.result.status == DistanceStatus::collision;
  extra["intersections"] = meet ? visit_intersections(a, b, [](const TrianglePair&) { return true; }).count : 0;
  return json;
}

}  // namespace limber::program

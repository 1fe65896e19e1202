// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/answers.h"

#include <cmath>

#include "command/text.h"

namespace limber::program {

Json to_json(const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  const auto& [found, face_a, face_b] = *witness;
  return {
      {"point_a", to_json(found.point_a)},
      {"point_b", to_json(found.point_b)},
      {"triangle_a", found.triangle_a},
      {"triangle_b", found.triangle_b},
      {"face_a", face_a},
      {"face_b", face_b},
  };
}

void write_lines(const std::optional<FoundWitness>& witness) {
  if (!witness) return;
  const auto& [found, face_a, face_b] = *witness;
  write_line("point a   {}", to_text(found.point_a, " "));
  write_line("point b   {}", to_text(found.point_b, " "));
  write_line("on a      triangle {}, face {}", found.triangle_a, face_a);
  write_line("on b      triangle {}, face {}", found.triangle_b, face_b);
}

void append_distance(Json& json, const DistanceResult& result, const std::optional<FoundWitness>& witness) {
  json["status"] = to_text(result.status);
  json["lower"] = std::isfinite(result.lower) ? Json(result.lower) : Json(nullptr);  // where there is no pair at all
  json["upper"] = result.status == DistanceStatus::beyond_limit ? Json(nullptr) : Json(result.upper);
  json["witness"] = to_json(witness);
}

void write_distance_lines(const DistanceResult& result, const std::optional<FoundWitness>& witness) {
  write_line("status    {}", to_text(result.status));
  write_line("lower     {}", to_text(result.lower));
  if (result.status != DistanceStatus::beyond_limit) write_line("upper     {}", to_text(result.upper));
  write_lines(witness);
}

Json to_json(Nesting nesting) {
  if (nesting == Nesting::none) return nullptr;
  return nesting == Nesting::a_inside_b ? "a_inside_b" : "b_inside_a";
}

void warn_about(Nesting nesting, const std::string& verb) {
  if (nesting == Nesting::none) return;
  const char* const relation = nesting == Nesting::a_inside_b ? "A lies inside B" : "B lies inside A";
  warn(verb, fmt::format("{} without touching it; models are surfaces, not solids, so they do not collide", relation));
}

void append_work(Json& json, const QueryStats& stats, double query_us) {
  json["query_us"] = query_us;
  json["node_tests"] = stats.node_tests;
  json["primitive_tests"] = stats.primitive_tests;
}

void append_work(Json& json, const QueryStats& stats, double build_us, double query_us) {
  json["build_us"] = build_us;
  append_work(json, stats, query_us);
}

void write_work_lines(const QueryStats& stats, double build_us, double query_us) {
  write_line("tests     {} of nodes, {} of triangles", stats.node_tests, stats.primitive_tests);
  write_line("time      build {} us, query {} us", to_text(build_us), to_text(query_us));
}

DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b) {
  const std::optional<double>& clearance = question.min_clearance;
  const auto timed = ask(a, b, [&](const auto& placed_a, const auto& placed_b) {
    return decided_distance(question.options, clearance, [&](const DistanceOptions& options) {
      return DistanceResult(distance(placed_a, placed_b, options));
    });
  });
  DistanceAnswer answer;
  answer.result = timed.answer;
  answer.witness = with_faces(timed.answer.witness, a.model, b.model);
  answer.relation = relation_of(a, b, timed.answer.status == DistanceStatus::collision);
  if (clearance) answer.too_close = timed.answer.upper < *clearance || answer.relation.is_hard_clash();
  answer.clash = clash_of(answer.relation, answer.too_close.value_or(false));
  if (answer.relation.is_hard_clash()) answer.max_depth = max_depth_of(a, b);
  answer.elapsed_us = timed.elapsed_us;
  return answer;
}

ExitCode exit_code_of(const DistanceQuestion& question, const DistanceAnswer& answer) {
  if (!question.exit_code) return ExitCode::answered;
  const bool is_near = answer.result.status != DistanceStatus::beyond_limit || answer.relation.is_hard_clash();
  const bool is_found = answer.too_close.value_or(is_near);
  return is_found ? ExitCode::found : ExitCode::answered;
}

void append_answer(Json& json, const DistanceAnswer& answer) {
  append_distance(json, answer.result, answer.witness);
  json["too_close"] = to_json(answer.too_close);
  json["inside"] = to_json(answer.relation.nesting);
  json["clash"] = answer.clash ? Json(to_text(*answer.clash)) : Json(nullptr);
  json["solids"] = answer.relation.solids ? Json(to_text(*answer.relation.solids)) : Json(nullptr);
  json["max_depth"] = to_json(answer.max_depth);
}

}  // namespace limber::program

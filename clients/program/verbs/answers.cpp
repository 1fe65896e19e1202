// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/answers.h"

#include <algorithm>
#include <cmath>

#include "command/text.h"

namespace limber::program {

void append_parts(Json& json, const std::string* a, const std::string* b) {
  if (a == nullptr && b == nullptr) return;
  json["part_a"] = a != nullptr ? Json(*a) : Json(nullptr);
  json["part_b"] = b != nullptr ? Json(*b) : Json(nullptr);
}

Json to_json(const std::optional<FoundWitness>& witness) {
  if (!witness) return nullptr;
  const auto& [found, face_a, face_b, part_a, part_b] = *witness;
  Json json = {
      {"point_a", to_json(found.point_a)},
      {"point_b", to_json(found.point_b)},
      {"triangle_a", found.triangle_a},
      {"triangle_b", found.triangle_b},
      {"face_a", face_a},
      {"face_b", face_b},
  };
  append_parts(json, part_a, part_b);
  return json;
}

void write_lines(const std::optional<FoundWitness>& witness) {
  if (!witness) return;
  const auto& [found, face_a, face_b, part_a, part_b] = *witness;
  const auto in = [](const std::string* part) { return part != nullptr ? ", part " + *part : ""; };
  write_line("point a   {}", to_text(found.point_a, " "));
  write_line("point b   {}", to_text(found.point_b, " "));
  write_line("on a      triangle {}, face {}{}", found.triangle_a, face_a, in(part_a));
  write_line("on b      triangle {}, face {}{}", found.triangle_b, face_b, in(part_b));
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

namespace {

/// Whether parts as far apart as `result` says are closer than a clearance; empty where that is open.
std::optional<bool> is_below(const DistanceResult& result, const std::optional<double>& clearance) {
  if (!clearance || result.lower >= *clearance) return false;
  return result.upper < *clearance ? std::optional(true) : std::nullopt;
}

}  // namespace

DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b) {
  const std::optional<double>& clearance = question.min_clearance;
  const double error = question.tolerances.of_pair();
  DistanceOptions wider = question.options;
  wider.max_distance += error;
  const auto timed = ask(a, b, [&](const auto& placed_a, const auto& placed_b) {
    return decided_distance(
        wider, clearance,
        [&](const DistanceOptions& options) { return DistanceResult(distance(placed_a, placed_b, options)); }, error);
  });
  DistanceAnswer answer;
  answer.result = timed.answer;
  answer.witness = with_faces(timed.answer.witness, a.model, b.model);
  answer.relation = relation_of(a, b, timed.answer.status == DistanceStatus::collision);
  answer.depth = proven_depth(a, b, answer.relation);
  if (error > 0) {
    answer.result.lower = std::max(0.0, timed.answer.lower - error);
    answer.result.upper += error;
    if (answer.result.status == DistanceStatus::exact) answer.result.status = DistanceStatus::within_error;
  }
  const Verdict verdict = verdict_of(answer.relation, timed.answer.lower, answer.depth.value_or(0), question.tolerances,
                                     is_below(answer.result, clearance));
  answer.clash = verdict.clash, answer.may_clash = verdict.may_clash;
  if (clearance) answer.too_close = verdict.too_close;
  if (answer.depth) answer.depth = std::max(0.0, *answer.depth - error);
  answer.elapsed_us = timed.elapsed_us;
  return answer;
}

ExitCode exit_code_of(const DistanceQuestion& question, const DistanceAnswer& answer) {
  if (!question.exit_code) return ExitCode::answered;
  const bool may_be_near = answer.may_clash || answer.result.status != DistanceStatus::beyond_limit;
  const bool is_open = answer.clash == Clash::cannot_tell ||
                       (!question.min_clearance && question.tolerances.mesh_error > 0 && may_be_near &&
                        answer.clash != Clash::hard_clash && answer.result.upper > question.options.max_distance);
  if (answer.too_close.value_or(!question.min_clearance && may_be_near && !is_open)) return ExitCode::found;
  return is_open ? ExitCode::undecided : ExitCode::answered;
}

ExitCode worse_of(ExitCode a, ExitCode b) {
  if (a == ExitCode::found || b == ExitCode::found) return ExitCode::found;
  return std::max(a, b);
}

void append_answer(Json& json, const DistanceAnswer& answer) {
  append_distance(json, answer.result, answer.witness);
  json["too_close"] = to_json(answer.too_close);
  json["inside"] = to_json(answer.relation.nesting);
  json["clash"] = answer.clash ? Json(to_text(*answer.clash)) : Json(nullptr);
  json["solids"] = answer.relation.solids ? Json(to_text(*answer.relation.solids)) : Json(nullptr);
  json["depth"] = to_json(answer.depth);
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "answers/answers.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "command/text.h"
#include "limber/penetration.h"

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
  write_line("point a   {}", to_text(found.point_a));
  write_line("point b   {}", to_text(found.point_b));
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

Relation relation_of(const PlacedModel& a, const PlacedModel& b, bool surfaces_meet) {
  Relation relation;
  if (const auto solids = solids_of(a, b)) {
    relation.solids = solids->relation;
    relation.nesting = nesting_of(*solids);
  } else if (!surfaces_meet) {
    relation.nesting = nesting_of(a, b);
  }
  return relation;
}

/// The proven depth of two closed models that overlap; empty for other pairs.
std::optional<double> depth_of(const PlacedModel& a, const PlacedModel& b, const Relation& relation) {
  if (!relation.solids || !relation.overlaps()) return std::nullopt;
  return proven_depth({a.model.surface().value(), a.pose}, {b.model.surface().value(), b.pose});
}

struct Verdict {
  Clash clash = Clash::clear;
  bool may_clash = false;         ///< whether cannot_tell may be a hard clash
  std::optional<bool> too_close;  ///< whether the models are closer than a required clearance; empty where that is open
};

/// The verdict about a pair of meshes that are `gap` apart, or overlap by the proven `depth`. `is_below` tells whether
/// the surfaces of the parts are closer than a required clearance, and is empty where the meshes do not tell.
Verdict verdict_of(const Relation& relation, double gap, double depth, const Tolerances& tolerances,
                   std::optional<bool> is_below) {
  constexpr double any = std::numeric_limits<double>::infinity();
  const double error = tolerances.of_pair();
  double least = 0, most = error - gap;  // how deep the parts are in each other
  if (relation.solids && relation.overlaps()) {
    least = error == 0 && tolerances.overlap == 0 ? any : depth - error;
    most = depth + error;
  } else if (!relation.solids) {  // of one that is not closed, only whether it is enclosed is known
    least = relation.overlaps() && gap > error ? any : 0;
    most = relation.overlaps() || (error > 0 && gap <= error) ? any : 0;
  }
  if (least > tolerances.overlap) return {Clash::hard_clash, true, true};
  if (most > tolerances.overlap) return {Clash::cannot_tell, true, is_below == true ? is_below : std::nullopt};
  if (!is_below) return {Clash::cannot_tell, false, std::nullopt};
  const bool is_apart = gap > error && !relation.overlaps();
  if (!is_apart) return {relation.solids ? Clash::touching : Clash::surfaces_meet, false, is_below};
  const Clash clear = relation.solids ? Clash::clear : Clash::surfaces_apart;
  return {*is_below ? Clash::clearance : clear, false, is_below};
}

}  // namespace

bool Relation::overlaps() const {
  if (!solids) return nesting != Nesting::none;
  return *solids != SolidRelation::apart && *solids != SolidRelation::touching;
}

double proven_depth(const PlacedSurface& a, const PlacedSurface& b) {
  // With this error the search ends with the first way out, however long.
  return std::max(0.0, -signed_distance(a, b, {.relative_error = std::numeric_limits<double>::max()}).upper);
}

DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b) {
  const std::optional<double>& clearance = question.min_clearance;
  const double error = question.tolerances.of_pair();
  DistanceOptions wider = question.options;
  wider.max_distance += error;
  DistanceAnswer answer;
  const Stopwatch asking;
  const DistanceResult of_meshes = decided_distance(
      wider, clearance, [&](const DistanceOptions& options) { return distance(a, b, options); }, error);
  answer.elapsed_us = asking.microseconds();
  answer.result = of_meshes;
  answer.witness = with_faces(of_meshes.witness, a.model, b.model);
  answer.relation = relation_of(a, b, of_meshes.status == DistanceStatus::collision);
  answer.depth = depth_of(a, b, answer.relation);
  if (error > 0) {
    answer.result.lower = std::max(0.0, of_meshes.lower - error);
    answer.result.upper += error;
    if (answer.result.status == DistanceStatus::exact) answer.result.status = DistanceStatus::within_error;
  }
  const Verdict verdict = verdict_of(answer.relation, of_meshes.lower, answer.depth.value_or(0), question.tolerances,
                                     is_below(answer.result, clearance));
  answer.clash = verdict.clash, answer.may_clash = verdict.may_clash;
  if (clearance) answer.too_close = verdict.too_close;
  if (answer.depth) answer.depth = std::max(0.0, *answer.depth - error);
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

const char* to_text(Clash clash) {
  static constexpr const char* words[] = {"hard_clash", "cannot_tell", "surfaces_meet", "touching",
                                          "clearance",  "clear",       "surfaces_apart"};
  return words[static_cast<std::size_t>(clash)];
}

const char* to_text(SolidRelation relation) {
  static constexpr const char* words[] = {"apart",      "touching", "overlapping", "a_inside_b",
                                          "b_inside_a", "equal",    "undecided"};
  return words[static_cast<std::size_t>(relation)];
}

std::string clash_line(Clash clash, const Relation& relation) {
  std::string line = to_text(clash);
  std::replace(line.begin(), line.end(), '_', ' ');
  if (relation.solids == SolidRelation::equal) return line + ": both volumes are equal";
  if (relation.solids == SolidRelation::a_inside_b || relation.nesting == Nesting::a_inside_b) {
    return line + ": A is enclosed in B";
  }
  if (relation.solids == SolidRelation::b_inside_a || relation.nesting == Nesting::b_inside_a) {
    return line + ": B is enclosed in A";
  }
  return line;
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "verbs/distance_answer.h"
#include "limber/distance.h"

namespace limber::program {

DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b) {
  const std::optional<double>& clearance = question.min_clearance;
  const auto timed = ask(a, b, [&](const auto& placed_a, const auto& placed_b) {
    const DistanceResult result = distance(placed_a, placed_b, question.options);
    const bool is_decided = !clearance || result.upper < *clearance || result.lower >= *clearance;
    if (is_decided) return result;
    return distance(placed_a, placed_b, {.max_distance = question.options.max_distance});
  });
  DistanceAnswer answer;
  answer.result = timed.answer;
  answer.witness = with_faces(timed.answer.witness, a.model, b.model);
  if (clearance) answer.too_close = timed.answer.upper < *clearance;
  if (timed.answer.status != Status::collision) answer.nesting = nesting_of(a, b);
  answer.elapsed_us = timed.elapsed_us;
  return answer;
}

ExitCode exit_code_of(const DistanceQuestion& question, const DistanceAnswer& answer) {
  if (!question.exit_code) return ExitCode::answered;
  const bool is_found = answer.too_close ? *answer.too_close : answer.result.status != Status::beyond_limit;
  return is_found ? ExitCode::found : ExitCode::answered;
}

void append_answer(Json& json, const DistanceAnswer& answer) {
  append_distance(json, answer.result, answer.witness);
  json["too_close"] = to_json(answer.too_close);
  json["inside"] = to_json(answer.nesting);
}

}  // namespace limber::program

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>

#include "command/verb.h"
#include "limber/distance.h"
#include "verbs/answers.h"

/// What `limber distance` asks about each pair of models, and what it finds.
namespace limber::program {

struct DistanceQuestion {
  DistanceOptions options;
  std::optional<double> min_clearance;  ///< at most `options.max_distance`
  bool exit_code = false;
};

struct DistanceAnswer {
  DistanceResult result;
  std::optional<FoundWitness> witness;
  std::optional<bool> too_close;  ///< whether the models are closer than `min_clearance`; empty without one
  Nesting nesting = Nesting::none;
  double elapsed_us = 0;
};

/// Asks. Where `min_clearance` lies in the interval that the errors allow, the query is asked once more without them,
/// so that `too_close` is as true as an exact distance.
DistanceAnswer answer_to(const DistanceQuestion& question, const PlacedModel& a, const PlacedModel& b);

/// What one answer is to the exit code: pairs that are too close, or, without `min_clearance`, those not beyond
/// `max_distance`, are found.
ExitCode exit_code_of(const DistanceQuestion& question, const DistanceAnswer& answer);

/// Status, lower, upper, witness, too_close and inside.
void append_answer(Json& json, const DistanceAnswer& answer);

}  // namespace limber::program

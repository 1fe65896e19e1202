// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "query/budget_meter.h"
#include "query/frames.h"
#include "query/placed_models.h"
#include "query/pruning.h"

namespace limber::query {

/// What all parts of one search work on, whatever is looked for.
struct Search {
  const PlacedModels& placed;
  Frames& frames;
  Pruning& pruning;
  BudgetMeter& meter;
  QueryStats& stats;
};

}  // namespace limber::query

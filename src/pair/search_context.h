// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/distance.h"
#include "pair/budget_meter.h"
#include "pair/frames.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"

namespace limber::pair {

/// What all parts of one search work on, whatever is looked for.
struct Search {
  const PlacedPair& placed;
  Frames& frames;
  Pruning& pruning;
  BudgetMeter& meter;
  QueryStats& stats;
};

}  // namespace limber::pair

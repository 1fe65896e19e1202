// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "limber/distance.h"

namespace limber::testing {

/// The same options, with a cache and a budget.
inline DistanceOptions with(DistanceOptions options, QueryCache* cache, const QueryBudget& budget = {}) {
  options.cache = cache, options.budget = budget;
  return options;
}

}  // namespace limber::testing

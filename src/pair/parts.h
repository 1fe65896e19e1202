// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "base/arguments.h"
#include "base/parallel.h"
#include "base/span_filler.h"
#include "limber/contacts.h"
#include "limber/distance.h"

namespace limber::pair {

/// Into how many parts a walk is split: many more than threads, as parts differ in size.
inline constexpr std::size_t part_count = 256;

/// Searches parts of a walk on the threads of the calling arena, search(part, found, stats). Returns what each has
/// found, and adds up what they count.
template <typename Found, typename Part, typename SearchOne>
std::vector<Found> search_parts(const std::vector<Part>& parts, QueryStats& stats, const SearchOne& search) {
  std::vector<Found> found(parts.size());
  std::vector<QueryStats> stats_of(parts.size());
  base::parallel_for(parts.size(), 1, [&](std::size_t i) { search(parts[i], found[i], stats_of[i]); });
  for (const QueryStats& s : stats_of) stats += s;
  return found;
}

/// Whether a query with these options is searched in parts. One with limits stays on one thread.
template <typename Options>
bool runs_in_parallel(const Options& options) {
  return options.parallel && base::has_several_threads() && !base::is_limited(options.budget);
}

/// Visits what parts of a search have found, one part after the other, and counts it in `result`.
template <typename Pair>
void visit_found(const std::vector<base::ListFiller<Pair>>& parts, FunctionRef<bool(const Pair&)> visit,
                 PairCount& result) {
  for (const base::ListFiller<Pair>& part : parts) {
    for (const Pair& found : part.list()) {
      ++result.count;
      result.is_complete = visit(found);
      if (!result.is_complete) return;
    }
  }
}

/// Whether any triangles of two models, or of one with itself, intersect, on the threads of the calling arena. Pre: no
/// body has a radius or is solid. `stats` mean something if none do: otherwise threads have ended sooner or later.
bool intersect_in_parts(const Placed& a, const Placed& b, bool is_self, const QueryBudget& budget, QueryStats& stats);

}  // namespace limber::pair

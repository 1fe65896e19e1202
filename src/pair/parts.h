// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "base/arguments.h"
#include "base/parallel.h"
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

/// Visits what parts of a search have found, list_of(part), one part after the other, and counts it. Returns whether
/// the visitor wants to go on.
template <typename Part, typename Pair, typename ListOf = std::identity>
bool visit_found(const std::vector<Part>& parts, FunctionRef<bool(const Pair&)> visit, std::size_t& count,
                 const ListOf& list_of = {}) {
  for (const Part& part : parts) {
    for (const Pair& found : std::invoke(list_of, part).list()) {
      ++count;
      if (!visit(found)) return false;
    }
  }
  return true;
}

/// Whether any triangles of two models, or of one with itself, intersect, on the threads of the calling arena. Pre: no
/// body has a radius or is solid. `stats` mean something if none do: otherwise threads have ended sooner or later.
bool intersect_in_parts(const Placed& a, const Placed& b, bool is_self, const QueryBudget& budget, QueryStats& stats);

/// visit_self_intersections() for a model under a pose, whose vertices rounding may have moved a little: all pairs of
/// its placed triangles that meet elsewhere than in what they share by their vertex ids. Returns which limit of the
/// budget has left some out.
StoppedBy visit_placed_self_intersections(const Placed& model, TrianglePairVisitor visit, const QueryBudget& budget,
                                          QueryStats& stats);

}  // namespace limber::pair

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
#include "pair/collectors/pairs.h"
#include "pair/placed_pair.h"

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
  for (const QueryStats& s : stats_of) {
    stats.node_tests += s.node_tests, stats.primitive_tests += s.primitive_tests;
  }
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

// visit_intersections() and visit_contacts() on the threads of the calling arena. The visitor is called afterwards, by
// the calling thread, with the pairs that one thread would find, in its order. In a source of their own, so that the
// compiler inlines the loop of one thread as if there were no other.
PairCount visit_intersections_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, TrianglePairVisitor visit,
                                       const QueryBudget& budget);
PairCount visit_intersections_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, TrianglePairVisitor visit,
                                       const QueryBudget& budget);
PairCount visit_contacts_in_parts(const PlacedPair& placed, const PairsOfTwo& pairs, double margin,
                                  ContactVisitor visit, const QueryBudget& budget);
PairCount visit_contacts_in_parts(const PlacedPair& placed, const PairsOfOne& pairs, double margin,
                                  ContactVisitor visit, const QueryBudget& budget);

/// Whether any triangles of two models, or of one with itself, intersect, on the threads of the calling arena. Pre: no
/// body has a radius or is solid. `stats` mean something if none do: otherwise threads have ended sooner or later.
bool intersect_in_parts(const Placed& a, const Placed& b, bool is_self, const QueryBudget& budget, QueryStats& stats);

}  // namespace limber::pair

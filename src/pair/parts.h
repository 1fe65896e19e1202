// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "base/parallel.h"
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
  for (const QueryStats& s : stats_of) {
    stats.node_tests += s.node_tests, stats.primitive_tests += s.primitive_tests;
  }
  return found;
}

}  // namespace limber::pair

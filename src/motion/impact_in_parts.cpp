// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "motion/impact_in_parts.h"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "motion/impact_search.h"
#include "pair/contacts_in_parts.h"

namespace limber {
namespace motion {
namespace {

constexpr std::size_t part_count = 256;  // many more than threads, as parts differ in size

void add(QueryStats& sum, const QueryStats& stats) {
  sum.node_tests += stats.node_tests, sum.primitive_tests += stats.primitive_tests;
}

template <typename Collector, typename Pair>
PairCount count_in_parts(const MovingPair& models, const ImpactOptions& options, FunctionRef<bool(const Pair&)> visit) {
  PairCount result;
  base::ListFiller<Pair> none;
  Collector lister(options, none);
  ImpactSearch<Collector> top(models, options.min_separation, lister);
  const std::vector<ImpactSearchPart> parts = top.split(part_count);
  std::vector<base::ListFiller<Pair>> found(parts.size());
  std::vector<QueryStats> stats_of(parts.size());
  base::parallel_for(parts.size(), 1, [&](std::size_t i) {
    Collector collector(options, found[i]);
    ImpactSearch<Collector> search(models, options.min_separation, collector);
    pair::BudgetMeter meter(options.budget);
    search.run(parts[i], meter);
    stats_of[i] = search.stats;
  });
  result.stats = top.stats;
  for (const QueryStats& stats : stats_of) add(result.stats, stats);
  pair::visit_found(found, visit, result);
  return result;
}

/// Searches a part, with what the parts before it have found.
FoundImpact find_in_part(const MovingPair& models, const ImpactOptions& options, const ImpactSearchPart& part,
                         const FirstImpact& before) {
  FoundImpact found{before, 0};
  ImpactSearch<FirstImpact> search(models, options.min_separation, found.collector);
  pair::BudgetMeter meter(options.budget);
  search.run(part, meter);
  found.first_open_time = search.first_open_time(), found.stats = search.stats;
  return found;
}

}  // namespace

// Parts are searched several at a time, each as if those that are searched with it found nothing. The first one that
// has found something makes the work of those after it void. That happens seldom: parts that touch soon come first, so
// few make the first impact earlier. As long as none does, ever more parts are searched at once.
FoundImpact find_first_in_parts(const MovingPair& models, const ImpactOptions& options) {
  FoundImpact result{FirstImpact(options), 0};
  ImpactSearch<FirstImpact> top(models, options.min_separation, result.collector);
  const std::vector<ImpactSearchPart> parts = top.split(part_count);
  result.stats = top.stats;
  constexpr std::size_t fewest_at_once = 8;
  std::vector<std::optional<FoundImpact>> found(parts.size());
  for (std::size_t begin = 0, at_once = fewest_at_once; begin < parts.size() && !result.collector.is_done();) {
    const FirstImpact before = result.collector;
    const std::size_t end = std::min(parts.size(), begin + at_once);
    std::atomic<std::size_t> first_change = end;
    base::parallel_for(end - begin, 1, [&](std::size_t i) {
      const std::size_t part = begin + i;
      if (part > first_change.load(std::memory_order_relaxed)) return;
      found[part] = find_in_part(models, options, parts[part], before);
      if (!found[part]->collector.differs_from(before)) return;
      std::size_t first = first_change.load(std::memory_order_relaxed);
      while (part < first && !first_change.compare_exchange_weak(first, part, std::memory_order_relaxed)) continue;
    });
    const bool has_changed = first_change < end;
    const std::size_t next = has_changed ? first_change + 1 : end;
    for (; begin < next; ++begin) add(result.stats, found[begin]->stats);
    result.collector = found[next - 1]->collector, result.first_open_time = found[next - 1]->first_open_time;
    at_once = has_changed ? fewest_at_once : 2 * at_once;
  }
  return result;
}

PairCount visit_in_parts(const MovingPair& models, const ImpactOptions& options, ImpactVisitor visit) {
  return count_in_parts<AllImpacts, Impact>(models, options, visit);
}

PairCount visit_in_parts(const MovingPair& models, const ImpactOptions& options, ImpactCandidateVisitor visit) {
  return count_in_parts<ImpactCandidates, ElementPair>(models, options, visit);
}

}  // namespace motion
}  // namespace limber

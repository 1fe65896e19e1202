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
#include "pair/parts.h"

namespace limber {
namespace motion {
namespace {

/// Searches a part, with what the parts before it have found.
FoundImpact find_in_part(const MovingPair& models, const ImpactOptions& options, const SlotPair& part,
                         const FirstImpact& before) {
  FoundImpact found{before, 0};
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<FirstImpact> search(models, options.min_separation, found.collector, meter);
  search.run(part);
  found.first_open_time = search.first_open_time(), found.stats = search.stats();
  return found;
}

}  // namespace

// Parts are searched several at a time, each as if those that are searched with it found nothing. The first one that
// has found something makes the work of those after it void. That happens seldom: parts that touch soon come first, so
// few make the first impact earlier. As long as none does, ever more parts are searched at once.
FoundImpact find_first_in_parts(const MovingPair& models, const ImpactOptions& options) {
  FoundImpact result{FirstImpact(options), 0};
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<FirstImpact> top(models, options.min_separation, result.collector, meter);
  const std::vector<SlotPair> parts = top.split(pair::part_count);
  result.stats = top.stats();
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
    for (; begin < next; ++begin) {
      result.stats.node_tests += found[begin]->stats.node_tests;
      result.stats.primitive_tests += found[begin]->stats.primitive_tests;
    }
    result.collector = found[next - 1]->collector, result.first_open_time = found[next - 1]->first_open_time;
    at_once = has_changed ? fewest_at_once : 2 * at_once;
  }
  return result;
}

}  // namespace motion
}  // namespace limber

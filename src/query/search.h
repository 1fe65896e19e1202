// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "core/check.h"
#include "limber/model.h"
#include "query/placed_models.h"
#include "query/pruning.h"
#include "query/query_cache_impl.h"
#include "query/traversal.h"

namespace limber::query {

/// Runs a traversal to its end. Returns the prune distance: what was not compared is at least that far apart.
template <bool has_front, typename Goal>
double traverse(const PlacedModels& placed, Pruning& pruning, Front* front, Goal& goal, QueryStats& stats) {
  ++stats.node_tests;
  const double root_bound = placed.root_bound();
  if (root_bound >= pruning.distance()) return pruning.distance();
  Traversal<Goal, has_front> traversal(placed, pruning, goal, stats);
  traversal.start(root_bound, front);
  while (traversal.step()) {
  }
  traversal.finish();
  if (placed.drift() > 0) placed.add_margin_cost(traversal.margin_cost());
  return pruning.distance();
}

/// Looks for what a goal wants, first where the last query ended if there is a cache. Returns the prune distance at the
/// end: every pair of triangles that was not compared is at least that far apart.
template <typename Goal>
double search(const PlacedModels& placed, QueryCache* cache, Goal& goal, QueryStats& stats) {
  LIMBER_ASSERT(!Goal::needs_all || cache == nullptr);  // a front skips what the last query has compared
  Pruning pruning(placed, goal.initial_prune_distance());
  if (cache == nullptr) return traverse<false>(placed, pruning, nullptr, goal, stats);
  QueryCache::Impl& last = cache->impl();
  if (placed.has_triangle(Side::a, last.triangle_a) && placed.has_triangle(Side::b, last.triangle_b)) {
    ++stats.triangle_tests;
    const auto improvement = goal.compare({last.triangle_a, placed.triangle(Side::a, last.triangle_a)},
                                          {last.triangle_b, placed.triangle(Side::b, last.triangle_b)});
    if (improvement) pruning.improve(*improvement);
    if (goal.is_done()) return pruning.distance();
  }
  return traverse<true>(placed, pruning, &last.front, goal, stats);
}

/// Notes an answer for the next query.
inline void remember(QueryCache* cache, const Witness& witness) {
  if (cache == nullptr) return;
  cache->impl().triangle_a = witness.triangle_a;
  cache->impl().triangle_b = witness.triangle_b;
}

}  // namespace limber::query

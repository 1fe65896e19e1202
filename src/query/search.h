// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "core/check.h"
#include "geometry/local_frame.h"
#include "limber/model.h"
#include "query/budget_meter.h"
#include "query/placed_models.h"
#include "query/pruning.h"
#include "query/query_cache_impl.h"
#include "query/traversal.h"

namespace limber::query {

/// What a search has left.
struct Unsearched {
  double distance;  ///< every pair of triangles that was not compared is at least that far apart
  StoppedBy stopped_by = StoppedBy::nothing;
};

/// Runs a traversal to its end, or to that of the budget.
template <bool has_front, typename Goal>
Unsearched traverse(const PlacedModels& placed, double root_bound, Pruning& pruning, Front* front, Goal& goal,
                    BudgetMeter& meter, QueryStats& stats) {
  if (root_bound >= pruning.distance()) {
    return {std::max(root_bound, has_front ? front->bound_at_rest(placed) : 0)};
  }
  Traversal<Goal, has_front> traversal(placed, pruning, goal, meter, stats);
  traversal.start(root_bound, front);
  while (traversal.step()) {
  }
  const double open = traversal.finish();
  if (placed.drift() > 0) placed.add_margin_cost(traversal.margin_cost());
  if (goal.is_done()) return {pruning.distance()};
  Unsearched left{std::max(root_bound, std::min(open, pruning.distance()))};
  if (open < pruning.distance()) left.stopped_by = meter.stopped_by();
  if (!has_front) return left;
  left.distance = std::max(left.distance, front->bound());
  front->improve_bound(left.distance);
  return left;
}

/// Offers a goal two vertices if they are close enough. Where the bounds of the roots nearly decide, any two are, at a
/// small part of the cost of a descent.
template <TakesPoints Goal>
void try_vertices(const PlacedModels& placed, double root_bound, Goal& goal, Pruning& pruning) {
  const double good_enough = goal.good_enough(root_bound);
  if (good_enough <= root_bound) return;
  const TriangleId a = placed.first_triangle(Side::a), b = placed.first_triangle(Side::b);
  const Vec3 p = placed.first_vertex(Side::a), q = placed.first_vertex(Side::b);
  const double distance = geometry::safe_length(q - p);
  if (distance > root_bound && distance <= good_enough) {
    if (const auto improvement = goal.take(distance, {p, q, a, b})) pruning.improve(*improvement);
  }
}

/// Looks for what a goal wants, first where the last query ended if there is a cache.
template <typename Goal>
Unsearched search(const PlacedModels& placed, QueryCache* cache, Goal& goal, BudgetMeter& meter, QueryStats& stats) {
  static_assert(!Goal::is_self);
  LIMBER_ASSERT(!Goal::needs_all || cache == nullptr);  // a front skips what the last query has compared
  Pruning pruning(placed, goal.initial_prune_distance());
  ++stats.node_tests;
  const double root_bound = placed.root_bound();
  if (root_bound >= pruning.distance()) return {root_bound};
  if constexpr (TakesPoints<Goal>) {
    if (cache == nullptr && !meter.is_limited()) try_vertices(placed, root_bound, goal, pruning);
  }
  const auto compare = [&](TriangleId a, TriangleId b) {
    ++stats.triangle_tests;
    const auto improvement = goal.compare({a, placed.triangle(Side::a, a)}, {b, placed.triangle(Side::b, b)});
    if (improvement) pruning.improve(*improvement);
  };
  QueryCache::Impl* const last = cache == nullptr ? nullptr : &cache->impl();
  const bool uses_cache = last != nullptr && (meter.is_limited() || last->front.should_record());
  if (uses_cache && placed.has_triangle(Side::a, last->triangle_a) && placed.has_triangle(Side::b, last->triangle_b)) {
    compare(last->triangle_a, last->triangle_b);
  } else if (meter.is_limited()) {
    // There is an upper bound whatever happens.
    compare(placed.first_triangle(Side::a), placed.first_triangle(Side::b));
  }
  if (!uses_cache) {
    return goal.is_done() ? Unsearched{pruning.distance()}
                          : traverse<false>(placed, root_bound, pruning, nullptr, goal, meter, stats);
  }
  const double at_first = pruning.distance();
  const Unsearched left = goal.is_done()
                              ? Unsearched{pruning.distance()}
                              : traverse<true>(placed, root_bound, pruning, &last->front, goal, meter, stats);
  // The cache is of use if its triangles are nearly the answer.
  constexpr double nearly = 1.25;
  if (Goal::takes_any ? goal.is_done() && stats.triangle_tests == 1 : at_first <= nearly * pruning.distance())
    last->front.be_useful();
  return left;
}

/// Looks for what a goal wants among the triangles of one model, which stands on both sides. If there is a cache, the
/// pair of the last answer is compared first, whatever model it was of: it is one of the pairs of this model as well.
template <typename Goal>
Unsearched search_self(const PlacedModels& placed, const QueryCache::Impl* last, Goal& goal, BudgetMeter& meter,
                       QueryStats& stats) {
  static_assert(Goal::is_self);
  LIMBER_ASSERT(&placed.tree(Side::a) == &placed.tree(Side::b) && placed.is_placed_exactly());
  Pruning pruning(placed, goal.initial_prune_distance(), Ties::compared);
  if (last != nullptr && last->triangle_a != last->triangle_b && placed.has_triangle(Side::a, last->triangle_a) &&
      placed.has_triangle(Side::b, last->triangle_b)) {
    ++stats.triangle_tests;
    const auto improvement = goal.compare({last->triangle_a, placed.triangle(Side::a, last->triangle_a)},
                                          {last->triangle_b, placed.triangle(Side::b, last->triangle_b)});
    if (goal.is_done()) return {pruning.distance()};
    if (improvement) pruning.improve(*improvement);
  }
  return traverse<false>(placed, 0, pruning, nullptr, goal, meter, stats);
}

/// Offers a goal all pairs of leaves that may matter: of two models, or of one that stands on both sides.
template <ComparesLeaves Goal>
void search_leaves(const PlacedModels& placed, Goal& goal, QueryStats& stats) {
  BudgetMeter meter;  // without limits
  Pruning pruning(placed, goal.initial_prune_distance());
  traverse<false>(placed, Goal::is_self ? 0 : placed.root_bound(), pruning, nullptr, goal, meter, stats);
}

/// Notes an answer for the next query.
inline void remember(QueryCache* cache, const Witness& witness) {
  if (cache == nullptr) return;
  cache->impl().triangle_a = witness.triangle_a;
  cache->impl().triangle_b = witness.triangle_b;
}

}  // namespace limber::query

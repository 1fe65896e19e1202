// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>

#include "core/check.h"
#include "core/error_bounds.h"
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
  double distance;  ///< all that was not compared is at least that far apart; 0 if the goal is done
  StoppedBy stopped_by = StoppedBy::nothing;
  double work = 0;  ///< pairs of nodes and of leaves that were compared
};

/// Ends a traversal that has made all its steps.
template <typename Goal, bool has_front>
Unsearched finish(Traversal<Goal, has_front>& traversal, const PlacedModels& placed, double root_bound,
                  const Pruning& pruning, const Goal& goal, const BudgetMeter& meter) {
  const double open = traversal.finish();
  if (placed.drift() > 0) placed.add_margin_cost(traversal.margin_cost());
  Unsearched left{0, StoppedBy::nothing, static_cast<double>(traversal.work())};
  if (goal.is_done()) return left;
  left.distance = std::max(root_bound, std::min(open, pruning.cutoff()));
  if (open < pruning.cutoff()) left.stopped_by = meter.stopped_by();
  return left;
}

/// Runs a traversal from the roots, without a front.
template <typename Goal>
Unsearched traverse(const PlacedModels& placed, Frames& frames, double root_bound, Pruning& pruning, Goal& goal,
                    BudgetMeter& meter, QueryStats& stats) {
  Traversal<Goal, false> traversal(placed, frames, pruning, goal, meter, nullptr, stats);
  traversal.start(root_bound);
  while (traversal.step()) {
  }
  return finish(traversal, placed, root_bound, pruning, goal, meter);
}

/// Runs the rest of a traversal that began at the roots without its front, whose records are forgotten.
template <typename Goal>
Unsearched traverse_on(const Traversal<Goal, true>& begun, const PlacedModels& placed, Frames& frames,
                       double root_bound, Pruning& pruning, Front& front, Goal& goal, BudgetMeter& meter,
                       QueryStats& stats) {
  if (placed.drift() > 0) placed.add_margin_cost(begun.margin_cost());
  front.forget_records();
  Traversal<Goal, false> traversal(placed, frames, pruning, goal, meter, nullptr, stats);
  traversal.take_over(front.state());
  while (traversal.step()) {
  }
  const Unsearched left = finish(traversal, placed, root_bound, pruning, goal, meter);
  front.finish(placed.tree(Side::a).unit);
  return left;
}

/// Runs a traversal with a cache: goes on with the one that was interrupted, starts with the records of the last one,
/// or from the roots, whatever promises to be the cheapest.
template <typename Goal>
Unsearched traverse(const PlacedModels& placed, double root_bound, Pruning& pruning, QueryCache::Impl& cache,
                    Goal& goal, BudgetMeter& meter, QueryStats& stats) {
  Front& front = cache.front;
  Frames frames(placed);
  const bool continues = front.can_continue(placed, pruning.cutoff());
  if (!continues && !meter.is_limited() && !cache.bound.is_due()) {
    front.clear();
    const Unsearched left = traverse(placed, frames, root_bound, pruning, goal, meter, stats);
    cache.work_of_new = left.work;
    return left;
  }
  if (!continues) front.begin(placed, frames.a_from_b());
  if (front.bound() >= pruning.cutoff()) {
    cache.judge_bound(true);
    if (!continues) front.finish(placed.tree(Side::a).unit);
    return {std::max(root_bound, front.bound())};
  }
  Unsearched left{0};
  if (continues || meter.is_limited() || cache.recording.is_due()) {
    Traversal<Goal, true> traversal(placed, frames, pruning, goal, meter, &front, stats);
    bool is_new = false;
    if (continues) {
      traversal.go_on();
    } else if (!traversal.start_with_records()) {
      front.forget_records();
      traversal.start(root_bound);
      is_new = true;
    }
    const bool gives_up = is_new && !meter.is_limited();
    while (!(gives_up && front.overflows()) && traversal.step()) {
    }
    left = gives_up && front.overflows()
               ? traverse_on(traversal, placed, frames, root_bound, pruning, front, goal, meter, stats)
               : finish(traversal, placed, root_bound, pruning, goal, meter);
    if (!meter.is_limited() && !continues) is_new ? cache.judge_new_front(left.work) : cache.judge_front(left.work);
  } else {
    front.forget_records();
    left = traverse(placed, frames, root_bound, pruning, goal, meter, stats);
    front.finish(placed.tree(Side::a).unit);
    cache.work_of_new = left.work;
    cache.judge_bound(false);
  }
  left.distance = std::max(left.distance, front.bound());
  front.improve_bound(left.distance);
  return left;
}

/// Offers a goal two vertices if they are close enough. Where the bounds of the roots nearly decide, any two are, at a
/// small part of the cost of a descent. Their distance is rounded up: that of their triangles, which another query may
/// compute, is no larger.
template <TakesPoints Goal>
void try_vertices(const PlacedModels& placed, double root_bound, Goal& goal, Pruning& pruning) {
  const double good_enough = goal.good_enough(root_bound);
  if (good_enough <= root_bound) return;
  const Vec3 p = placed.first_vertex(Side::a), q = placed.first_vertex(Side::b);
  const double distance = geometry::safe_length(q - p);
  if (distance <= root_bound || distance > good_enough || distance < simd::smallest_prune_distance) return;
  const Corners &corners_a = placed.first_corners(Side::a), &corners_b = placed.first_corners(Side::b);
  double extent = max_abs(q - p);
  for (std::size_t k = 1; k < 3; ++k) {
    extent = std::max(extent, max_abs(placed.position(Side::a, corners_a[k]) - p));
    extent = std::max(extent, max_abs(placed.position(Side::b, corners_b[k]) - p));
  }
  const double upper = distance + core::triangle_distance_error * (4 * distance + extent);
  if (upper > good_enough) return;
  const Witness points{p, q, placed.first_triangle(Side::a), placed.first_triangle(Side::b)};
  if (const auto improvement = goal.take(upper, points)) pruning.improve(*improvement);
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
    if (!meter.is_limited()) try_vertices(placed, root_bound, goal, pruning);
    if (goal.is_done() || root_bound >= pruning.distance()) return {root_bound};
  }
  const auto compare = [&](TriangleId a, TriangleId b) {
    ++stats.triangle_tests;
    const auto improvement = goal.compare({a, placed.triangle(Side::a, a)}, {b, placed.triangle(Side::b, b)});
    if (improvement) pruning.improve(*improvement);
  };
  QueryCache::Impl* const last = cache == nullptr ? nullptr : &cache->impl();
  const bool has_pair = last != nullptr && placed.has_triangle(Side::a, last->triangle_a) &&
                        placed.has_triangle(Side::b, last->triangle_b);
  const bool tries_pair = has_pair && (meter.is_limited() || last->pair.is_due());
  if (tries_pair) {
    compare(last->triangle_a, last->triangle_b);
  } else if (meter.is_limited()) {
    // There is an upper bound whatever happens.
    compare(placed.first_triangle(Side::a), placed.first_triangle(Side::b));
  }
  if (goal.is_done()) {
    if (tries_pair) last->judge_pair(true);
    return {pruning.cutoff()};
  }
  if (root_bound >= pruning.distance()) {
    return {std::max(root_bound, last == nullptr ? 0 : last->front.bound_at_rest(placed))};
  }
  if (last == nullptr) {
    Frames frames(placed);
    return traverse(placed, frames, root_bound, pruning, goal, meter, stats);
  }
  const double at_first = pruning.cutoff();
  const Unsearched left = traverse(placed, root_bound, pruning, *last, goal, meter, stats);
  if (tries_pair && !meter.is_limited()) {
    constexpr double close = 1.25;
    last->judge_pair(at_first < goal.initial_prune_distance() && at_first <= close * pruning.cutoff());
  }
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
    if (goal.is_done()) return {pruning.cutoff()};
    if (improvement) pruning.improve(*improvement);
  }
  Frames frames(placed);
  return traverse(placed, frames, 0, pruning, goal, meter, stats);
}

/// Offers a goal all pairs of leaves that may matter: of two models, or of one that stands on both sides.
template <ComparesLeaves Goal>
void search_leaves(const PlacedModels& placed, Goal& goal, QueryStats& stats) {
  BudgetMeter meter;  // without limits
  Pruning pruning(placed, goal.initial_prune_distance());
  const double root_bound = Goal::is_self ? 0 : placed.root_bound();
  if (root_bound >= pruning.distance()) return;
  Frames frames(placed);
  traverse(placed, frames, root_bound, pruning, goal, meter, stats);
}

/// Notes an answer for the next query.
inline void remember(QueryCache* cache, const Witness& witness) {
  if (cache == nullptr) return;
  cache->impl().triangle_a = witness.triangle_a;
  cache->impl().triangle_b = witness.triangle_b;
}

}  // namespace limber::query

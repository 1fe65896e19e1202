// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "base/access.h"
#include "base/check.h"
#include "base/span_filler.h"
#include "geometry/local_frame.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/all_pairs.h"
#include "pair/best_first.h"
#include "pair/collectors/collector.h"
#include "pair/node_bounds.h"
#include "pair/parts.h"
#include "pair/placed_pair.h"
#include "pair/pruning.h"
#include "pair/query_cache_impl.h"
#include "point/closest_point.h"
#include "point/placed_model.h"

namespace limber::pair {

/// The side of which a model is a single point, as the core of a sphere is; b if both are.
inline std::optional<Side> side_of_point(const PlacedPair& placed) {
  for (const Side s : {Side::b, Side::a}) {
    if (placed.is_triangle(s) && geometry::is_point(placed.local_triangle(s, 0))) return s;
  }
  return std::nullopt;
}

/// Offers a collector of the closest pair the point that a model is, with each triangle of the other model that may be
/// closest to it. They are found as closest points are, but compared as all pairs are. So the answer is that of all
/// pairs, to the bit, and everything that is not compared is at least the cutoff apart, unless the collector is done.
template <typename Collector>
void search_by_point(const PlacedPair& placed, Side of_point, Collector& collector, Pruning& pruning,
                     QueryStats& stats) {
  const PlacedTriangle point = placed_triangle(placed, of_point, 0);
  LIMBER_ASSERT(geometry::is_point(point.corners));
  const Side side = other(of_point);
  const point::PlacedModel model(placed.tree(side), placed.mesh(side), placed.pose(side));
  point::NearestTriangles nearest(model);
  nearest.start(point.corners.v0, pruning.cutoff(), collector.close_enough());
  for (auto found = nearest.next(stats); !found.empty(); found = nearest.next(stats)) {
    for (const point::NearestTriangles::Candidate& candidate : found) {
      if (!nearest.matters(candidate)) continue;
      ++stats.primitive_tests;
      const PlacedTriangle triangle{candidate.id(), placed.triangle(side, candidate.vertices())};
      const auto update = side == Side::a ? collector.compare(triangle, point) : collector.compare(point, triangle);
      if (collector.is_done()) return;
      if (!update) continue;
      pruning.update(*update);
      nearest.lower_limit(pruning.cutoff());
    }
  }
}

// How a search for the best goes. Each arrow is one call; every leaf is an answer.
//
//   search()  ── bounds of the roots are beyond the cutoff ──────────────────────────── done
//      │      ── two single triangles ─────────────────────────── compare() ─────────── done
//      │      the pair of the last answer is compared, if a cache has one that pays
//      │      ── it is all that is looked for ───────────────────────────────────────── done
//      │      ── a model is a point ───────────────────────────── search_by_point() ─── done
//      ├── no cache ──────► without_cache()                       from the roots
//      └── a cache ───────► with_cache()
//             ├── neither bound nor front has paid ────────────── without_cache()
//             ├── the bound that is kept reaches the cutoff ──────────────────────────── done
//             ├── the front has not paid ──────────────────────── without_cache(), which renews the bound
//             └── a walk is interrupted, a budget needs the front, or it has paid ────── recording()
//                    ├── goes on where it was interrupted
//                    ├── starts with the records of the front
//                    └── starts from the roots; where the front overflows, the recorder lets it go, and the same walk
//                        goes on
//
// search_self() walks without a front, search_all() and search_all_in_parts() offer all pairs.

/// What is known of the pairs that a search has not compared.
struct Unsearched {
  double distance;  ///< all that was not compared is at least that far apart; of no meaning if the collector is done
  StoppedBy stopped_by = StoppedBy::nothing;
  double work = 0;  ///< pairs of nodes and of leaves that were compared
};

/// Ends a walk that has come to its end, or to that of its budget: what is open is at least `open` apart.
template <typename Collector>
Unsearched unsearched(const Search& search, double root_bound, double open, std::uint64_t work,
                      const Collector& collector) {
  Unsearched left{0, StoppedBy::nothing, static_cast<double>(work)};
  if (collector.is_done()) return left;
  left.distance = std::max(root_bound, std::min(open, search.pruning.cutoff()));
  if (open < search.pruning.cutoff()) left.stopped_by = search.meter.stopped_by();
  return left;
}

/// Walks from the roots.
template <typename Collector>
Unsearched without_cache(const Search& search, double root_bound, Collector& collector) {
  TraversalState state;
  state.clear();
  BestFirst<Collector> walk(search, collector, state);
  walk.start(root_bound);
  walk.run();
  return unsearched(search, root_bound, walk.least_open(), state.work, collector);
}

/// Walks with a recorder: goes on with the walk that was interrupted, or starts with the records of the last one, or
/// from the roots if that promises to be cheaper. Where a new front overflows, the walk goes on without.
template <typename Collector>
Unsearched recording(const Search& search, double root_bound, bool continues, QueryCache::Impl& cache,
                     Collector& collector) {
  Front& front = cache.front;
  TraversalState& state = front.state();
  if (!continues) state.clear();
  BestFirst<Collector, FrontRecorder> walk(search, collector, front);
  bool is_new = false;
  if (continues) {
    search.pruning.restore_direction(front.go_on());
  } else if (!walk.start_with_records()) {
    front.forget_records();
    state.clear();
    if (!search.meter.is_limited()) walk.observer().set_may_give_up();
    walk.start(root_bound);
    is_new = true;
  }
  walk.run();
  const Unsearched left = unsearched(search, root_bound, walk.least_open(), state.work, collector);
  if (!walk.observer().is_recording() || state.queue.empty() || collector.is_done()) {
    front.finish();
  } else {
    front.suspend(search.pruning.cutoff(), search.pruning.direction());
  }
  if (search.meter.is_limited() || continues) return left;  // parts of a query say nothing about what a front saves
  is_new ? cache.judge_new_front(left.work) : cache.judge_front(left.work);
  return left;
}

/// Walks with a cache. Its bound and its front are each used on trial: is_due() says whether that has paid lately, and
/// the judge_...() functions report what was gained or lost (Trial). The diagram above says in which order.
template <typename Collector>
Unsearched with_cache(const Search& search, double root_bound, QueryCache::Impl& cache, Collector& collector) {
  Front& front = cache.front;
  const PlacedPair& placed = search.placed;
  if (front.may_lack_ties(placed, collector.initial_cutoff())) front.clear();
  const bool continues = front.can_continue(placed, search.pruning.cutoff());
  if (!continues && !search.meter.is_limited() && !cache.bound.is_due()) {
    front.clear();
    const Unsearched left = without_cache(search, root_bound, collector);
    cache.work_of_new = left.work;
    return left;
  }
  if (!continues) front.begin(placed, search.frames.a_from_b());
  if (front.bound() >= search.pruning.cutoff()) {
    cache.judge_bound(true);
    if (!continues) front.finish();
    return {std::max(root_bound, front.bound())};
  }
  Unsearched left{0};
  // A front is begun where it has paid, or likely will.
  const bool may_pay = cache.recording.has_paid() || front.has_moved_little(placed);
  if (continues || search.meter.is_limited() || (may_pay && cache.recording.is_due())) {
    left = recording(search, root_bound, continues, cache, collector);
  } else {
    front.forget_records();
    left = without_cache(search, root_bound, collector);
    front.finish();
    cache.work_of_new = left.work;
    if (front.has_bound()) cache.judge_bound(false);
  }
  left.distance = std::max(left.distance, front.bound());
  front.improve_bound(left.distance);
  return left;
}

/// Offers a collector two triangles.
template <typename Collector>
void compare(TriangleId a, TriangleId b, const PlacedPair& placed, Collector& collector, Pruning& pruning,
             QueryStats& stats) {
  ++stats.primitive_tests;
  const auto update = collector.compare(placed_triangle(placed, Side::a, a), placed_triangle(placed, Side::b, b));
  if (update) pruning.update(*update);
}

/// Looks for what a collector wants, first where the last query ended if there is a cache. `ties` and `compared_below`
/// are those of Pruning.
template <typename Collector>
Unsearched search(const PlacedPair& placed, QueryCache* cache, Collector& collector, BudgetMeter& meter,
                  QueryStats& stats, Ties ties = Ties::skipped, double compared_below = 0) {
  static_assert(!Collector::is_self);
  LIMBER_ASSERT(Collector::hits != Hits::k_closest || cache == nullptr);  // a front skips what was compared before
  Pruning pruning(placed, collector.initial_cutoff(), ties, compared_below);
  ++stats.node_tests;
  const double root_bound = placed.root_bound(pruning.distance());
  if (root_bound >= pruning.distance()) return {root_bound};
  if (!collector.is_done() && placed.is_triangle(Side::a) && placed.is_triangle(Side::b)) {
    // Nothing is left open, whatever error is allowed.
    const double limit = pruning.cutoff();
    compare(0, 0, placed, collector, pruning, stats);
    return {std::max(root_bound, limit)};
  }
  QueryCache::Impl* const last = cache == nullptr ? nullptr : &Access::impl(*cache);
  const bool has_pair = last != nullptr && placed.has_triangle(Side::a, last->triangle_a) &&
                        placed.has_triangle(Side::b, last->triangle_b);
  const bool tries_pair = has_pair && (meter.is_limited() || last->pair.is_due());
  if (tries_pair) {
    compare(last->triangle_a, last->triangle_b, placed, collector, pruning, stats);
  } else if (meter.is_limited() && Collector::hits != Hits::k_closest) {
    // So there is an upper bound even if the budget allows no step. The traversal will compare the pair once more.
    compare(placed.first_triangle(Side::a), placed.first_triangle(Side::b), placed, collector, pruning, stats);
  }
  if (collector.is_done()) {
    if (tries_pair) last->judge_pair(true);
    return {pruning.cutoff()};
  }
  if (root_bound >= pruning.distance()) {
    return {std::max(root_bound, last == nullptr ? 0 : last->front.bound_at_rest(placed))};
  }
  if constexpr (Collector::hits == Hits::closest) {
    const std::optional<Side> of_point = meter.is_limited() ? std::nullopt : side_of_point(placed);
    if (of_point) {
      search_by_point(placed, *of_point, collector, pruning, stats);
      return {std::max(root_bound, pruning.cutoff())};
    }
  }
  Frames frames(placed);
  const Search context{placed, frames, pruning, meter, stats};
  if constexpr (Collector::hits == Hits::k_closest) {
    return without_cache(context, root_bound, collector);
  } else {
    if (last == nullptr) return without_cache(context, root_bound, collector);
    const double at_first = pruning.cutoff();
    const Unsearched left = with_cache(context, root_bound, *last, collector);
    if (pruning.skips_ties()) last->front.note_skipped_ties(pruning.cutoff());
    if (tries_pair && !meter.is_limited()) {
      constexpr double close = 1.25;  // the last pair has helped if it was at most that much farther than the answer
      last->judge_pair(at_first < collector.initial_cutoff() && at_first <= close * pruning.cutoff());
    }
    return left;
  }
}

/// Whether the pair of the last answer consists of two different triangles of a model that stands on both sides.
inline bool has_self_pair(const QueryCache::Impl* last, const PlacedPair& placed) {
  return last != nullptr && last->triangle_a != last->triangle_b && placed.has_triangle(Side::a, last->triangle_a) &&
         placed.has_triangle(Side::b, last->triangle_b);
}

/// Looks for the best among the triangles of one model, which stands on both sides. If there is a cache, the pair of
/// the last answer is compared first, even if that was about another model: any two triangles give an upper bound.
template <typename Collector>
Unsearched search_self(const PlacedPair& placed, const QueryCache::Impl* last, Collector& collector, BudgetMeter& meter,
                       QueryStats& stats) {
  static_assert(Collector::is_self);
  LIMBER_ASSERT(&placed.tree(Side::a) == &placed.tree(Side::b) && placed.is_placed_exactly());
  Pruning pruning(placed, collector.initial_cutoff(), Ties::compared);
  if (has_self_pair(last, placed)) {
    compare(last->triangle_a, last->triangle_b, placed, collector, pruning, stats);
    if (collector.is_done()) return {pruning.cutoff()};
  }
  Frames frames(placed);
  return without_cache(Search{placed, frames, pruning, meter, stats}, 0, collector);
}

/// Offers a collector all pairs of triangles, or of leaves, that may count: of two models, or of one that stands on
/// both sides. Returns which limit of the budget has left some out.
template <typename Collector>
StoppedBy search_all(const PlacedPair& placed, Collector& collector, BudgetMeter& meter, QueryStats& stats) {
  Pruning pruning(placed, collector.initial_cutoff());
  double root_bound = 0;
  if constexpr (!Collector::is_self) {
    ++stats.node_tests;
    root_bound = placed.root_bound(pruning.distance());
    if (root_bound >= pruning.distance()) return StoppedBy::nothing;
  }
  Frames frames(placed);
  const Search context{placed, frames, pruning, meter, stats};
  AllPairs<Collector>(context, collector).run(root_bound);
  return meter.stopped_by();
}

/// As search_all() without limits, on the threads of the calling arena: parts of the work have a collector of their
/// own each, make_collector(found). Returns what they have found.
///
/// Promise  The parts do not depend on the number of threads. One after the other they offer the pairs of search_all()
///          in its order.
template <typename Collector, typename Found, typename Make>
std::vector<Found> search_all_in_parts(const PlacedPair& placed, const Make& make_collector, const QueryBudget& budget,
                                       QueryStats& stats) {
  BudgetMeter meter(budget);
  Found none;
  Collector lister = make_collector(none);
  Pruning pruning(placed, lister.initial_cutoff());
  double root_bound = 0;
  if constexpr (!Collector::is_self) {
    ++stats.node_tests;
    root_bound = placed.root_bound(pruning.distance());
    if (root_bound >= pruning.distance()) return {};
  }
  Frames frames(placed);
  AllPairs<Collector> top({placed, frames, pruning, meter, stats}, lister);
  return search_parts<Found>(top.split(root_bound, part_count), stats,
                             [&](const SearchPart& part, Found& found, QueryStats& stats_of_part) {
                               BudgetMeter own_meter(budget);
                               Pruning own_pruning(pruning);
                               Frames own_frames(frames);
                               Collector collector = make_collector(found);
                               const Search search{placed, own_frames, own_pruning, own_meter, stats_of_part};
                               AllPairs<Collector>(search, collector).run(part);
                             });
}

/// Offers all pairs to a collector, make_collector(visitor); or, in parallel, to one for each part, and visits
/// afterwards, on the calling thread and in the same order, what they have found.
template <typename Collector, typename Pair, typename Options, typename Make>
PairCount visit_all(const PlacedPair& placed, const Make& make_collector, FunctionRef<bool(const Pair&)> visit,
                    const Options& options) {
  PairCount result;
  if (runs_in_parallel(options)) {
    using List = base::ListFiller<Pair>;
    const auto found = search_all_in_parts<Collector, List>(placed, make_collector, options.budget, result.stats);
    result.is_complete = visit_found(found, visit, result.count);
    return result;
  }
  Collector collector = make_collector(visit);
  BudgetMeter meter(options.budget);
  result.stopped_by = search_all(placed, collector, meter, result.stats);
  result.count = collector.count;
  result.is_complete = !collector.is_done() && result.stopped_by == StoppedBy::nothing;
  return result;
}

/// Notes an answer for the next query.
inline void remember(QueryCache* cache, const Witness& witness) {
  if (cache == nullptr) return;
  Access::impl(*cache).triangle_a = witness.triangle_a;
  Access::impl(*cache).triangle_b = witness.triangle_b;
}

/// The answer of a search that has stopped with this witness, or with none.
inline CollideResult answer_of(const std::optional<Witness>& witness, StoppedBy stopped_by, const QueryStats& stats) {
  if (witness) return {Answer::yes, witness, StoppedBy::nothing, stats};
  return {stopped_by == StoppedBy::nothing ? Answer::no : Answer::undecided, std::nullopt, stopped_by, stats};
}

inline DistanceStatus status_of(const DistanceResult& result) {
  if (result.upper == 0) return DistanceStatus::collision;
  if (result.stopped_by != StoppedBy::nothing) return DistanceStatus::interrupted;
  return result.lower == result.upper ? DistanceStatus::exact : DistanceStatus::within_error;
}

/// Whether an interval is as narrow as the errors allow. One that begins at 0 is not, whatever the errors: it leaves
/// open whether the models meet.
inline bool is_narrow_enough(const DistanceResult& result, const DistanceOptions& options) {
  if (result.lower == 0 && result.upper > 0) return false;
  return result.upper / (1 + options.relative_error) <= result.lower ||
         result.upper - result.lower <= options.absolute_error;
}

/// Writes what a search for the closest pair of the cores has found. A budget may be spent just when the errors are
/// met; then the query has its answer.
inline void set_answer(DistanceResult& result, const ClosestPair& collector, const Unsearched& unsearched,
                       const DistanceOptions& options, const Radii& radii = {0, 0}) {
  result.stopped_by = unsearched.stopped_by;
  const bool is_beyond = !collector.witness || radii.distance(collector.upper) > options.max_distance;
  if (is_beyond && unsearched.stopped_by == StoppedBy::nothing) {
    result.upper = std::numeric_limits<double>::infinity();
    result.lower = options.max_distance;
    result.status = DistanceStatus::beyond_limit;
    return;
  }
  result.upper = radii.distance(collector.upper);
  result.lower = radii.distance(std::min(collector.upper, unsearched.distance));
  result.witness = collector.witness;
  if (result.witness) radii.move_points(*result.witness, collector.upper);
  if (result.upper <= options.max_distance && is_narrow_enough(result, options)) result.stopped_by = StoppedBy::nothing;
  result.status = status_of(result);
}

}  // namespace limber::pair

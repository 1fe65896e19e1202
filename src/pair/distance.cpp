// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public queries: each checks its arguments, and searches with a collector.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/arguments.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "limber/distance.h"
#include "limber/model.h"
#include "pair/budget_meter.h"
#include "pair/collectors/collector.h"
#include "pair/containment.h"
#include "pair/convex_pair.h"
#include "pair/placed_pair.h"
#include "pair/query_cache_impl.h"
#include "pair/search.h"

namespace limber {
namespace {

using pair::answer_of;
using pair::BudgetMeter;

/// Below that distance of cores, rounding could make a pair that is skipped as a tie one whose swept triangles meet.
double tied_with_contacts(const pair::PlacedPair& placed, const pair::Radii& radii) {
  if (!radii.has_radius()) return 0;
  return radii.radius() + 4 * (placed.error() + base::tie_error * radii.radius());
}

/// Whether a part of one body can be inside of the other: that takes a solid, and bounds that overlap.
bool may_contain(const Placed& a, const Placed& b, const pair::PlacedPair& placed) {
  return pair::has_solid(a, b) && placed.root_bound(std::numeric_limits<double>::min()) == 0;
}

pair::Containment find_containment(const Placed& a, const Placed& b, const pair::Unsearched& unsearched,
                                   BudgetMeter& meter, QueryStats& stats) {
  return pair::find_containment(a, b, static_cast<std::uint64_t>(unsearched.work), meter, stats);
}

/// Takes into account what is inside of solids, once the surfaces are known not to meet.
void look_inside(CollideResult& result, const Placed& a, const Placed& b, const pair::PlacedPair& placed,
                 const pair::Unsearched& unsearched, BudgetMeter& meter) {
  if (!result.is_no() || !may_contain(a, b, placed)) return;
  const pair::Containment found = find_containment(a, b, unsearched, meter, result.stats);
  result.answer = found.answer, result.witness = found.witness;
  if (found.answer == Answer::undecided) result.stopped_by = meter.stopped_by();
}

void look_inside(DistanceResult& result, const Placed& a, const Placed& b, const pair::PlacedPair& placed,
                 const pair::Unsearched& unsearched, BudgetMeter& meter) {
  if (result.status == DistanceStatus::collision || !may_contain(a, b, placed)) return;
  if (result.status != DistanceStatus::interrupted) {
    const pair::Containment found = find_containment(a, b, unsearched, meter, result.stats);
    if (found.answer == Answer::no) return;
    if (found.answer == Answer::yes) {
      result.lower = result.upper = 0, result.status = DistanceStatus::collision, result.witness = found.witness;
      result.stopped_by = StoppedBy::nothing;
      return;
    }
  }
  result.lower = 0, result.status = DistanceStatus::interrupted, result.stopped_by = meter.stopped_by();
  if (result.witness) return;
  // Some pair, as of every distance that was interrupted.
  pair::ClosestPair some({}, 0);
  some.compare(pair::placed_triangle(placed, pair::Side::a, placed.first_triangle(pair::Side::a)),
               pair::placed_triangle(placed, pair::Side::b, placed.first_triangle(pair::Side::b)));
  pair::set_answer(result, some, {0, result.stopped_by}, {}, pair::Radii(a, b));
}

/// Compares the triangles that the search of two convex bodies has found.
void compare_found(const pair::ConvexGap& gap, const pair::PlacedPair& placed, pair::ClosestPair& collector,
                   QueryStats& stats) {
  if (gap.a == no_id) return;
  ++stats.primitive_tests;
  collector.compare(pair::placed_triangle(placed, pair::Side::a, gap.a),
                    pair::placed_triangle(placed, pair::Side::b, gap.b));
}

/// Lets the search of two convex bodies answer, where it has proven enough: what is then left. `tied` is how far cores
/// have to be apart for rounding not to matter.
std::optional<pair::Unsearched> settle(const pair::ConvexGap& gap, const pair::PlacedPair& placed, double limit,
                                       double tied, pair::ClosestPair& collector, QueryStats& stats) {
  if (gap.lower > limit) return pair::Unsearched{gap.lower};
  pair::ClosestPair found = collector;  // a walk has to find by itself what it prunes by
  compare_found(gap, placed, found, stats);
  const bool is_settled = gap.lower > tied && found.upper <= limit && found.upper - gap.height <= gap.rounding;
  if (!is_settled && !found.is_done()) return std::nullopt;
  collector = found;
  return pair::Unsearched{collector.upper};
}

CollideResult within(const Placed& a, const Placed& b, const pair::PlacedPair& placed, const pair::Radii& radii,
                     double max_distance, const QueryOptions& options) {
  BudgetMeter meter(options.budget);
  QueryStats stats;
  const double limit = radii.core_limit(max_distance);
  pair::ClosestPair collector({.max_distance = limit}, limit);
  const pair::ConvexGap gap = pair::find_gap(a, b, placed, limit, options.budget, options.cache, stats);
  if (gap.lower > limit) return answer_of(std::nullopt, StoppedBy::nothing, stats);
  compare_found(gap, placed, collector, stats);
  // So that the answer is that of comparing all pairs, whatever comes first.
  const pair::Unsearched unsearched =
      collector.is_done() ? pair::Unsearched{0}
                          : pair::search(placed, options.cache, collector, meter, stats, pair::Ties::compared);
  if (collector.upper > limit) {
    CollideResult result = answer_of(std::nullopt, unsearched.stopped_by, stats);
    look_inside(result, a, b, placed, unsearched, meter);
    return result;
  }
  pair::remember(options.cache, *collector.witness);
  radii.move_points(*collector.witness, collector.upper);
  return answer_of(collector.witness, unsearched.stopped_by, stats);
}

}  // namespace

CollideResult collide(const Placed& a, const Placed& b, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  const pair::PlacedPair placed(a, b);
  const pair::Radii radii(a, b);
  if (radii.has_radius()) return within(a, b, placed, radii, 0, options);
  BudgetMeter meter(options.budget);
  QueryStats stats;
  if (pair::find_gap(a, b, placed, 0, options.budget, options.cache, stats).lower > 0) {
    return answer_of(std::nullopt, StoppedBy::nothing, stats);
  }
  pair::AnyContact collector;
  const pair::Unsearched unsearched = pair::search(placed, options.cache, collector, meter, stats);
  if (collector.witness) pair::remember(options.cache, *collector.witness);
  if (!pair::has_solid(a, b)) return answer_of(collector.witness, unsearched.stopped_by, stats);
  CollideResult result = answer_of(collector.witness, unsearched.stopped_by, stats);
  look_inside(result, a, b, placed, unsearched, meter);
  return result;
}

DistanceResult distance(const Placed& a, const Placed& b, const DistanceOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_options(options, "limber::distance");
  const pair::PlacedPair placed(a, b);
  const pair::Radii radii(a, b);
  BudgetMeter meter(options.budget);
  DistanceResult result;
  const double limit = radii.core_limit(options.max_distance);
  pair::ClosestPair collector({options.relative_error, options.absolute_error, limit}, radii.radius(), radii.radius());
  const double tied = tied_with_contacts(placed, radii);
  const pair::ConvexGap gap = pair::find_gap(a, b, placed, limit, options.budget, options.cache, result.stats);
  const auto settled = settle(gap, placed, limit, tied, collector, result.stats);
  const pair::Unsearched unsearched =
      settled ? *settled
              : pair::search(placed, options.cache, collector, meter, result.stats, pair::Ties::skipped, tied);
  if (!collector.witness && unsearched.stopped_by != StoppedBy::nothing) {  // abandoned before anything was compared
    collector.compare(pair::placed_triangle(placed, pair::Side::a, placed.first_triangle(pair::Side::a)),
                      pair::placed_triangle(placed, pair::Side::b, placed.first_triangle(pair::Side::b)));
  }
  pair::set_answer(result, collector, unsearched, options, radii);
  if (result.witness) pair::remember(options.cache, *result.witness);
  if (!settled) look_inside(result, a, b, placed, unsearched, meter);
  return result;
}

CollideResult within(const Placed& a, const Placed& b, double max_distance, const QueryOptions& options) {
  const base::DefaultFloatEnvironment environment;
  base::check_max_distance(max_distance);
  return within(a, b, pair::PlacedPair(a, b), pair::Radii(a, b), max_distance, options);
}

QueryCache::QueryCache() = default;
QueryCache::QueryCache(QueryCache&&) noexcept = default;
QueryCache& QueryCache::operator=(QueryCache&&) noexcept = default;
QueryCache::~QueryCache() = default;

void QueryCache::clear() { impl_.reset(); }

QueryCache::Impl& QueryCache::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>();
  return *impl_;
}

}  // namespace limber

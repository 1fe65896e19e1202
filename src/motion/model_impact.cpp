// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions of motion.h for models.
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "limber/contacts.h"
#include "motion/element_impact.h"
#include "motion/element_state.h"
#include "motion/impact_collectors.h"
#include "motion/impact_in_parts.h"
#include "motion/impact_search.h"
#include "motion/moving_pair.h"
#include "pair/parts.h"

namespace limber {
namespace motion {
namespace {

void check_options(const ImpactOptions& options, const char* function) {
  check(of_elements(options), function);
  LIMBER_REQUIRE(options.separation_fraction >= 0 && options.separation_fraction < 1,
                 (std::string(function) + ": separation_fraction is not from 0 to below 1").c_str());
}

/// Sets elements, witness and normal of a contact, as they are at the time `upper`.
void set_place(const MovingPair& models, const IdentifiedElements& found, ImpactResult& result) {
  const ElementState state = state_at(models, found, result.upper);
  result.elements = found.pair, result.normal = state.normal;
  result.witness = {state.point_a, state.point_b, models.triangle_of(Side::a, found.pair),
                    models.triangle_of(Side::b, found.pair)};
}

/// What is known of models that cross at the start, or may: the budget was spent before that was clear.
ImpactResult crossing(const CollideResult& found) {
  ImpactResult result;
  result.stopped_by = found.stopped_by;
  if (!found.is_yes()) return result;
  result.status = ImpactStatus::initial_contact, result.upper = 0;
  result.witness = found.witness;
  return result;
}

CollideResult collide_at_start(const MovingPair& models, const ImpactOptions& options) {
  const MovingModel::Impl &a = models.model(Side::a), &b = models.model(Side::b);
  if (pair::runs_in_parallel(options)) {
    CollideResult none;
    none.answer = Answer::no;
    const Placed placed_a{*a.model, a.start_pose}, placed_b{*b.model, b.start_pose};
    if (!pair::intersect_in_parts(placed_a, placed_b, models.is_self(), options.budget, none.stats)) return none;
  }  // else one thread says which pair is the witness
  if (models.is_self()) return self_collide(*a.model, {.budget = options.budget});
  return collide({*a.model, a.start_pose}, {*b.model, b.start_pose}, {nullptr, options.budget});
}

/// The first impact, on one thread.
FoundImpact find_first(const MovingPair& models, const ImpactOptions& options) {
  FirstImpact collector(options);
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<FirstImpact> search(models, options.min_separation, collector, meter);
  search.run();
  return {collector, search.first_open_time(), meter.stopped_by(), search.stats()};
}

ImpactResult first_touch(const MovingPair& models, const ImpactOptions& options) {
  const FoundImpact found =
      pair::runs_in_parallel(options) ? find_first_in_parts(models, options) : find_first(models, options);
  const FirstImpact& first = found.collector;
  ImpactResult result;
  result.stats = found.stats, result.stopped_by = found.stopped_by;
  const bool is_undecided = result.stopped_by != StoppedBy::nothing;
  result.status = is_undecided ? ImpactStatus::undecided : first.status;
  result.lower = first.lower, result.upper = first.upper;
  if (is_undecided || first.is_done()) result.lower = found.first_open_time;
  if (first.best) set_place(models, *first.best, result);
  return result;
}

ImpactResult first_impact(const MovingPair& models, const ImpactOptions& options) {
  if (options.ignore_crossings) return first_touch(models, options);
  const CollideResult at_start = collide_at_start(models, options);
  ImpactResult result = at_start.is_no() ? first_touch(models, options) : crossing(at_start);
  result.stats += at_start.stats;
  return result;
}

/// Visits what one thread would, in its order, afterwards, on the calling thread.
template <typename Collector, typename Pair>
PairCount count_in_parts(const MovingPair& models, const ImpactOptions& options, FunctionRef<bool(const Pair&)> visit) {
  PairCount result;
  base::ListFiller<Pair> none;
  Collector lister(options, none);
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<Collector> top(models, options.min_separation, lister, meter);
  const std::vector<SlotPair> parts = top.split(pair::part_count);
  result.stats = top.stats();
  const auto found = pair::search_parts<base::ListFiller<Pair>>(
      parts, result.stats, [&](const SlotPair& part, base::ListFiller<Pair>& list, QueryStats& stats) {
        Collector collector(options, list);
        pair::BudgetMeter own_meter(options.budget);
        ImpactSearch<Collector> search(models, options.min_separation, collector, own_meter);
        search.run(part);
        stats = search.stats();
      });
  pair::visit_found(found, visit, result);
  return result;
}

/// Visits pairs with a collector of all of them.
template <typename Collector, typename Visitor>
PairCount visit_all(const MovingPair& models, const ImpactOptions& options, Visitor visit) {
  if (pair::runs_in_parallel(options)) return count_in_parts<Collector>(models, options, visit);
  Collector collector(options, visit);
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<Collector> search(models, options.min_separation, collector, meter);
  search.run();
  const bool is_complete = !collector.is_done() && meter.stopped_by() == StoppedBy::nothing;
  return {collector.count, is_complete, meter.stopped_by(), search.stats()};
}

}  // namespace
}  // namespace motion

ImpactResult time_of_impact(const MovingModel& a, const MovingModel& b, const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::time_of_impact");
  return motion::first_impact({a, b, "limber::time_of_impact"}, options);
}

ImpactResult self_time_of_impact(const MovingModel& model, const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::self_time_of_impact");
  return motion::first_impact({model, "limber::self_time_of_impact"}, options);
}

PairCount visit_impacts(const MovingModel& a, const MovingModel& b, ImpactVisitor visit, const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_impacts");
  return motion::visit_all<motion::AllImpacts>({a, b, "limber::visit_impacts"}, options, visit);
}

PairCount visit_self_impacts(const MovingModel& model, ImpactVisitor visit, const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_self_impacts");
  return motion::visit_all<motion::AllImpacts>({model, "limber::visit_self_impacts"}, options, visit);
}

PairCount visit_impact_candidates(const MovingModel& a, const MovingModel& b, ImpactCandidateVisitor visit,
                                  const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_impact_candidates");
  return motion::visit_all<motion::ImpactCandidates>({a, b, "limber::visit_impact_candidates"}, options, visit);
}

PairCount visit_self_impact_candidates(const MovingModel& model, ImpactCandidateVisitor visit,
                                       const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_self_impact_candidates");
  return motion::visit_all<motion::ImpactCandidates>({model, "limber::visit_self_impact_candidates"}, options, visit);
}

}  // namespace limber

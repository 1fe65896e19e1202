// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// The public functions of motion.h for models.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "base/check.h"
#include "base/float_environment.h"
#include "limber/contacts.h"
#include "motion/element_impact.h"
#include "motion/element_state.h"
#include "motion/impact_search.h"
#include "motion/moving_pair.h"

namespace limber {
namespace motion {
namespace {

ElementImpactOptions of_elements(const ImpactOptions& options) {
  return {options.max_time, options.time_error, options.min_separation};
}

void check_options(const ImpactOptions& options, const char* function) {
  check(of_elements(options), function);
  LIMBER_REQUIRE(options.nearer_part >= 0 && options.nearer_part < 1,
                 (std::string(function) + ": nearer_part is not from 0 to below 1").c_str());
}

/// The impact of two elements; of those that are nearer than the separation at the start, with a part of their distance
/// as separation.
ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options, double nearer_part) {
  const ElementImpact impact = impact_of(elements, options);
  if (impact.status != ImpactStatus::initial_contact || nearer_part == 0 || options.min_separation == 0) return impact;
  ElementImpactOptions nearer = options;
  nearer.min_separation = nearer_part * start_distance(elements);
  return impact_of(elements, nearer);
}

/// The earliest time, 0 or later, that is no more than an error before another.
double earliest_within(double error, double time) {
  const double earliest = std::max(0.0, time - error);
  return time - earliest > error ? std::nextafter(earliest, 1) : earliest;
}

/// The collector of time_of_impact(): the first impact, or any.
class FirstImpact {
 public:
  explicit FirstImpact(const ImpactOptions& options)
      : options_(of_elements(options)),
        nearer_part_(options.nearer_part),
        filter_(options.filter),
        any_(options.any_contact) {}

  double max_time() const { return options_.max_time; }
  bool is_done() const { return upper == 0 || (any_ && best); }
  bool wants_contacts_only() const { return options_.min_separation == 0; }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    if (filter_ && !(*filter_)(pair)) return;
    const ElementImpact impact = impact_of(elements, options_, nearer_part_);
    if (impact.status == ImpactStatus::clear) return;
    // What touches later than `lower` cannot change it. With an error it is as early as that allows, so that others
    // that touch at about the same time need not be told apart.
    lower = std::min({lower, impact.lower, earliest_within(options_.time_error, impact.upper)});
    options_.max_time = lower;
    if (best && impact.upper >= upper) return;
    upper = impact.upper, status = impact.status;
    best = IdentifiedElements{pair, elements};
  }

  ImpactStatus status = ImpactStatus::clear;
  double lower = std::numeric_limits<double>::infinity(), upper = lower;
  std::optional<IdentifiedElements> best;

 private:
  ElementImpactOptions options_;
  double nearer_part_;
  std::optional<ElementPairFilter> filter_;
  bool any_;
};

/// The collector of visit_impacts().
class AllImpacts {
 public:
  AllImpacts(const ImpactOptions& options, ImpactVisitor visit)
      : options_(of_elements(options)), nearer_part_(options.nearer_part), filter_(options.filter), visit_(visit) {}

  double max_time() const { return options_.max_time; }
  bool is_done() const { return is_stopped_; }
  bool wants_contacts_only() const { return options_.min_separation == 0; }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    if (filter_ && !(*filter_)(pair)) return;
    const ElementImpact impact = impact_of(elements, options_, nearer_part_);
    if (impact.status == ImpactStatus::clear) return;
    ++count;
    is_stopped_ = !visit_({pair, impact});
  }

  std::size_t count = 0;

 private:
  ElementImpactOptions options_;
  double nearer_part_;
  std::optional<ElementPairFilter> filter_;
  ImpactVisitor visit_;
  bool is_stopped_ = false;
};

/// The collector of visit_impact_candidates().
class ImpactCandidates {
 public:
  ImpactCandidates(const ImpactOptions& options, ImpactCandidateVisitor visit)
      : max_time_(options.max_time), filter_(options.filter), visit_(visit) {}

  double max_time() const { return max_time_; }
  bool is_done() const { return is_stopped_; }
  bool wants_contacts_only() const { return false; }

  void compare(const ElementPair& pair, const MovingElements&) {
    if (filter_ && !(*filter_)(pair)) return;
    ++count;
    is_stopped_ = !visit_(pair);
  }

  std::size_t count = 0;

 private:
  double max_time_;
  std::optional<ElementPairFilter> filter_;
  ImpactCandidateVisitor visit_;
  bool is_stopped_ = false;
};

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
  if (models.is_self()) return self_collide(*a.model);
  return collide({*a.model, a.start_pose}, {*b.model, b.start_pose}, {nullptr, options.budget});
}

ImpactResult first_touch(const MovingPair& models, const ImpactOptions& options) {
  FirstImpact collector(options);
  ImpactSearch<FirstImpact> search(models, options.min_separation, collector);
  pair::BudgetMeter meter(options.budget);
  search.run(meter);
  ImpactResult result;
  result.stats = search.stats, result.stopped_by = meter.stopped_by();
  const bool is_undecided = result.stopped_by != StoppedBy::nothing;
  result.status = is_undecided ? ImpactStatus::undecided : collector.status;
  result.lower = collector.lower, result.upper = collector.upper;
  if (is_undecided || collector.is_done()) result.lower = search.first_open_time();
  if (collector.best) set_place(models, *collector.best, result);
  return result;
}

ImpactResult first_impact(const MovingPair& models, const ImpactOptions& options) {
  if (options.ignore_crossings) return first_touch(models, options);
  const CollideResult at_start = collide_at_start(models, options);
  ImpactResult result = at_start.is_no() ? first_touch(models, options) : crossing(at_start);
  result.stats.node_tests += at_start.stats.node_tests, result.stats.primitive_tests += at_start.stats.primitive_tests;
  return result;
}

/// Visits pairs with a collector of all of them.
template <typename Collector, typename Visitor>
PairCount visit_all(const MovingPair& models, const ImpactOptions& options, Visitor visit) {
  Collector collector(options, visit);
  ImpactSearch<Collector> search(models, options.min_separation, collector);
  pair::BudgetMeter meter(options.budget);
  search.run(meter);
  const bool is_complete = !collector.is_done() && meter.stopped_by() == StoppedBy::nothing;
  return {collector.count, is_complete, meter.stopped_by(), search.stats};
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

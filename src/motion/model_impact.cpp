// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <type_traits>
#include <vector>

#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "base/span_filler.h"
#include "limber/contacts.h"
#include "limber/motion.h"
#include "motion/element_impact.h"
#include "motion/impact_search.h"
#include "motion/moving_pair.h"
#include "pair/parts.h"

namespace limber {
namespace motion {
namespace {

ElementImpactOptions of_elements(const ImpactOptions& options) {
  return {options.max_time, options.time_error, options.min_separation};
}

/// The earliest time, 0 or later, that is no more than an error before another.
double earliest_within(double error, double time) {
  const double earliest = std::max(0.0, time - error);
  return time - earliest > error ? std::nextafter(earliest, 1) : earliest;
}

/// What the collectors of impacts share.
class ImpactCollector {
 public:
  explicit ImpactCollector(const ImpactOptions& options)
      : options_(of_elements(options)), separation_fraction_(options.separation_fraction), filter_(options.filter) {}

  double max_time() const { return options_.max_time; }
  bool wants_contacts_only() const { return options_.min_separation == 0; }

 protected:
  bool counts(const ElementPair& pair) const { return !filter_ || (*filter_)(pair); }
  /// The impact of a pair, clear if it does not count; of elements that are nearer than the separation at the start,
  /// with a part of their distance as separation.
  ElementImpact impact(const ElementPair& pair, const MovingElements& elements) const {
    if (!counts(pair)) return {};
    const ElementImpact impact = impact_of(elements, options_);
    if (impact.status != ImpactStatus::initial_contact || separation_fraction_ == 0 || wants_contacts_only()) {
      return impact;
    }
    ElementImpactOptions nearer = options_;
    nearer.min_separation = separation_fraction_ * start_distance(elements);
    return impact_of(elements, nearer);
  }

  ElementImpactOptions options_;

 private:
  double separation_fraction_;
  std::optional<ElementPairFilter> filter_;
};

/// The collector of time_of_impact(): the first impact, or any.
class FirstImpact : public ImpactCollector {
 public:
  explicit FirstImpact(const ImpactOptions& options) : ImpactCollector(options), any_(options.any_contact) {}

  bool is_done() const { return upper == 0 || (any_ && best); }
  /// Whether it has found anything, given what it began as.
  bool differs_from(const FirstImpact& other) const { return lower != other.lower || upper != other.upper; }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    const ElementImpact impact = this->impact(pair, elements);
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
  bool any_;
};

/// The collector of visit_impacts(), and of visit_impact_candidates().
template <typename Pair>
class AllImpacts : public ImpactCollector {
 public:
  AllImpacts(const ImpactOptions& options, FunctionRef<bool(const Pair&)> visit)
      : ImpactCollector(options), visit_(visit) {}

  bool is_done() const { return is_stopped_; }
  bool wants_contacts_only() const { return !wants_candidates && ImpactCollector::wants_contacts_only(); }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    if constexpr (wants_candidates) {
      if (counts(pair)) ++count, is_stopped_ = !visit_(pair);
    } else {
      const ElementImpact impact = this->impact(pair, elements);
      if (impact.status != ImpactStatus::clear) ++count, is_stopped_ = !visit_({pair, impact});
    }
  }

  std::size_t count = 0;

 private:
  static constexpr bool wants_candidates = std::is_same_v<Pair, ElementPair>;

  FunctionRef<bool(const Pair&)> visit_;
  bool is_stopped_ = false;
};

/// What a search for the first impact has found.
struct FoundImpact {
  FirstImpact collector;
  double first_open_time = 0;  ///< as ImpactSearch has it at its end
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// Searches all, or a part with what the parts before it have found.
FoundImpact find_first(const MovingPair& models, const ImpactOptions& options, const SlotPair& part,
                       const FirstImpact& before) {
  FoundImpact found{before};
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<FirstImpact> search(models, options.min_separation, found.collector, meter);
  search.run(part);
  found.first_open_time = search.first_open_time(), found.stopped_by = meter.stopped_by(), found.stats = search.stats();
  return found;
}

/// The first impact on the threads of the calling arena, without limits, with the bits that one thread gives. `stats`
/// count the split and the parts whose answers count, so they do not depend on threads, but are a little more than
/// those of one thread.
///
/// Parts are searched several at a time, each as if those that are searched with it found nothing. The first one that
/// has found something makes the work of those after it void. That happens seldom: parts that touch soon come first, so
/// few make the first impact earlier. As long as none does, ever more parts are searched at once.
FoundImpact find_first_in_parts(const MovingPair& models, const ImpactOptions& options) {
  FoundImpact result{FirstImpact(options)};
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
      found[part] = find_first(models, options, parts[part], before);
      if (!found[part]->collector.differs_from(before)) return;
      std::size_t first = first_change.load(std::memory_order_relaxed);
      while (part < first && !first_change.compare_exchange_weak(first, part, std::memory_order_relaxed)) continue;
    });
    const bool has_changed = first_change < end;
    const std::size_t next = has_changed ? first_change + 1 : end;
    for (; begin < next; ++begin) result.stats += found[begin]->stats;
    result.collector = found[next - 1]->collector, result.first_open_time = found[next - 1]->first_open_time;
    at_once = has_changed ? fewest_at_once : 2 * at_once;
  }
  return result;
}

void check_options(const ImpactOptions& options, const char* function) {
  check(of_elements(options), function);
  require(options.separation_fraction >= 0 && options.separation_fraction < 1, function,
          "separation_fraction is not from 0 to below 1");
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

ImpactResult first_touch(const MovingPair& models, const ImpactOptions& options) {
  const FoundImpact found = pair::runs_in_parallel(options)
                                ? find_first_in_parts(models, options)
                                : find_first(models, options, SlotPair::roots(), FirstImpact(options));
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
template <typename Pair>
PairCount count_in_parts(const MovingPair& models, const ImpactOptions& options, FunctionRef<bool(const Pair&)> visit) {
  using Collector = AllImpacts<Pair>;
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
  result.is_complete = pair::visit_found(found, visit, result.count);
  return result;
}

/// Visits pairs with a collector of all of them.
template <typename Pair>
PairCount visit_all(const MovingPair& models, const ImpactOptions& options, FunctionRef<bool(const Pair&)> visit) {
  if (pair::runs_in_parallel(options)) return count_in_parts<Pair>(models, options, visit);
  AllImpacts<Pair> collector(options, visit);
  pair::BudgetMeter meter(options.budget);
  ImpactSearch<AllImpacts<Pair>> search(models, options.min_separation, collector, meter);
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
  return motion::visit_all({a, b, "limber::visit_impacts"}, options, visit);
}

PairCount visit_self_impacts(const MovingModel& model, ImpactVisitor visit, const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_self_impacts");
  return motion::visit_all({model, "limber::visit_self_impacts"}, options, visit);
}

PairCount visit_impact_candidates(const MovingModel& a, const MovingModel& b, ImpactCandidateVisitor visit,
                                  const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_impact_candidates");
  return motion::visit_all({a, b, "limber::visit_impact_candidates"}, options, visit);
}

PairCount visit_self_impact_candidates(const MovingModel& model, ImpactCandidateVisitor visit,
                                       const ImpactOptions& options) {
  const base::DefaultFloatEnvironment environment;
  motion::check_options(options, "limber::visit_self_impact_candidates");
  return motion::visit_all({model, "limber::visit_self_impact_candidates"}, options, visit);
}

}  // namespace limber

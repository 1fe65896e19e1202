// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>

#include "limber/motion.h"
#include "motion/element_impact.h"
#include "motion/element_state.h"
#include "motion/moving_pair.h"

namespace limber::motion {

inline ElementImpactOptions of_elements(const ImpactOptions& options) {
  return {options.max_time, options.time_error, options.min_separation};
}

/// The impact of two elements; of those that are nearer than the separation at the start, with a part of their distance
/// as separation.
inline ElementImpact impact_of(const MovingElements& elements, const ElementImpactOptions& options,
                               double separation_fraction) {
  const ElementImpact impact = impact_of(elements, options);
  if (impact.status != ImpactStatus::initial_contact || separation_fraction == 0 || options.min_separation == 0)
    return impact;
  ElementImpactOptions nearer = options;
  nearer.min_separation = separation_fraction * start_distance(elements);
  return impact_of(elements, nearer);
}

/// The earliest time, 0 or later, that is no more than an error before another.
inline double earliest_within(double error, double time) {
  const double earliest = std::max(0.0, time - error);
  return time - earliest > error ? std::nextafter(earliest, 1) : earliest;
}

/// The collector of time_of_impact(): the first impact, or any.
class FirstImpact {
 public:
  explicit FirstImpact(const ImpactOptions& options)
      : options_(of_elements(options)),
        separation_fraction_(options.separation_fraction),
        filter_(options.filter),
        any_(options.any_contact) {}

  double max_time() const { return options_.max_time; }
  bool is_done() const { return upper == 0 || (any_ && best); }
  bool wants_contacts_only() const { return options_.min_separation == 0; }
  /// Whether it has found anything, given what it began as.
  bool differs_from(const FirstImpact& other) const { return lower != other.lower || upper != other.upper; }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    if (filter_ && !(*filter_)(pair)) return;
    const ElementImpact impact = impact_of(elements, options_, separation_fraction_);
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
  double separation_fraction_;
  std::optional<ElementPairFilter> filter_;
  bool any_;
};

/// The collector of visit_impacts().
class AllImpacts {
 public:
  AllImpacts(const ImpactOptions& options, ImpactVisitor visit)
      : options_(of_elements(options)),
        separation_fraction_(options.separation_fraction),
        filter_(options.filter),
        visit_(visit) {}

  double max_time() const { return options_.max_time; }
  bool is_done() const { return is_stopped_; }
  bool wants_contacts_only() const { return options_.min_separation == 0; }

  void compare(const ElementPair& pair, const MovingElements& elements) {
    if (filter_ && !(*filter_)(pair)) return;
    const ElementImpact impact = impact_of(elements, options_, separation_fraction_);
    if (impact.status == ImpactStatus::clear) return;
    ++count;
    is_stopped_ = !visit_({pair, impact});
  }

  std::size_t count = 0;

 private:
  ElementImpactOptions options_;
  double separation_fraction_;
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

}  // namespace limber::motion

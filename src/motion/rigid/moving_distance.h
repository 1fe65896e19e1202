// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "limber/gradients.h"
#include "limber/path.h"
#include "motion/rigid/shadow.h"
#include "pair/budget_meter.h"

namespace limber::motion {

/// Returns how two bodies move, or null where their paths are no motions.
using FindMotions = FunctionRef<const MovingBodies*()>;

/// Distances of two models at times on their paths, until the budget is spent.
class MovingDistance {
 public:
  /// Motions are asked for only where a shadow may pay.
  MovingDistance(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b, double speed,
                 const PathOptions& options, FindMotions motions)
      : a_(a),
        b_(b),
        path_a_(path_a),
        path_b_(path_b),
        options_(options),
        speed_(speed),
        motions_(motions),
        meter_(options.budget) {}

  /// The distance at a time. Nothing if the budget does not allow another one.
  std::optional<DistanceResult> at(double time, const DistanceOptions& errors_and_limit) {
    // Distances that take a step or two do not look at the clock themselves.
    if (stopped_by == StoppedBy::nothing && meter_.is_spent(count)) stopped_by = meter_.stopped_by();
    if (stopped_by != StoppedBy::nothing) return std::nullopt;
    DistanceOptions wanted = errors_and_limit;
    wanted.cache = options_.cache, wanted.budget = options_.budget;
    wanted.budget.max_steps = std::numeric_limits<std::uint64_t>::max();
    const DistanceResult found = distance(Placed(a_, path_a_.pose(time)), Placed(b_, path_b_.pose(time)), wanted);
    ++count, stats += found.stats;
    stopped_by = found.stopped_by;
    work_ += static_cast<double>(found.stats.node_tests + 4 * found.stats.primitive_tests);
    return found;
  }

  /// A time up to which the bodies are certainly farther apart than a distance, which they exceed by a gap at `time`.
  /// Just that time, unless shadows may spare many distances until `end`.
  double apart_until(double time, double end, double distance, double gap) {
    const auto spared_until = [&](double until) { return (until - time) / time_for(gap); };
    if (!is_worth_a_shadow(spared_until(end))) return time;
    const MovingBodies* const bodies = motions_();
    if (bodies == nullptr) return learn(0), time;
    const Shadow shadow(*bodies, time, 0.5 * gap / (end - time));
    if (shadow.speed() > 0.25 * speed_) return learn(0), time;
    const double needed = shadow.speed() * (end - time);
    const double limit = distance + 1.1 * needed + 0.1 * gap + a_.radius() + b_.radius();
    const double lower = distance_of(shadow, {.relative_error = 0.1, .max_distance = limit});
    const double until = std::max(time, time + base::inward * (lower - distance) / shadow.speed() - 0x1p-52);
    learn(spared_until(until));
    return until;
  }

  /// A lower bound of the distance at all times up to `end`. A shadow gives it, to within about the error where bodies
  /// pass each other at one distance. It is 0 where no shadow is likely to spare many distances.
  double least_until(double end, double error) {
    if (work_ < 2 * work_of_shadow() || !is_worth_a_shadow(most_in(end) / error)) return 0;
    next_shadow_ = 4 * work_;
    const MovingBodies* const bodies = motions_();
    if (bodies == nullptr) return 0;
    const Shadow shadow(*bodies, 0.5 * end, error / end);
    if (0.5 * end * shadow.speed() > error) return 0;
    return std::max(0.0, distance_of(shadow, {.absolute_error = 0.5 * error}) - shadow.speed() * 0.5 * end);
  }

  /// The normal of what is found at a time.
  Vec3 normal_at(double time, const Witness& witness) const {
    return contact_of(Placed(a_, path_a_.pose(time)), Placed(b_, path_b_.pose(time)), witness).normal;
  }

  /// How long the models are certainly apart by more than a gap that is given, rounded down. Infinite if they stand.
  double time_for(double gap) const { return base::inward * gap / speed_; }
  double most_in(double time) const { return speed_ * time / base::inward; }
  double speed() const { return speed_; }
  /// The error that the options allow; if they leave it open, a part of a length. As PathOptions says.
  double error_or(double part, double length) const {
    return std::max(
        {options_.distance_error.value_or(part * length), 0x1p-40 * speed_, std::numeric_limits<double>::min()});
  }
  double radii() const { return radius_of(a_) + radius_of(b_); }

  std::uint64_t count = 0;
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};

 private:
  static double radius_of(const Body& body) { return body.model().bounding_sphere().radius + body.radius(); }

  /// Whether a shadow is likely to take less work than a number of distances. Only once distances have taken about as
  /// much: most queries need few.
  bool is_worth_a_shadow(double distances) const {
    if (work_ < next_shadow_ || count >= options_.budget.max_steps) return false;
    return distances * work_ > 2 * work_of_shadow() * static_cast<double>(count) && has_time_for_shadow();
  }
  /// A shadow is not left half built when the deadline passes.
  bool has_time_for_shadow() const {
    const std::chrono::nanoseconds needed(static_cast<std::int64_t>(2e4 + 2e3 * triangle_count()));
    return !options_.budget.deadline || std::chrono::steady_clock::now() + needed < *options_.budget.deadline;
  }
  void learn(double spared) {
    const bool was_worth_it = spared * work_ > work_of_shadow() * static_cast<double>(count);
    next_shadow_ = was_worth_it ? work_ + 0.5 * work_of_shadow() : 4 * work_;
  }
  /// To map a triangle and build a model of it takes as long as some tests of nodes; two models of few triangles take
  /// as long as hundreds.
  double work_of_shadow() const { return 600 + 8 * triangle_count(); }
  double triangle_count() const {
    return static_cast<double>(a_.model().mesh().triangles().size() + b_.model().mesh().triangles().size());
  }
  /// A lower bound of the distance of the bodies, as a shadow shows it.
  double distance_of(const Shadow& shadow, DistanceOptions wanted) {
    wanted.budget = options_.budget;
    wanted.budget.max_steps = std::numeric_limits<std::uint64_t>::max();
    ++count;
    return shadow.distance(wanted, stats).value_or(0) - a_.radius() - b_.radius();
  }

  Body a_, b_;
  const RigidPath &path_a_, &path_b_;
  const PathOptions& options_;
  double speed_;
  FindMotions motions_;
  pair::BudgetMeter meter_;
  double work_ = 0;  // of distances, in tests of nodes and triangles
  double next_shadow_ = 0.5 * work_of_shadow();
};

}  // namespace limber::motion

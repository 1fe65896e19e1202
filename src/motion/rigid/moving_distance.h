// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/error_bounds.h"
#include "limber/gradients.h"
#include "limber/path.h"
#include "pair/budget_meter.h"

/// Functions that queries of two moving bodies share with the sweep of one body through a scene.
namespace limber::motion {

/// Throws   std::invalid_argument, naming the function, unless the options are what their comments say.
void check_path_options(const PathOptions& options, const char* function);
void check_speed(double speed, const char* function);

/// How fast the points of a body's core move at most. A ball around a point of the core moves as that point does.
double speed_of(const Body& body, const RigidMotion& motion);

/// time_of_impact() of a body on a path and one that stands still, of which it is known that they do not touch before
/// a time.
///
/// Pre      The options and the speed are what they have to be, and `begin` is at most options.max_time. The motion is
///          null, or that of the path.
PathImpact first_impact(const Body& body, const RigidPath& path, const RigidMotion* motion, const Placed& standing,
                        double begin, const PathOptions& options);

/// Two bodies and how they move. Refers to the motions.
struct MovingBodies {
  Body a;
  const RigidMotion& motion_a;
  Body b;
  const RigidMotion& motion_b;
};

/// How fast the points of a body's core move as seen from the body's center, which turns about itself.
double turning_speed(const Body& body, const RigidMotion& motion);

/// Shadows of two bodies: their images under a map that makes no distance longer, and their relative motion shorter. So
/// the distance of the shadows at one time shows for long that the bodies stay apart, however closely they pass each
/// other: it changes as fast as they approach, not as fast as they move.
///
/// The map shortens straight motion along itself. Or, about the axis of a body that turns, it takes each point to its
/// distance from the axis and its place along it, which turning does not change; what moves along it is shortened.
class Shadow {
 public:
  /// Chooses the map that leaves least of the motion. Of straight motion it leaves at most the speed that is given.
  ///
  /// Pre      0 <= time <= 1, and the speed is above 0.
  /// Alias    Keeps a pointer to the bodies.
  Shadow(const MovingBodies& bodies, double time, double straight_speed);

  /// The distance of the shadows changes by at most so much in a unit of time, before the time and after.
  double speed() const { return speed_; }

  /// A lower bound of the distance of the shadows of both cores at the time, and so of the cores. Nothing where
  /// coordinates are too large or too small for it.
  ///
  /// Throws   As distance(); std::bad_alloc.
  /// Cost     Two models are built: of as many triangles, or of up to four times as many if seen about an axis.
  std::optional<double> distance(const DistanceOptions& options, QueryStats& stats) const;

 private:
  /// Maps about an axis, or along one, if that leaves less of the motion.
  void prefer(bool is_about_axis, const Vec3& origin, const Vec3& axis, double others_speed, double straight_speed);
  std::optional<Model> image(const Body& body, const Transform& pose, double& size) const;

  const MovingBodies* bodies_;
  double time_;
  Vec3 straight_;  ///< the motion of b's center relative to a's
  double speed_ = std::numeric_limits<double>::infinity();
  bool is_about_axis_ = false;
  Vec3 origin_, axis_;
  double shortened_ = 1;  ///< what is left of a length along the axis, as a part of it
};

/// Returns how two bodies move, or null where their paths are no motions.
using FindMotions = FunctionRef<const MovingBodies*()>;

/// Distances of two models at times on their paths, until the budget is spent.
class MovingDistance {
 public:
  /// Motions are asked for only where a shadow may pay.
  MovingDistance(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b, double speed,
                 const PathOptions& options, FindMotions motions)
      : a_(a), b_(b), path_a_(path_a), path_b_(path_b), options_(options), speed_(speed), motions_(motions) {}

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
    std::optional<Shadow> shadow;
    if (const MovingBodies* bodies = motions_()) shadow.emplace(*bodies, time, 0.5 * gap / (end - time));
    if (!shadow || shadow->speed() > 0.25 * speed_) {
      learn(0);
      return time;
    }
    const double needed = shadow->speed() * (end - time);
    const double limit = distance + 1.1 * needed + 0.1 * gap + a_.radius() + b_.radius();
    const double lower = distance_of(*shadow, {.relative_error = 0.1, .max_distance = limit});
    const double until = std::max(time, time + base::inward * (lower - distance) / shadow->speed() - 0x1p-52);
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
  pair::BudgetMeter meter_{options_.budget};
  double work_ = 0;  // of distances, in tests of nodes and triangles
  double next_shadow_ = 0.5 * work_of_shadow();
};

}  // namespace limber::motion

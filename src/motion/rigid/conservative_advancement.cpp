// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of two bodies on paths. Both ask for distances at a few times, and know that the distance changes by at most
// `speed` times the time in between. So a distance says something of the time before and after it (MovingDistance).
//   time_of_impact()  is conservative advancement: distances show the time to be free of contact, piece by piece.
//   min_distance()    is branch and bound over pieces of time: the piece with the least lower bound is split next.
// Bodies that pass each other closely take many distances; shadows (moving_distance.h) spare most of them.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

#include "base/arguments.h"
#include "base/check.h"
#include "base/error_bounds.h"
#include "base/float_environment.h"
#include "limber/path.h"
#include "motion/element_impact.h"
#include "motion/rigid/moving_distance.h"
#include "pair/pair_walk.h"

namespace limber {
namespace motion {
namespace {

/// The gap at a time: by how much the distance exceeds the separation.
struct Gap {
  double time, size;
};

/// When to ask for the next distance: where the time that it shows to be free will reach back to what the last one
/// showed. With a gap g that closes at a rate c that is x later, where x = g / speed + (g - c x) / speed. The rate is a
/// guess, on which no answer depends: that since the last gap, or a quarter of the way to the worst, `speed`. Where the
/// gap grows, c >= -0.9 speed makes the step at most 20 times as long as what is proved.
double next_time(const MovingDistance& moving, const Gap& earlier, const Gap& gap) {
  const double speed = moving.speed();
  const double rate = earlier.time < gap.time ? (earlier.size - gap.size) / (gap.time - earlier.time) : speed;
  const double expected_rate = std::clamp(rate + 0.25 * (speed - rate), -0.9 * speed, speed);
  return gap.time + 2 * gap.size / (speed + expected_rate);
}

// What PathOptions says of errors that it leaves open, as a part of the radii.
constexpr double default_impact_error = 0x1p-20, default_least_error = 0x1p-10;

/// The first impact not before `begin`, before which nothing touches. A distance shows that some time after it is free,
/// and as much before it. So the next one is asked for beyond what is free, as in [KeinertEtAl2014]. If that does not
/// reach back, or the models touch there, the next one is asked for where the free time ends, as in plain advancement.
PathImpact advance_to_impact(MovingDistance& moving, double begin, const PathOptions& options) {
  struct Interval {
    double begin, end;
  };
  constexpr double after_all = 2;  // no path takes longer than 1
  const double error = moving.error_or(default_impact_error, moving.radii());
  const double separation = options.min_separation, touching = separation + error;
  PathImpact result;
  const auto finish = [&](ImpactStatus status, double time) {
    result.status = status, result.time = time;
    result.distance_count = moving.count, result.stats = moving.stats;
    if (status == ImpactStatus::undecided) result.stopped_by = moving.stopped_by;
    if (result.witness) result.normal = moving.normal_at(time, *result.witness);
    return result;
  };
  // Nothing touches in [begin, free_until), nor in `ahead`; a hole may be left between them. What is later than `end`
  // does not matter. If there is a witness, the models touch at `end`. `time` is in [free_until, end].
  double free_until = begin, end = options.max_time;
  Interval ahead{after_all, after_all};
  Gap earlier{begin, 0};
  for (double time = begin; free_until <= end;) {
    // Without a separation a tenth of the distance is exact enough to go on; with one, a tenth of the last gap.
    const double limit = (touching + moving.most_in(options.max_time - time)) * base::outward;
    const double relative = separation == 0 ? 0.1 : 0, absolute = std::max(0.25 * error, 0.1 * earlier.size);
    DistanceOptions errors{relative, absolute, limit};
    std::optional<DistanceResult> found = moving.at(time, errors);
    // Asked again, what does not touch has a gap of 3/4 of the error or more: so time goes on.
    if (found && found->upper > touching && found->lower <= separation + 0.5 * error) {
      errors.relative_error = 0, errors.absolute_error = 0.25 * error;
      found = moving.at(time, errors);
    }
    if (found && found->upper <= touching) {
      result.witness = found->witness, end = time;
      if (time <= free_until) break;
      time = free_until;
      continue;
    }
    if (moving.stopped_by != StoppedBy::nothing) {
      result.witness.reset();
      return finish(ImpactStatus::undecided, free_until);
    }
    LIMBER_ASSERT(found->lower > separation + 0.5 * error);
    const Gap gap{time, found->lower - separation};
    const double reach = moving.time_for(gap.size) - 0x1p-52;  // the ends are rounded
    LIMBER_ASSERT(reach > 0);                                  // as the error is at least 2^-40 of the speed
    const Interval around{time - reach, found->status == DistanceStatus::beyond_limit ? after_all : time + reach};
    if (around.begin > free_until) {  // not connected yet: remember it, and fill the hole
      ahead = around, time = free_until;
      continue;
    }
    free_until = std::max(free_until, around.end);
    if (ahead.begin <= free_until) free_until = std::max(free_until, ahead.end);
    if (free_until < end) free_until = std::max(free_until, moving.apart_until(time, end, separation, gap.size));
    time = result.witness ? free_until : std::max(free_until, std::min(next_time(moving, earlier, gap), end));
    earlier = gap;
  }
  if (!result.witness) return finish(ImpactStatus::clear, std::numeric_limits<double>::infinity());
  return finish(end == 0 ? ImpactStatus::initial_contact : ImpactStatus::contact, end);
}

/// A piece of time, and lower bounds of the distances at its ends and in between.
struct Piece {
  double begin, end, at_begin, at_end, bound;

  // Both halves of a piece have the same bound, but for rounding.
  bool comes_before(const Piece& p) const { return bound != p.bound ? bound < p.bound : begin < p.begin; }
};

/// The least distance of all times.
PathDistance nearest(MovingDistance& moving, const PathOptions& options) {
  PathDistance result;
  // A smaller error costs more distances: as one over its root, where bodies pass each other.
  const double radii = moving.radii();
  const auto error = [&] { return moving.error_or(default_least_error, std::max(radii, result.upper)); };
  const DistanceOptions errors{0, 0.25 * moving.error_or(default_least_error, radii)};
  const auto lower_at = [&](double time) -> std::optional<double> {
    const std::optional<DistanceResult> found = moving.at(time, errors);
    if (!found) return std::nullopt;
    if (found->upper < result.upper) {
      result.upper = found->upper, result.time = time, result.witness = found->witness;
    }
    return found->lower;
  };
  const auto piece = [&](double begin, double end, double at_begin, double at_end) {
    return Piece{begin, end, at_begin, at_end, std::max(0.0, 0.5 * (at_begin + at_end - moving.most_in(end - begin)))};
  };
  double least = 0;  // a lower bound for all times
  pair::HeapOrder<Piece> pieces;
  const std::optional<double> first = lower_at(0), last = first ? lower_at(options.max_time) : first;
  if (first && last) pieces.push(piece(0, options.max_time, *first, *last));
  // A budget that is spent leaves loose bounds, even of a single time: halving makes them no better.
  const auto goes_on = [&] { return moving.stopped_by == StoppedBy::nothing && !pieces.empty(); };
  while (goes_on() && result.upper - std::max(pieces.next().bound, least) > error()) {
    least = std::max(least, moving.least_until(options.max_time, 0.5 * error()));
    const Piece p = pieces.next();
    LIMBER_ASSERT(p.begin <= p.end && p.bound >= 0);
    // Where the bounds from both ends meet.
    const double meets = p.begin + 0.5 * (p.end - p.begin) + 0.5 * (moving.time_for(p.at_begin - p.at_end));
    const double middle = std::clamp(meets, p.begin, p.end);
    if (!(p.begin < middle && middle < p.end)) break;  // nothing moves in so short a time
    const std::optional<double> there = lower_at(middle);
    if (!there) break;  // the budget is spent
    pieces.take();
    pieces.push(piece(p.begin, middle, p.at_begin, *there));
    pieces.push(piece(middle, p.end, *there, p.at_end));
  }
  result.lower = pieces.empty() ? 0 : std::min(std::max(pieces.next().bound, least), result.upper);
  result.distance_count = moving.count, result.stopped_by = moving.stopped_by, result.stats = moving.stats;
  return result;
}

/// How fast the cores of two bodies move relative to each other at most: the centers move straight, each body turns.
double relative_speed(const Body& a, const RigidMotion& motion_a, const Body& b, const RigidMotion& motion_b) {
  const double straight = length(motion_b.displacement() - motion_a.displacement());
  return (straight + turning_speed(a, motion_a) + turning_speed(b, motion_b)) * base::outward;
}

constexpr auto impact_on_whole_way = [](MovingDistance& moving, const PathOptions& options) {
  return advance_to_impact(moving, 0, options);
};

constexpr auto no_motions = []() -> const MovingBodies* { return nullptr; };

/// What the public queries have in common: checks the arguments, and asks `question`, which is impact_on_whole_way() or
/// nearest(). `motions` says how the bodies move where the paths are motions.
template <auto question>
auto ask(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b, const PathOptions& options,
         const char* function, double speed, FindMotions motions = no_motions) {
  check_path_options(options, function);
  check_speed(path_a.speed, function);
  check_speed(path_b.speed, function);
  require(std::isfinite(speed), function, "the sum of both speeds must be finite");
  MovingDistance moving(a, path_a, b, path_b, speed, options, motions);
  return question(moving, options);
}

template <auto question>
auto ask(const Body& a, const RigidMotion& motion_a, const Body& b, const RigidMotion& motion_b,
         const PathOptions& options, const char* function) {
  const auto pose_a = [&](double time) { return motion_a.at(time); };
  const auto pose_b = [&](double time) { return motion_b.at(time); };
  const MovingBodies bodies{a, motion_a, b, motion_b};
  return ask<question>(a, RigidPath{pose_a}, b, RigidPath{pose_b}, options, function,
                       relative_speed(a, motion_a, b, motion_b), [&] { return &bodies; });
}

}  // namespace

void check_path_options(const PathOptions& options, const char* function) {
  require(options.max_time >= 0 && options.max_time <= 1, function, "max_time is not in [0, 1]");
  require(base::is_finite_and_not_negative(options.min_separation), function,
          "min_separation must be finite and at least 0");
  require(base::is_finite_and_not_negative(options.distance_error.value_or(0)), function,
          "distance_error must be finite and at least 0");
}

void check_speed(double speed, const char* function) {
  require(base::is_finite_and_not_negative(speed), function, "the speed of a path must be finite and at least 0");
}

double speed_of(const Body& body, const RigidMotion& motion) {
  return (length(motion.displacement()) + turning_speed(body, motion)) * base::outward;
}

PathImpact first_impact(const Body& body, const RigidPath& path, const RigidMotion* motion, const Placed& standing,
                        double begin, const PathOptions& options) {
  const auto stands = [&](double) { return standing.pose; };
  const RigidPath path_of_standing{stands};
  std::optional<RigidMotion> still;
  std::optional<MovingBodies> bodies;
  const auto motions = [&]() -> const MovingBodies* {
    if (motion == nullptr) return nullptr;
    if (!still) still.emplace(standing.pose);
    if (still->start() != standing.pose) return nullptr;  // not exactly a rotation: RigidMotion has moved it
    if (!bodies) bodies.emplace(MovingBodies{body, *motion, standing.body(), *still});
    return &*bodies;
  };
  MovingDistance moving(body, path, standing.body(), path_of_standing, path.speed, options, motions);
  return advance_to_impact(moving, begin, options);
}

}  // namespace motion

PathImpact time_of_impact(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b,
                          const PathOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return motion::ask<motion::impact_on_whole_way>(a, path_a, b, path_b, options, "limber::time_of_impact",
                                                  path_a.speed + path_b.speed);
}

PathImpact time_of_impact(const Body& a, const RigidMotion& motion_a, const Body& b, const RigidMotion& motion_b,
                          const PathOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return motion::ask<motion::impact_on_whole_way>(a, motion_a, b, motion_b, options, "limber::time_of_impact");
}

PathDistance min_distance(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b,
                          const PathOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return motion::ask<motion::nearest>(a, path_a, b, path_b, options, "limber::min_distance",
                                      path_a.speed + path_b.speed);
}

PathDistance min_distance(const Body& a, const RigidMotion& motion_a, const Body& b, const RigidMotion& motion_b,
                          const PathOptions& options) {
  const base::DefaultFloatEnvironment environment;
  return motion::ask<motion::nearest>(a, motion_a, b, motion_b, options, "limber::min_distance");
}

}  // namespace limber

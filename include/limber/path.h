// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "limber/distance.h"
#include "limber/geometry.h"
#include "limber/math.h"
#include "limber/model.h"
#include "limber/motion.h"

/// Models, shapes and solids that move as rigid bodies along a path: when they come too near to each other first, and
/// how near they come. Time goes from 0 to 1. Vertices that move by themselves are a matter of motion.h.
///
/// Answers come from distances at some times, and from how fast points can move in between. So they are certified for
/// any path whose speed is known, however it turns.
///
/// Threads  Every function is reentrant; any number of calls may share models.
namespace limber {

/// The motion of a rigid body from one pose to another: a point of it, the center, moves straight at constant speed,
/// and the body turns about it at constant rate about one axis, the shorter way round.
///
/// Use      Sweeps and steps of one body that moves freely. A link of an arm does not move so while joints turn:
///          for an edge in joint space, bounds of this motion do not hold. See "Edges of a planner" in
///          docs/guide/motion.md.
/// Frame    The poses map from the model's frame to the world; the center is in the model's frame.
/// Promise  A rotation that is off by more than 10^-14, as is_rigid() allows, is replaced by the nearest one without
///          error, at the start and the end too.
class RigidMotion {
 public:
  /// Stands still at a pose.
  RigidMotion(const Transform& pose = {}) : RigidMotion(pose, pose) {}
  /// Throws   std::invalid_argument unless both poses are rigid and the center is finite and at most `max_coordinate`.
  LIMBER_API RigidMotion(const Transform& start, const Transform& end, const Vec3& center = {});

  /// A screw: the center is on the axis about which the body turns and along which it moves, where that is nearest to
  /// the model's origin at the start. Where nothing turns, as the constructor.
  ///
  /// Throws   As the constructor.
  [[nodiscard]] LIMBER_API static RigidMotion screw(const Transform& start, const Transform& end);

  /// The pose at a time; exactly that of the start and of the end at 0 and 1.
  ///
  /// Throws   std::invalid_argument unless the time is from 0 to 1.
  [[nodiscard]] LIMBER_API Transform at(double time) const;

  /// From where the center is at the start to where it is at the end, in the world.
  const Vec3& displacement() const { return displacement_; }

  /// An upper bound of the speed of a point that is at most `radius` away from the center.
  [[nodiscard]] LIMBER_API double speed(double radius) const;

  const Transform& start() const { return start_; }
  const Transform& end() const { return end_; }
  const Vec3& center() const { return center_; }
  /// About which it turns, in the world: of length 1, or 0 if nothing turns.
  const Vec3& axis() const { return axis_; }

 private:
  Transform start_, end_;
  Vec3 center_, displacement_, axis_;
  double angle_;
};

/// Any path: the pose at each time from 0 to 1, and an upper bound of the speed of every point of the model on it.
///
/// Alias    Refers to the function, which must live until the query returns.
struct RigidPath {
  FunctionRef<Transform(double)> pose;
  double speed = 0;  ///< finite and >= 0; lengths per unit of time
};

struct PathOptions {
  double max_time = 1;        ///< from 0 to 1
  double min_separation = 0;  ///< models that are this far apart, or less, touch; finite and >= 0
  /// How much more than the separation may count as touching, and how far off a least distance may be: finite and >= 0.
  /// Without one it is a part of the radii of spheres around both bodies, taken together: 2^-20 for what touches, 2^-10
  /// for a least distance, or of that distance if it is larger. Never less than what moves in 2^-40 of the time: 0 asks
  /// for that, and bodies that pass each other closely then may take very many distances.
  std::optional<double> distance_error = std::nullopt;
  QueryCache* cache = nullptr;  ///< as in QueryOptions
  QueryBudget budget = {};      ///< when the query has to end; `max_steps` counts distances
};

/// When two models come too near to each other first.
struct [[nodiscard]] PathImpact {
  ImpactStatus status = ImpactStatus::undecided;
  /// They are farther apart than the separation before `time`. For `contact` and `initial_contact` they are at most
  /// distance_error farther apart at `time`. Infinite for `clear`.
  double time = 0;
  std::optional<Witness> witness;  ///< the closest points at `time`, if they touch; any so near if the budget is spent
  Vec3 normal;                     ///< that of contact_of() for the witness (gradients.h), from a to b; 0 without one
  std::uint64_t distance_count = 0;  ///< how many distances were asked for
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// The first time at which two models that move are within a separation of each other. What crosses is found, however
/// thin it is. A path that only just passes may count as a contact, by distance_error.
///
/// Promise  As the comments of PathImpact say, up to the rounding of distances (distance.h).
/// Throws   std::invalid_argument unless both models are committed, the options are what their comments say and poses
///          are rigid; whatever the functions of a path throw; std::bad_alloc for a RigidMotion.
/// Cost     Conservative advancement: a distance for each part of the way that is certainly free. 3 to 30 for paths
///          that hit or miss. Where a RigidMotion passes by closely for long, straight or about an axis, models of the
///          bodies as seen along it are built, at O(n log n), and their distances are counted as well. A RigidPath
///          takes a distance for each gap that it goes.
/// Budget   If it is spent first, the status is `undecided`, and nothing touches before `time`.
/// Source   [Mirtich1996], [KeinertEtAl2014], with certified lower bounds of distances, and shadows;
///          docs/algorithms/impact.md, "Rigid bodies".
LIMBER_API PathImpact time_of_impact(const Body& a, const RigidMotion& motion_a, const Body& b,
                                     const RigidMotion& motion_b, const PathOptions& options = {});
LIMBER_API PathImpact time_of_impact(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b,
                                     const PathOptions& options = {});

/// How near two models come to each other on their way.
struct [[nodiscard]] PathDistance {
  double lower = 0;                                        ///< no nearer than this at any time up to max_time
  double upper = std::numeric_limits<double>::infinity();  ///< at most so far apart at `time`
  double time = 0;
  std::optional<Witness> witness;    ///< the closest points at `time`
  std::uint64_t distance_count = 0;  ///< how many distances were asked for
  StoppedBy stopped_by = StoppedBy::nothing;
  QueryStats stats{};
};

/// The least distance of two models up to max_time, and when they are so near. `min_separation` makes no difference.
///
/// Promise  lower <= least distance <= upper, up to the rounding of distances; upper - lower <= distance_error, unless
///          the budget was spent.
/// Throws   As time_of_impact(); std::bad_alloc.
/// Cost     A distance for each piece of time that the speed cannot exclude: 10 to some 100 by default. In proportion
///          to the inverse root of the error, where the distance is least in passing.
/// Source   [Piyavskii1972].
LIMBER_API PathDistance min_distance(const Body& a, const RigidMotion& motion_a, const Body& b,
                                     const RigidMotion& motion_b, const PathOptions& options = {});
LIMBER_API PathDistance min_distance(const Body& a, const RigidPath& path_a, const Body& b, const RigidPath& path_b,
                                     const PathOptions& options = {});

}  // namespace limber

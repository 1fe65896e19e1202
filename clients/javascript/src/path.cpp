// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/path.h"

#include <algorithm>

#include "bindings.h"
#include "limber/model.h"

namespace limber::web {
namespace {

/// Null stands for a body that stays where its model is.
RigidMotion motion_from(const RigidMotion* motion) { return motion != nullptr ? *motion : RigidMotion(); }

/// The time, and how many distances were asked for, behind what give() writes.
void give_time(double time, std::uint64_t distances) {
  exchange.numbers[10] = time, exchange.numbers[11] = static_cast<double>(distances);
}

}  // namespace

void give(const PathImpact& impact) {
  give(impact.witness, impact.stats, static_cast<std::uint32_t>(impact.status), impact.stopped_by);
  give_time(impact.time, impact.distance_count);
  double* normal = exchange.numbers + 12;
  put(normal, impact.normal);
}

LIMBER_EXPORT(newRigidMotion)
RigidMotion* new_rigid_motion(PoseForm start, PoseForm end, double x, double y, double z) {
  RigidMotion* motion = nullptr;
  guarded([&] { motion = new RigidMotion(pose_from(start, 0, "start"), pose_from(end, 1, "end"), {x, y, z}); });
  return motion;
}
LIMBER_EXPORT(deleteRigidMotion) void delete_rigid_motion(RigidMotion* motion) { delete motion; }

/// Makes it the screw between the same poses.
LIMBER_EXPORT(makeScrew) bool make_screw(RigidMotion* motion) {
  return guarded([&] { *motion = RigidMotion::screw(motion->start(), motion->end()); });
}

/// The 4 x 4 matrix at a time, by columns.
LIMBER_EXPORT(poseAt) bool pose_at(const RigidMotion* motion, double time) {
  return guarded([&] {
    const auto matrix = matrix_of(motion->at(time), MatrixOrder::column_major);
    std::copy(matrix.begin(), matrix.end(), exchange.numbers);
  });
}

LIMBER_EXPORT(pathImpact)
bool exported_path_impact(const BodyOwner* a, const RigidMotion* motion_a, const BodyOwner* b,
                          const RigidMotion* motion_b, double max_time, double min_separation, bool has_error,
                          double distance_error, double deadline_ms, double max_steps, QueryCache* cache) {
  return guarded([&] {
    const PathOptions options{max_time, min_separation, error_from(has_error, distance_error), cache,
                              budget_from(deadline_ms, max_steps)};
    const PathImpact found =
        time_of_impact(a->body(), motion_from(motion_a), b->body(), motion_from(motion_b), options);
    give(found);
  });
}

LIMBER_EXPORT(minDistance)
bool exported_min_distance(const BodyOwner* a, const RigidMotion* motion_a, const BodyOwner* b,
                           const RigidMotion* motion_b, double max_time, bool has_error, double distance_error,
                           double deadline_ms, double max_steps, QueryCache* cache) {
  return guarded([&] {
    const PathOptions options{max_time, 0, error_from(has_error, distance_error), cache,
                              budget_from(deadline_ms, max_steps)};
    const PathDistance found =
        min_distance(a->body(), motion_from(motion_a), b->body(), motion_from(motion_b), options);
    give(found.witness, found.stats, 0, found.stopped_by);
    exchange.numbers[0] = found.lower, exchange.numbers[1] = found.upper;
    give_time(found.time, found.distance_count);
  });
}

}  // namespace limber::web

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// When models whose vertices move, and rigid bodies, touch first.
#include "limber/motion.h"

#include <algorithm>

#include "bindings.h"
#include "limber/path.h"

namespace limber::web {
namespace {

using Moving = Owned<MovingModel>;
using Motion = Owned<RigidMotion>;

/// Null stands for a body that stays where its model is.
RigidMotion motion_from(const RigidMotion* motion) { return motion != nullptr ? *motion : RigidMotion(); }

}  // namespace

LIMBER_EXPORT(newMovingModel) Moving* new_moving_model(const OwnedModel* model) {
  return made([&] { return new Moving(static_cast<const Model&>(*model)); });
}

/// To the positions in input().
LIMBER_EXPORT(setMotion)
bool set_motion(Moving* model, std::size_t count, bool is_float32, PoseForm start_pose, PoseForm end_pose) {
  return guarded([&] {
    const Transform start = pose_from(start_pose, 0, "startPose"), end = pose_from(end_pose, 1, "endPose");
    model->set_motion(points_from(count, is_float32), start, end).value();
  });
}

/// A null b asks about a with itself.
LIMBER_EXPORT(timeOfImpact)
bool exported_time_of_impact(const Moving* a, const Moving* b, double max_time, double time_error,
                             double min_separation, double separation_fraction, bool ignore_crossings, bool any_contact,
                             double deadline_ms, double max_steps) {
  return guarded([&] {
    const ImpactOptions options{.max_time = max_time,
                                .time_error = time_error,
                                .min_separation = min_separation,
                                .separation_fraction = separation_fraction,
                                .ignore_crossings = ignore_crossings,
                                .any_contact = any_contact,
                                .budget = budget_from(deadline_ms, max_steps)};
    give(b != nullptr ? time_of_impact(*a, *b, options) : self_time_of_impact(*a, options));
  });
}

LIMBER_EXPORT(newRigidMotion) Motion* new_rigid_motion(PoseForm start, PoseForm end, double x, double y, double z) {
  return made([&] { return new Motion(pose_from(start, 0, "start"), pose_from(end, 1, "end"), Vec3{x, y, z}); });
}

/// Gives where the 4 x 4 matrix at a time is, by columns.
LIMBER_EXPORT(poseAt) bool pose_at(const Motion* motion, double time) {
  return guarded([&] {
    const auto matrix = matrix_of(motion->at(time), MatrixOrder::column_major);
    std::copy(matrix.begin(), matrix.end(), exchange.answer);
    give_bytes(exchange.answer, sizeof(matrix));
  });
}

LIMBER_EXPORT(rigidTimeOfImpact)
bool exported_rigid_time_of_impact(const OwnedBody* a, const Motion* motion_a, const OwnedBody* b,
                                   const Motion* motion_b, double max_time, double min_separation, bool has_error,
                                   double distance_error, double deadline_ms, double max_steps,
                                   Owned<QueryCache>* cache) {
  return guarded([&] {
    const PathOptions options{max_time, min_separation, has_error ? std::optional(distance_error) : std::nullopt, cache,
                              budget_from(deadline_ms, max_steps)};
    give(time_of_impact(a->body(), motion_from(motion_a), b->body(), motion_from(motion_b), options));
  });
}

}  // namespace limber::web

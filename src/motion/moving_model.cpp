// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cstddef>
#include <utility>

#include "base/access.h"
#include "base/check.h"
#include "base/float_environment.h"
#include "base/parallel.h"
#include "geometry/rigid.h"
#include "mesh/updates.h"
#include "model/model_impl.h"
#include "motion/moving_model_impl.h"

namespace limber {
namespace {

/// Fewer vertices are not worth a task.
constexpr std::size_t vertices_per_task = 4096;

void place(std::span<const Vec3> positions, const Transform& pose, std::vector<Vec3>& placed) {
  placed.resize(positions.size());
  const bool stays = pose == Transform{};
  base::parallel_for_ranges(positions.size(), vertices_per_task, [&](std::size_t begin, std::size_t end) {
    if (stays) {
      std::copy_n(positions.data() + begin, end - begin, placed.data() + begin);
    } else {
      for (std::size_t i = begin; i < end; ++i) placed[i] = pose(positions[i]);
    }
  });
}

}  // namespace

MovingModel::MovingModel(const Model& model) : impl_(std::make_unique<Impl>()) {
  LIMBER_REQUIRE(model.is_valid(), "limber::MovingModel: the model has been moved from");
  impl_->model = &model;
}
MovingModel::MovingModel(MovingModel&&) noexcept = default;
MovingModel& MovingModel::operator=(MovingModel&&) noexcept = default;
MovingModel::~MovingModel() = default;

const MovingModel::Impl& MovingModel::impl() const {
  LIMBER_REQUIRE(impl_ != nullptr, "limber::MovingModel: the object has been moved from");
  return *impl_;
}

Result<void> MovingModel::set_motion(std::span<const Vec3> end_positions, const Transform& start_pose,
                                     const Transform& end_pose) {
  const base::DefaultFloatEnvironment environment;
  LIMBER_REQUIRE(impl_ != nullptr, "limber::MovingModel::set_motion: the object has been moved from");
  const Model& model = *impl_->model;
  LIMBER_REQUIRE(model.is_committed(),
                 "limber::MovingModel::set_motion: the model has moves without a commit(), "
                 "or has been moved from");
  geometry::require_rigid(start_pose, "limber::MovingModel::set_motion: start_pose");
  geometry::require_rigid(end_pose, "limber::MovingModel::set_motion: end_pose");
  if (auto valid = check_update_of_all(model.mesh(), end_positions); !valid) return valid;
  const bvh::Tree& tree = Access::impl(model).tree;
  impl_->has_motion = false;
  impl_->edges = &model.edges();
  impl_->start_pose = start_pose;
  place(model.mesh().positions(), start_pose, impl_->start);
  place(end_positions, end_pose, impl_->end);
  bvh::fit(impl_->tree, tree, impl_->start, impl_->end);
  impl_->build_id = tree.build_id, impl_->displacement = tree.displacement, impl_->has_motion = true;
  return {};
}

}  // namespace limber

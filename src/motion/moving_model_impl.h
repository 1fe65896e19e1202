// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bvh/moving_tree.h"
#include "limber/motion.h"

namespace limber {

struct MovingModel::Impl {
  const Model* model;
  const MeshEdges* edges = nullptr;  // of the model when the motion was set
  Transform start_pose;
  std::vector<Vec3> start, end;  // positions of all vertices, in the world
  bvh::MovingTree tree;
  bool has_motion = false;
  // Of the model's tree when the motion was set: both are as they were as long as the model has not changed.
  std::uint64_t build_id = 0;
  double displacement = 0;
};

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "limber/scene.h"
#include "scenes/scenes.h"
#include "scenes/surfaces.h"

namespace limber::bench {

/// 2 000 bodies of about radius 1, a little less than 2 apart: balls of 1 088 triangles, boxes and rings that have
/// fallen into a heap, so that each touches some of its neighbors.
class Heap {
 public:
  Heap() : rng_(17) {
    const Box box{{-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}};
    models_.reserve(3);
    models_.emplace_back(scenes::ball(32, 18));
    models_.emplace_back(scenes::boxes({box}));
    models_.emplace_back(scenes::ring(24, 12, 0.3));
    constexpr std::size_t body_count = 2000, side = 20;
    for (std::size_t i = 0; i < body_count; ++i) {
      const std::size_t row = i / side, layer = row / side;
      const Vec3 cell{static_cast<double>(i % side), static_cast<double>(row % side), static_cast<double>(layer)};
      poses.push_back({scenes::random_rotation(rng_), 1.95 * cell + within(0.05)});
      ids.push_back(scene.add({models_[i % models_.size()], poses.back()}));
    }
  }

  void move() {
    const double angle = 0.01, c = scenes::cosine(angle), s = scenes::sine(angle);
    const Mat3 turn{{c, -s, 0}, {s, c, 0}, {0, 0, 1}};
    for (Transform& pose : poses) {
      pose.translation += within(0.01);
      pose.rotation = turn * pose.rotation;
    }
  }

  Scene scene;
  std::vector<ObjectId> ids;
  std::vector<Transform> poses;

 private:
  Vec3 within(double most) { return {rng_.uniform(-most, most), rng_.uniform(-most, most), rng_.uniform(-most, most)}; }

  scenes::Rng rng_;
  std::vector<Model> models_;
};

}  // namespace limber::bench

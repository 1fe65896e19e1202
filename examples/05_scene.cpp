// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Many bodies: the pairs that may be close, which of them touch, and the clearance of the others.
#include <cmath>
#include <cstdio>
#include <vector>

#include "limber/limber.h"
#include "shapes.h"

int main() {
  const limber::Model ball(shapes::ball(16)), sheet(shapes::sheet(20, 30));
  limber::Scene scene;
  const limber::ObjectId floor = scene.add({sheet});
  std::vector<limber::ObjectId> balls(100);
  for (limber::ObjectId& id : balls) id = scene.add({ball});

  limber::SceneCache cache;  // belongs to this scene; one thread at a time
  std::vector<limber::ObjectPair> pairs;
  std::vector<limber::DistanceResult> distances;
  std::size_t contacts = 0, pairs_asked = 0;
  for (int frame = 0; frame < 50; ++frame) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      const double turn = 0.02 * frame + static_cast<double>(i), height = 1.05 + static_cast<double>(i % 10);
      scene.set_pose(balls[i], {{}, {12 * std::cos(turn), 12 * std::sin(3 * turn), height}});
    }
    scene.commit();  // after poses have changed, and after a model has been committed

    // Candidates: as many as there is room for, and how many there are.
    limber::PairCount found = scene.candidate_pairs(0.1, pairs);
    if (found.count > pairs.size()) {
      pairs.resize(2 * found.count);
      found = scene.candidate_pairs(0.1, pairs);
    }
    distances.resize(found.count);
    const std::span<const limber::ObjectPair> candidates(pairs.data(), found.count);
    scene.distance(candidates, distances, {.distance = {.max_distance = 0.1}, .cache = &cache});  // on all threads
    for (const limber::DistanceResult& d : distances) contacts += d.status == limber::DistanceStatus::collision ? 1 : 0;
    pairs_asked += found.count;
  }

  const auto with_floor = [&](limber::ObjectId a, limber::ObjectId b) { return a == floor || b == floor; };
  const limber::ClosestObjectsResult nearest = scene.closest_objects({.filter = with_floor});
  std::printf("%zu of %zu candidate pairs touch; body %u is nearest to the floor, %.4f above it\n", contacts,
              pairs_asked, nearest.objects.b, nearest.result.upper);
  return contacts > 0 && nearest.objects.a == floor && std::abs(nearest.result.upper - 0.05) < 0.01 ? 0 : 1;
}

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/distance.h"

#include "bindings.h"
#include "limber/model.h"

namespace limber::web {

LIMBER_EXPORT(newCache) QueryCache* new_cache() {
  QueryCache* cache = nullptr;
  guarded([&] { cache = new QueryCache; });
  return cache;
}
LIMBER_EXPORT(deleteCache) void delete_cache(QueryCache* cache) { delete cache; }
LIMBER_EXPORT(clearCache) void clear_cache(QueryCache* cache) { cache->clear(); }

LIMBER_EXPORT(distance)
bool exported_distance(const Model* a, PoseForm pose_a, const Model* b, PoseForm pose_b, double relative_error,
                       double absolute_error, double max_distance, double deadline_ms, double max_steps,
                       QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(*a, pose_from(pose_a, 0)), placed_b(*b, pose_from(pose_b, 1));
    give(distance(placed_a, placed_b,
                  {relative_error, absolute_error, max_distance, cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(collide)
bool exported_collide(const Model* a, PoseForm pose_a, const Model* b, PoseForm pose_b, double deadline_ms,
                      double max_steps, QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(*a, pose_from(pose_a, 0)), placed_b(*b, pose_from(pose_b, 1));
    give(collide(placed_a, placed_b, {cache, budget_from(deadline_ms, max_steps)}));
  });
}

LIMBER_EXPORT(within)
bool exported_within(const Model* a, PoseForm pose_a, const Model* b, PoseForm pose_b, double max_distance,
                     double deadline_ms, double max_steps, QueryCache* cache) {
  return guarded([&] {
    const Placed placed_a(*a, pose_from(pose_a, 0)), placed_b(*b, pose_from(pose_b, 1));
    give(within(placed_a, placed_b, max_distance, {cache, budget_from(deadline_ms, max_steps)}));
  });
}

}  // namespace limber::web

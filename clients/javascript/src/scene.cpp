// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/scene.h"

#include <optional>
#include <span>
#include <vector>

#include "bindings.h"

namespace limber::web {
namespace {

using OwnedScene = Owned<Scene>;

std::vector<ObjectPair> pairs_found;

/// Pairs of ids in input().
std::vector<ObjectPair> object_pairs_from(std::size_t count) {
  const std::span<const ObjectId> ids = ids_from(2 * count);
  std::vector<ObjectPair> pairs(count);
  for (std::size_t i = 0; i < count; ++i) pairs[i] = {ids[2 * i], ids[2 * i + 1]};
  return pairs;
}

/// Asks about the pairs in input().
template <typename Answer, typename Ask>
bool asked_of_pairs(std::size_t count, const Ask& ask) {
  return guarded([&] {
    std::vector<Answer> results(count);
    ask(object_pairs_from(count), std::span(results));
    give_all(std::span<const Answer>(results));
  });
}

}  // namespace

LIMBER_EXPORT(newScene) OwnedScene* new_scene() {
  return made([] { return new OwnedScene; });
}

LIMBER_EXPORT(sceneAdd) bool scene_add(OwnedScene* scene, const OwnedBody* body, PoseForm pose) {
  return guarded([&] { give_numbers(scene->add({body->body(), pose_from(pose, 0, "pose")})); });
}

LIMBER_EXPORT(sceneRemove) bool scene_remove(OwnedScene* scene, ObjectId id) {
  return guarded([&] { scene->remove(id); });
}

LIMBER_EXPORT(sceneSetPose) bool scene_set_pose(OwnedScene* scene, ObjectId id, PoseForm pose) {
  return guarded([&] { scene->set_pose(id, pose_from(pose, 0, "pose")); });
}

LIMBER_EXPORT(sceneCommit) bool scene_commit(OwnedScene* scene) {
  return guarded([&] { scene->commit(); });
}

LIMBER_EXPORT(sceneSize) std::size_t scene_size(const OwnedScene* scene) { return scene->size(); }

LIMBER_EXPORT(sceneCandidatePairs) bool scene_candidate_pairs(const OwnedScene* scene, double margin) {
  return guarded([&] {
    pairs_found.clear();
    scene->visit_candidate_pairs(margin, [](const ObjectPair& pair) { return pairs_found.push_back(pair), true; });
    give_bytes(pairs_found.data(), pairs_found.size() * sizeof(ObjectPair));
  });
}

LIMBER_EXPORT(sceneCollide)
bool scene_collide(const OwnedScene* scene, std::size_t count, double deadline_ms, double max_steps) {
  return asked_of_pairs<CollideResult>(count, [&](const auto& pairs, auto results) {
    scene->collide(pairs, results, {.budget = budget_from(deadline_ms, max_steps)});
  });
}

LIMBER_EXPORT(sceneWithin)
bool scene_within(const OwnedScene* scene, std::size_t count, double max_distance, double deadline_ms,
                  double max_steps) {
  return asked_of_pairs<CollideResult>(count, [&](const auto& pairs, auto results) {
    scene->within(pairs, max_distance, results, {.budget = budget_from(deadline_ms, max_steps)});
  });
}

LIMBER_EXPORT(sceneDistance)
bool scene_distance(const OwnedScene* scene, std::size_t count, double relative_error, double absolute_error,
                    double max_distance, double deadline_ms, double max_steps) {
  return asked_of_pairs<DistanceResult>(count, [&](const auto& pairs, auto results) {
    scene->distance(
        pairs, results,
        {{relative_error, absolute_error, max_distance, nullptr, budget_from(deadline_ms, max_steps)}, {}, nullptr});
  });
}

/// Gives the two objects behind their distance; no_id without any. The pairs of ids in input() do not count.
LIMBER_EXPORT(sceneClosestObjects)
bool scene_closest_objects(const OwnedScene* scene, std::size_t ignored_count, double relative_error,
                           double absolute_error, double max_distance, double deadline_ms, double max_steps) {
  return guarded([&] {
    ObjectPairMatrix counts(scene->id_bound());
    for (const ObjectPair& pair : object_pairs_from(ignored_count)) counts.set(pair.a, pair.b, false);
    std::optional<ObjectPairFilter> filter;
    if (ignored_count > 0) filter = counts;
    const auto found = scene->closest_objects(
        {{relative_error, absolute_error, max_distance, nullptr, budget_from(deadline_ms, max_steps)},
         filter,
         nullptr});
    give(found.result);
    give_numbers(found.objects.a, found.objects.b);
  });
}

}  // namespace limber::web

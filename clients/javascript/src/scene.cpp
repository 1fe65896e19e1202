// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#include "limber/scene.h"

#include <algorithm>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "bindings.h"
#include "limber/distance.h"

namespace limber::web {
namespace {

std::vector<ObjectPair> pairs_found;
std::vector<ObjectId> ids_found;
ObjectContacts contacts_found;
std::vector<std::uint32_t> offsets;  // of those contacts
Columns columns;

/// Ids in input(), behind that many numbers.
std::span<const ObjectId> ids_from(std::size_t count, std::size_t number_count = 0) {
  return {reinterpret_cast<const ObjectId*>(input() + number_count * sizeof(double)), count};
}

std::vector<ObjectPair> object_pairs_from(std::size_t count) {
  const std::span<const ObjectId> ids = ids_from(2 * count);
  std::vector<ObjectPair> pairs(count);
  for (std::size_t i = 0; i < count; ++i) pairs[i] = {ids[2 * i], ids[2 * i + 1]};
  return pairs;
}

/// Matrices in input(), by columns.
///
/// Throws   BadResult, naming the matrix.
std::vector<Transform> poses_from(std::size_t count) {
  const auto* const numbers = reinterpret_cast<const double*>(input());
  std::vector<Transform> poses(count);
  for (std::size_t i = 0; i < count; ++i) {
    const std::span<const double, 16> matrix(numbers + 16 * i, 16);
    const Result<Transform> pose = transform_from_matrix(matrix, MatrixOrder::column_major);
    if (!pose) throw BadResult({pose.error().code, "poses[" + std::to_string(i) + "]: " + pose.error().text, i});
    poses[i] = *pose;
  }
  return poses;
}

std::optional<ObjectPairFilter> filter_from(bool has_filter, const ObjectPairMatrix* matrix) {
  if (matrix != nullptr) return *matrix;
  if (has_filter) return ask_filter;
  return std::nullopt;
}

/// How distances are asked for.
struct DistanceArguments {
  double relative_error, absolute_error, max_distance, deadline_ms, max_steps;
};

SceneDistanceOptions closest_options_from(const DistanceArguments& d, bool has_filter, const ObjectPairMatrix* matrix,
                                          SceneCache* cache) {
  return {{d.relative_error, d.absolute_error, d.max_distance, nullptr, budget_from(d.deadline_ms, d.max_steps)},
          filter_from(has_filter, matrix),
          cache};
}

const DistanceResult& result_of(const DistanceResult& result) { return result; }
const CollideResult& result_of(const CollideResult& result) { return result; }
const DistanceResult& result_of(const ClosestObjectsResult& closest) { return closest.result; }
const CollideResult& result_of(const AnyWithinResult& close) { return close.result; }

std::uint8_t status_of(const DistanceResult& result) { return static_cast<std::uint8_t>(result.status); }
std::uint8_t status_of(const CollideResult& result) { return static_cast<std::uint8_t>(result.answer); }

template <typename T>
constexpr bool names_objects = std::is_same_v<T, ClosestObjectsResult> || std::is_same_v<T, AnyWithinResult>;

/// One column after the other: bounds, of distances alone; points of a, points of b, both statistics; then, in 32 bits,
/// the two objects of each, of configurations alone; triangles of a and of b, which are no_id without a witness; then,
/// in 8 bits, what has stopped the queries, and statuses or answers.
template <typename T>
void give_all(const std::vector<T>& results) {
  constexpr bool has_bounds = std::is_same_v<std::decay_t<decltype(result_of(results[0]))>, DistanceResult>;
  const std::size_t n = results.size();
  columns.begin((has_bounds ? 10 : 8) * n, (names_objects<T> ? 4 : 2) * n, 2 * n);
  const auto witness_of = [](const T& r) { return result_of(r).witness.value_or(Witness{}); };
  if constexpr (has_bounds) {
    for (const T& r : results) *columns.number++ = result_of(r).lower;
    for (const T& r : results) *columns.number++ = result_of(r).upper;
  }
  for (const T& r : results) put(columns.number, witness_of(r).point_a);
  for (const T& r : results) put(columns.number, witness_of(r).point_b);
  for (const T& r : results) *columns.number++ = static_cast<double>(result_of(r).stats.node_tests);
  for (const T& r : results) *columns.number++ = static_cast<double>(result_of(r).stats.primitive_tests);
  if constexpr (names_objects<T>) {
    for (const T& r : results) *columns.id++ = r.objects.a, *columns.id++ = r.objects.b;
  }
  for (const T& r : results) *columns.id++ = witness_of(r).triangle_a;
  for (const T& r : results) *columns.id++ = witness_of(r).triangle_b;
  for (const T& r : results) *columns.byte++ = static_cast<std::uint8_t>(result_of(r).stopped_by);
  for (const T& r : results) *columns.byte++ = status_of(result_of(r));
}

/// The filter of objects is asked about one as about a pair of it and itself.
bool ask_about_one(ObjectId id) { return ask_filter(id, id); }

/// The result, and the two objects behind it; no_id without any.
template <typename T>
void give_objects(const T& found) {
  give(found.result);
  exchange.words[4] = found.objects.a, exchange.words[5] = found.objects.b;
}

}  // namespace

LIMBER_EXPORT(newScene) Scene* new_scene() {
  Scene* scene = nullptr;
  guarded([&] { scene = new Scene; });
  return scene;
}
LIMBER_EXPORT(deleteScene) void delete_scene(Scene* scene) { delete scene; }

LIMBER_EXPORT(sceneAdd) bool scene_add(Scene* scene, const BodyOwner* body, PoseForm pose) {
  return guarded([&] { exchange.words[0] = scene->add({body->body(), pose_from(pose, 0, "pose")}); });
}

LIMBER_EXPORT(sceneRemove) bool scene_remove(Scene* scene, ObjectId id) {
  return guarded([&] { scene->remove(id); });
}

LIMBER_EXPORT(sceneSetPose) bool scene_set_pose(Scene* scene, ObjectId id, PoseForm pose) {
  return guarded([&] { scene->set_pose(id, pose_from(pose, 0, "pose")); });
}

/// Matrices in input(), then ids.
LIMBER_EXPORT(sceneSetPoses) bool scene_set_poses(Scene* scene, std::size_t count) {
  return guarded([&] { scene->set_poses(ids_from(count, 16 * count), poses_from(count)); });
}

LIMBER_EXPORT(sceneCommit) bool scene_commit(Scene* scene) {
  return guarded([&] { scene->commit(); });
}

LIMBER_EXPORT(sceneIsCommitted) bool scene_is_committed(const Scene* scene) { return scene->is_committed(); }
LIMBER_EXPORT(sceneSize) std::size_t scene_size(const Scene* scene) { return scene->size(); }
LIMBER_EXPORT(sceneIdBound) ObjectId scene_id_bound(const Scene* scene) { return scene->id_bound(); }

/// The matrix, by columns, to Exchange::numbers.
LIMBER_EXPORT(scenePose) bool scene_pose(const Scene* scene, ObjectId id) {
  return guarded([&] {
    const std::array<double, 16> matrix = matrix_of(scene->object(id).pose, MatrixOrder::column_major);
    std::copy(matrix.begin(), matrix.end(), exchange.numbers);
  });
}

LIMBER_EXPORT(sceneBoundingBox) bool scene_bounding_box(const Scene* scene, ObjectId id) {
  return guarded([&] {
    const Box box = scene->bounding_box(id);
    double* to = exchange.numbers;
    put(to, box.low), put(to, box.high);
  });
}

LIMBER_EXPORT(sceneCandidatePairs)
bool scene_candidate_pairs(const Scene* scene, double margin, bool has_filter, const ObjectPairMatrix* matrix) {
  return guarded([&] {
    pairs_found.clear();
    const auto keep = [](const ObjectPair& pair) { return pairs_found.push_back(pair), true; };
    scene->visit_candidate_pairs(margin, keep, filter_from(has_filter, matrix));
    give_bytes(pairs_found.data(), pairs_found.size() * sizeof(ObjectPair));
  });
}

// --- the pairs in input() ---

LIMBER_EXPORT(sceneCollide)
bool scene_collide(const Scene* scene, std::size_t count, double deadline_ms, double max_steps, SceneCache* cache) {
  return guarded([&] {
    std::vector<CollideResult> results(count);
    scene->collide(object_pairs_from(count), results, {.cache = cache, .budget = budget_from(deadline_ms, max_steps)});
    give_all(results);
  });
}

LIMBER_EXPORT(sceneWithin)
bool scene_within(const Scene* scene, std::size_t count, double max_distance, double deadline_ms, double max_steps,
                  SceneCache* cache) {
  return guarded([&] {
    std::vector<CollideResult> results(count);
    const SceneQueryOptions options{.cache = cache, .budget = budget_from(deadline_ms, max_steps)};
    scene->within(object_pairs_from(count), max_distance, results, options);
    give_all(results);
  });
}

LIMBER_EXPORT(sceneDistance)
bool scene_distance(const Scene* scene, std::size_t count, double relative_error, double absolute_error,
                    double max_distance, double deadline_ms, double max_steps, SceneCache* cache) {
  return guarded([&] {
    std::vector<DistanceResult> results(count);
    const DistanceArguments asked{relative_error, absolute_error, max_distance, deadline_ms, max_steps};
    scene->distance(object_pairs_from(count), results, closest_options_from(asked, false, nullptr, cache));
    give_all(results);
  });
}

/// Writes where each pair's contacts begin, and where the last ones end, behind what give_contacts() tells.
LIMBER_EXPORT(sceneContacts)
bool scene_contacts(const Scene* scene, std::size_t count, double margin, int oriented_faces) {
  return guarded([&] {
    scene->contacts(object_pairs_from(count), margin, contacts_found,
                    {.oriented_faces = oriented_faces_from(oriented_faces)});
    offsets.assign(contacts_found.offsets.begin(), contacts_found.offsets.end());
    give_contacts(contacts_found.contacts, {});
    exchange.words[4] = address_of(offsets.data());
  });
}

// --- all pairs ---

LIMBER_EXPORT(sceneClosestObjects)
bool scene_closest_objects(const Scene* scene, double relative_error, double absolute_error, double max_distance,
                           double deadline_ms, double max_steps, bool has_filter, const ObjectPairMatrix* matrix,
                           SceneCache* cache) {
  return guarded([&] {
    const DistanceArguments asked{relative_error, absolute_error, max_distance, deadline_ms, max_steps};
    give_objects(scene->closest_objects(closest_options_from(asked, has_filter, matrix, cache)));
  });
}

LIMBER_EXPORT(sceneAnyWithin)
bool scene_any_within(const Scene* scene, double max_distance, double deadline_ms, double max_steps, bool has_filter,
                      const ObjectPairMatrix* matrix) {
  return guarded([&] {
    const SceneQueryOptions options{.filter = filter_from(has_filter, matrix),
                                    .budget = budget_from(deadline_ms, max_steps)};
    give_objects(scene->any_within(max_distance, options));
  });
}

// --- one body next to all objects ---

LIMBER_EXPORT(sceneCandidates)
bool scene_candidates(const Scene* scene, const BodyOwner* body, PoseForm pose, double margin, bool has_filter) {
  return guarded([&] {
    ids_found.clear();
    const auto keep = [](ObjectId id) { return ids_found.push_back(id), true; };
    scene->visit_candidates({body->body(), pose_from(pose, 0, "pose")}, margin, keep,
                            has_filter ? std::optional<ObjectFilter>(ask_about_one) : std::nullopt);
    give_bytes(ids_found.data(), ids_found.size() * sizeof(ObjectId));
  });
}

LIMBER_EXPORT(sceneClosestObject)
bool scene_closest_object(const Scene* scene, const BodyOwner* body, PoseForm pose, double relative_error,
                          double absolute_error, double max_distance, double deadline_ms, double max_steps,
                          bool has_filter) {
  return guarded([&] {
    const Placed placed(body->body(), pose_from(pose, 0, "pose"));
    const ClosestObjectResult found = scene->closest_object(
        placed, {{relative_error, absolute_error, max_distance, nullptr, budget_from(deadline_ms, max_steps)},
                 has_filter ? std::optional<ObjectFilter>(ask_about_one) : std::nullopt});
    give(found.result);
    exchange.words[4] = found.object;
  });
}

LIMBER_EXPORT(sceneTimeOfImpact)
bool scene_time_of_impact(const Scene* scene, const BodyOwner* body, const RigidMotion* motion, double max_time,
                          double min_separation, bool has_error, double distance_error, double deadline_ms,
                          double max_steps, bool has_filter) {
  return guarded([&] {
    const ObjectImpactResult found =
        scene->time_of_impact(body->body(), motion != nullptr ? *motion : RigidMotion(),
                              {{max_time, min_separation, error_from(has_error, distance_error), nullptr,
                                budget_from(deadline_ms, max_steps)},
                               has_filter ? std::optional<ObjectFilter>(ask_about_one) : std::nullopt});
    give(found.result);
    exchange.words[4] = found.object;
  });
}

// --- configurations: matrices in input(), then the ids ---

LIMBER_EXPORT(sceneClosestObjectsMany)
bool scene_closest_objects_many(const Scene* scene, std::size_t ids, std::size_t configurations, double relative_error,
                                double absolute_error, double max_distance, double deadline_ms, double max_steps,
                                bool has_filter, const ObjectPairMatrix* matrix) {
  return guarded([&] {
    const DistanceArguments asked{relative_error, absolute_error, max_distance, deadline_ms, max_steps};
    const std::size_t poses = ids * configurations;
    std::vector<ClosestObjectsResult> results(configurations);
    scene->closest_objects_many(ids_from(ids, 16 * poses), poses_from(poses), results,
                                closest_options_from(asked, has_filter, matrix, nullptr));
    give_all(results);
  });
}

LIMBER_EXPORT(sceneAnyWithinMany)
bool scene_any_within_many(const Scene* scene, std::size_t ids, std::size_t configurations, double max_distance,
                           double deadline_ms, double max_steps, bool has_filter, const ObjectPairMatrix* matrix) {
  return guarded([&] {
    const std::size_t poses = ids * configurations;
    std::vector<AnyWithinResult> results(configurations);
    scene->any_within_many(ids_from(ids, 16 * poses), poses_from(poses), max_distance, results,
                           {.filter = filter_from(has_filter, matrix), .budget = budget_from(deadline_ms, max_steps)});
    give_all(results);
  });
}

// --- which pairs count ---

LIMBER_EXPORT(newObjectPairMatrix) ObjectPairMatrix* new_object_pair_matrix(std::size_t size, bool counts) {
  ObjectPairMatrix* matrix = nullptr;
  guarded([&] { matrix = new ObjectPairMatrix(size, counts); });
  return matrix;
}
LIMBER_EXPORT(deleteObjectPairMatrix) void delete_object_pair_matrix(ObjectPairMatrix* matrix) { delete matrix; }
LIMBER_EXPORT(matrixSize) std::size_t matrix_size(const ObjectPairMatrix* matrix) { return matrix->size(); }

LIMBER_EXPORT(matrixSet) bool matrix_set(ObjectPairMatrix* matrix, ObjectId a, ObjectId b, bool counts) {
  return guarded([&] { matrix->set(a, b, counts); });
}

/// Of the ids in input(), with each other.
LIMBER_EXPORT(matrixSetAmong) bool matrix_set_among(ObjectPairMatrix* matrix, std::size_t count, bool counts) {
  return guarded([&] { matrix->set_among(ids_from(count), counts); });
}

/// Of the first ids in input() with the others.
LIMBER_EXPORT(matrixSetBetween)
bool matrix_set_between(ObjectPairMatrix* matrix, std::size_t first, std::size_t others, bool counts) {
  return guarded([&] {
    const std::span<const ObjectId> ids = ids_from(first + others);
    matrix->set_between(ids.first(first), ids.subspan(first), counts);
  });
}

LIMBER_EXPORT(matrixCounts) bool matrix_counts(const ObjectPairMatrix* matrix, ObjectId a, ObjectId b) {
  return guarded([&] { exchange.words[0] = (*matrix)(a, b) ? 1 : 0; });
}

// --- caches ---

LIMBER_EXPORT(newSceneCache) SceneCache* new_scene_cache(std::size_t max_pairs) {
  SceneCache* cache = nullptr;
  guarded([&] { cache = new SceneCache(max_pairs); });
  return cache;
}
LIMBER_EXPORT(deleteSceneCache) void delete_scene_cache(SceneCache* cache) { delete cache; }
LIMBER_EXPORT(clearSceneCache) void clear_scene_cache(SceneCache* cache) { cache->clear(); }

}  // namespace limber::web

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of pairs of objects, on all threads.
#include "base/arguments.h"
#include "base/check.h"
#include "base/parallel.h"
#include "limber/distance.h"
#include "scene/scene_cache_impl.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

// Every pair may be a task of its own: the shortest queries take as long as starting one, others a thousand times that.
constexpr std::size_t pairs_per_task = 1;

void check_pairs(const Scene::Impl& scene, std::span<const ObjectPair> pairs, std::size_t result_count) {
  LIMBER_REQUIRE(scene.is_committed(),
                 "limber::Scene: a query needs a committed scene; objects or models have changed since then");
  LIMBER_REQUIRE(pairs.size() == result_count, "limber::Scene: results: there are not as many as pairs");
  for (const ObjectPair& pair : pairs) {
    LIMBER_REQUIRE(scene.contains(pair.a) && scene.contains(pair.b),
                   "limber::Scene: pairs: one of them names no object of the scene");
  }
}

/// Calls ask(i, a, b, cache) for each pair i of objects a and b.
template <typename Ask>
void ask_each(const Scene::Impl& scene, std::span<const ObjectPair> pairs, SceneCache* cache, const Ask& ask) {
  std::span<QueryCache* const> caches;
  if (cache != nullptr) caches = cache->impl().caches_of(pairs);
  base::parallel_for(pairs.size(), pairs_per_task, [&](std::size_t i) {
    ask(i, scene.placed(pairs[i].a), scene.placed(pairs[i].b), caches.empty() ? nullptr : caches[i]);
  });
}

}  // namespace

void Scene::collide(std::span<const ObjectPair> pairs, std::span<CollideResult> results,
                    const SceneQueryOptions& options) const {
  const Impl& scene = impl("collide");
  check_pairs(scene, pairs, results.size());
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    results[i] = limber::collide(a, b, {.cache = cache});
  });
}

void Scene::within(std::span<const ObjectPair> pairs, double max_distance, std::span<CollideResult> results,
                   const SceneQueryOptions& options) const {
  const Impl& scene = impl("within");
  check_pairs(scene, pairs, results.size());
  base::check_max_distance(max_distance);
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    results[i] = limber::within(a, b, max_distance, {.cache = cache});
  });
}

void Scene::distance(std::span<const ObjectPair> pairs, std::span<DistanceResult> results,
                     const SceneDistanceOptions& options) const {
  const Impl& scene = impl("distance");
  check_pairs(scene, pairs, results.size());
  const DistanceOptions of_pair{options.relative_error, options.absolute_error, options.max_distance};
  base::check_options(of_pair, "limber::Scene::distance");
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    DistanceOptions with_cache = of_pair;
    with_cache.cache = cache;
    results[i] = limber::distance(a, b, with_cache);
  });
}

}  // namespace limber

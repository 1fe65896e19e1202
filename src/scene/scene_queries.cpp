// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of pairs of objects, on all threads.
#include <vector>

#include "base/arguments.h"
#include "base/check.h"
#include "base/parallel.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "scene/scene_cache_impl.h"
#include "scene/scene_impl.h"
#include "scene/searches.h"

namespace limber {
namespace {

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
  base::parallel_for(pairs.size(), scene::pairs_per_task, [&](std::size_t i) {
    ask(i, scene.placed(pairs[i].a), scene.placed(pairs[i].b), caches.empty() ? nullptr : caches[i]);
  });
}

}  // namespace

void Scene::collide(std::span<const ObjectPair> pairs, std::span<CollideResult> results,
                    const SceneQueryOptions& options) const {
  const Impl& scene = impl("collide");
  check_pairs(scene, pairs, results.size());
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    results[i] = limber::collide(a, b, {.cache = cache, .budget = options.budget});
  });
}

void Scene::within(std::span<const ObjectPair> pairs, double max_distance, std::span<CollideResult> results,
                   const SceneQueryOptions& options) const {
  const Impl& scene = impl("within");
  check_pairs(scene, pairs, results.size());
  base::check_max_distance(max_distance);
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    results[i] = limber::within(a, b, max_distance, {.cache = cache, .budget = options.budget});
  });
}

void Scene::distance(std::span<const ObjectPair> pairs, std::span<DistanceResult> results,
                     const SceneDistanceOptions& options) const {
  const Impl& scene = impl("distance");
  check_pairs(scene, pairs, results.size());
  const DistanceOptions of_pair{options.relative_error, options.absolute_error, options.max_distance, nullptr,
                                options.budget};
  base::check_options(of_pair, "limber::Scene::distance");
  ask_each(scene, pairs, options.cache, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
    DistanceOptions with_cache = of_pair;
    with_cache.cache = cache;
    results[i] = limber::distance(a, b, with_cache);
  });
}

ObjectContacts Scene::contacts(std::span<const ObjectPair> pairs, double margin,
                               const ObjectContactOptions& options) const {
  const Impl& scene = impl("contacts");
  check_pairs(scene, pairs, pairs.size());
  base::check_margin(margin, "limber::Scene::contacts");
  std::vector<std::vector<Contact>> found(pairs.size());
  ask_each(scene, pairs, nullptr, [&](std::size_t i, const Placed& a, const Placed& b, QueryCache*) {
    const auto keep = [&](const Contact& contact) { return found[i].push_back(contact), true; };
    visit_contacts(a, b, margin, keep, {.oriented_faces = options.oriented_faces});
  });
  ObjectContacts all;
  all.offsets.reserve(pairs.size() + 1);
  all.offsets.push_back(0);
  for (const std::vector<Contact>& of_pair : found) all.offsets.push_back(all.offsets.back() + of_pair.size());
  all.contacts.reserve(all.offsets.back());
  for (const std::vector<Contact>& of_pair : found) {
    all.contacts.insert(all.contacts.end(), of_pair.begin(), of_pair.end());
  }
  return all;
}

}  // namespace limber

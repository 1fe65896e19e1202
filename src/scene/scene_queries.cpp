// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause

// Queries of pairs of objects, on all threads, and the caches of these pairs.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <utility>
#include <vector>

#include "base/access.h"
#include "base/arguments.h"
#include "base/check.h"
#include "base/parallel.h"
#include "limber/contacts.h"
#include "limber/distance.h"
#include "scene/scene_impl.h"

namespace limber {
namespace {

constexpr std::size_t no_entry = static_cast<std::size_t>(-1);

std::uint64_t key_of(const ObjectPair& pair) { return std::uint64_t{pair.a} << 32 | pair.b; }

void check_pairs(const Scene::Impl& scene, std::span<const ObjectPair> pairs, std::size_t result_count,
                 const std::optional<ObjectPairFilter>& filter) {
  LIMBER_REQUIRE(scene.is_committed(),
                 "limber::Scene: a query needs a committed scene; objects or models have changed since then");
  LIMBER_REQUIRE(pairs.size() == result_count, "limber::Scene: results: there are not as many as pairs");
  LIMBER_REQUIRE(!filter, "limber::Scene: filter: a list of pairs takes none");
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    LIMBER_REQUIRE_ENTRY(scene.contains(pairs[i].a) && scene.contains(pairs[i].b), "limber::Scene: pairs", i,
                         "names no object of the scene");
  }
}

/// Calls ask(i, a, b, cache) for each pair i of objects a and b, unless nobody wants the answers any more.
template <typename Ask>
void ask_each(const Scene::Impl& scene, std::span<const ObjectPair> pairs, SceneCache* cache, const QueryBudget& budget,
              const Ask& ask) {
  std::span<QueryCache* const> caches;
  if (cache != nullptr) caches = Access::impl(*cache).caches_of(pairs);
  const std::atomic<bool>* const abandon = budget.abandon;
  base::parallel_for(pairs.size(), scene::pairs_per_task, [&](std::size_t i) {
    if (abandon != nullptr && abandon->load(std::memory_order_relaxed)) return;
    ask(i, scene.placed(pairs[i].a), scene.placed(pairs[i].b), caches.empty() ? nullptr : caches[i]);
  });
}

// Pairs whose contacts are found by one task: some microseconds where nothing touches.
constexpr std::size_t pairs_of_chunk = 8;

/// Room for the contacts of all pairs, if they go on as those that are done have begun, and some more; but at most 16
/// times what there is, as few may be done.
std::size_t room_for(std::size_t count, std::size_t done, std::size_t pairs) {
  LIMBER_ASSERT(done > 0 && done <= pairs);
  constexpr double spare = 1.1;
  const double expected = static_cast<double>(count) * static_cast<double>(pairs) / static_cast<double>(done);
  const auto more = static_cast<std::size_t>(std::min(expected, 16.0 * static_cast<double>(count)) * spare);
  return done == pairs ? count : std::max(count, more);
}

}  // namespace

SceneCache::SceneCache(std::size_t max_pairs) : max_pairs_(max_pairs) {}
SceneCache::SceneCache(SceneCache&&) noexcept = default;
SceneCache& SceneCache::operator=(SceneCache&&) noexcept = default;
SceneCache::~SceneCache() = default;

void SceneCache::clear() { impl_.reset(); }

SceneCache::Impl& SceneCache::impl() {
  if (impl_ == nullptr) impl_ = std::make_unique<Impl>(max_pairs_);
  return *impl_;
}

std::span<QueryCache* const> SceneCache::Impl::caches_of(std::span<const ObjectPair> pairs) {
  ++call_;
  taken_.assign(pairs.size(), no_entry), caches_.assign(pairs.size(), nullptr);
  // First those that have one, so that no other pair takes it.
  std::size_t without = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const auto found = entry_of_key_.find(key_of(pairs[i]));
    if (found == entry_of_key_.end()) {
      ++without;
    } else if (std::exchange(entries_[found->second].last_call, call_) != call_) {
      taken_[i] = found->second;
    }
  }
  unused_.clear();
  if (entries_.size() + without > max_entries_) find_unused();
  for (std::size_t i = 0; i < pairs.size() && without > 0; ++i) {
    const std::uint64_t key = key_of(pairs[i]);
    if (taken_[i] != no_entry || entry_of_key_.contains(key)) continue;
    if (entries_.size() < max_entries_) {
      entries_.emplace_back();
      taken_[i] = entries_.size() - 1;
    } else if (!unused_.empty()) {
      taken_[i] = unused_.back();
      unused_.pop_back();
      entry_of_key_.erase(entries_[taken_[i]].key);
    } else {
      break;
    }
    entry_of_key_.emplace(key, taken_[i]);
    entries_[taken_[i]].key = key, entries_[taken_[i]].last_call = call_;
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (taken_[i] != no_entry) caches_[i] = &entries_[taken_[i]].cache;
  }
  return caches_;
}

/// Lists the entries that no pair of this call has, the one to be given away first at the end.
void SceneCache::Impl::find_unused() {
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    if (entries_[i].last_call < call_) unused_.push_back(i);
  }
  std::sort(unused_.begin(), unused_.end(), [&](std::size_t i, std::size_t j) {
    return std::pair(entries_[j].last_call, j) < std::pair(entries_[i].last_call, i);
  });
}

void Scene::collide(std::span<const ObjectPair> pairs, std::span<CollideResult> results,
                    const SceneQueryOptions& options) const {
  const Impl& scene = impl("collide");
  check_pairs(scene, pairs, results.size(), options.filter);
  ask_each(scene, pairs, options.cache, options.budget,
           [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
             results[i] = limber::collide(a, b, {.cache = cache, .budget = options.budget});
           });
}

void Scene::within(std::span<const ObjectPair> pairs, double max_distance, std::span<CollideResult> results,
                   const SceneQueryOptions& options) const {
  const Impl& scene = impl("within");
  check_pairs(scene, pairs, results.size(), options.filter);
  base::check_max_distance(max_distance);
  ask_each(scene, pairs, options.cache, options.budget,
           [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
             results[i] = limber::within(a, b, max_distance, {.cache = cache, .budget = options.budget});
           });
}

void Scene::distance(std::span<const ObjectPair> pairs, std::span<DistanceResult> results,
                     const SceneDistanceOptions& options) const {
  const Impl& scene = impl("distance");
  check_pairs(scene, pairs, results.size(), options.filter);
  scene::check_options(options.distance, "limber::Scene::distance");
  ask_each(scene, pairs, options.cache, options.distance.budget,
           [&](std::size_t i, const Placed& a, const Placed& b, QueryCache* cache) {
             DistanceOptions with_cache = options.distance;
             with_cache.cache = cache;
             results[i] = limber::distance(a, b, with_cache);
           });
}

void Scene::contacts(std::span<const ObjectPair> pairs, double margin, ObjectContacts& found,
                     const PairOptions& options) const {
  const Impl& scene = impl("contacts");
  check_pairs(scene, pairs, pairs.size(), std::nullopt);
  base::check_margin(margin, "limber::Scene::contacts");
  PairOptions of_each = options;
  of_each.parallel = false;  // pairs are
  // Contacts of some pairs at a time are appended while those of others are found: stored once more, all of them would
  // take as much memory again.
  struct Chunk {
    std::vector<Contact> contacts;
    std::vector<std::size_t> ends;  // of each pair, in `contacts`
  };
  std::atomic<std::size_t> cut = pairs.size();  // the first pair that the budget does not allow for
  const auto find = [&](std::size_t chunk, Chunk& of_chunk) {
    const std::size_t begin = chunk * pairs_of_chunk, end = std::min(begin + pairs_of_chunk, pairs.size());
    const auto keep = [&](const Contact& contact) { return of_chunk.contacts.push_back(contact), true; };
    for (std::size_t i = begin; i < std::min(end, cut.load()); ++i) {
      const PairCount of_pair =
          visit_contacts(scene.placed(pairs[i].a), scene.placed(pairs[i].b), margin, keep, of_each);
      if (of_pair.stopped_by == StoppedBy::nothing) {
        of_chunk.ends.push_back(of_chunk.contacts.size());
      } else {
        for (std::size_t least = cut; i < least && !cut.compare_exchange_weak(least, i);) continue;
      }
    }
    of_chunk.contacts.resize(of_chunk.ends.empty() ? 0 : of_chunk.ends.back());
  };
  ObjectContacts all = std::exchange(found, {});
  all.contacts.clear(), all.offsets.clear();
  all.offsets.reserve(pairs.size() + 1);
  all.offsets.push_back(0);
  const auto append = [&](Chunk& chunk) {
    if (all.offsets.size() > cut) chunk = {};  // behind the cut
    const std::size_t count = all.contacts.size(), done = all.offsets.size() - 1 + chunk.ends.size();
    if (count + chunk.contacts.size() > all.contacts.capacity()) {
      all.contacts.reserve(room_for(count + chunk.contacts.size(), done, pairs.size()));
    }
    all.contacts.insert(all.contacts.end(), chunk.contacts.begin(), chunk.contacts.end());
    for (const std::size_t end : chunk.ends) all.offsets.push_back(count + end);
    chunk.contacts.clear(), chunk.ends.clear();
  };
  base::parallel_in_order<Chunk>((pairs.size() + pairs_of_chunk - 1) / pairs_of_chunk, find, append);
  LIMBER_ASSERT(all.offsets.size() == cut + 1 && all.offsets.back() == all.contacts.size());
  found = std::move(all);
}

}  // namespace limber

// SPDX-FileCopyrightText: The limber authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/arguments.h"
#include "base/check.h"
#include "limber/scene.h"
#include "scene/box_tree.h"
#include "scene/world_bounds.h"

namespace limber {

struct Scene::Impl {
  struct Object {
    Placed placed;
    scene::LocalBounds local{};
    scene::ModelState state{};  // when `local` was read
    bool exists = true;
    bool is_moved = true;  // since the last commit
  };

  std::vector<Object> objects;             // by id
  std::vector<scene::WorldBounds> bounds;  // by id
  std::vector<ObjectId> free_ids;          // the last one is taken first
  std::vector<ObjectId> ids;               // of the objects in the tree, ascending
  scene::BoxTree tree;
  bool is_changed = false;  // since the last commit

  bool contains(ObjectId id) const { return id < objects.size() && objects[id].exists; }
  bool is_committed() const;
  void set_pose(ObjectId id, const Transform& world_from_model) {
    LIMBER_ASSERT(contains(id));
    objects[id].placed.pose = world_from_model;
    objects[id].is_moved = true;
  }
  void update_bounds(ObjectId id);

  ObjectPair pair_of(std::uint32_t rank_a, std::uint32_t rank_b) const {
    const ObjectId a = tree.id_of(rank_a), b = tree.id_of(rank_b);
    return a < b ? ObjectPair{a, b} : ObjectPair{b, a};
  }
  const Placed& placed(ObjectId id) const {
    LIMBER_ASSERT(contains(id));
    return objects[id].placed;
  }
};

/// Query caches of the pairs asked about last.
struct SceneCache::Impl {
  explicit Impl(std::size_t max_pairs) : max_entries_(max_pairs) {}

  /// The caches for queries of some pairs, nullptr where a pair gets none: all are taken by others of these pairs, or
  /// the pair has been there before. Valid until the next call.
  std::span<QueryCache* const> caches_of(std::span<const ObjectPair> pairs);

  ObjectPair closest;  // of the last scene that was asked for its closest objects

 private:
  struct Entry {
    std::uint64_t key = 0;
    std::uint64_t last_call = 0;  // in which it was taken
    QueryCache cache;
  };
  void find_unused();

  std::size_t max_entries_;
  std::uint64_t call_ = 0;
  std::vector<Entry> entries_;
  std::unordered_map<std::uint64_t, std::size_t> entry_of_key_;
  std::vector<std::size_t> taken_, unused_;
  std::vector<QueryCache*> caches_;
};

namespace scene {

inline void require_committed(const Scene::Impl& scene, const char* function) {
  LIMBER_REQUIRE(scene.is_committed(),
                 (std::string(function) + ": objects or models have changed since the last commit").c_str());
}

// Searches for one pair, which queries of one configuration and of many share. Their answers do not depend on the tasks
// that they make.

/// Every pair may be a task of its own: the shortest queries take as long as starting one, others a thousand times as
/// long.
constexpr std::size_t pairs_per_task = 1;
/// A search that is itself a part of a task makes none: it would wait for tasks, and take up others meanwhile.
constexpr std::size_t no_tasks = std::numeric_limits<std::size_t>::max();

/// Searches ask rounds of pairs, all of a round at once. The first round is small, because it decides how many pairs
/// there are to be asked at all; every other one is twice as large as the one before, up to this.
constexpr std::size_t most_in_round = 64;

/// Pre: the scene is committed, and the options are what they have to be.
ClosestObjectsResult find_closest(const Scene::Impl& scene, const SceneDistanceOptions& options, std::size_t grain);
AnyWithinResult find_any_within(const Scene::Impl& scene, double max_distance, const SceneQueryOptions& options,
                                std::size_t grain);

/// Checks how distances of a scene are asked for: its caches are those of scenes.
inline void check_options(const DistanceOptions& options, const char* function) {
  base::check_options(options, function);
  LIMBER_REQUIRE(options.cache == nullptr, (std::string(function) + ": distance takes no cache of two models").c_str());
}

/// Whether a budget ends all queries that share it, not one of them alone.
inline bool ends_all(StoppedBy stopped_by) {
  return stopped_by == StoppedBy::deadline || stopped_by == StoppedBy::cancel;
}

/// Which limit has ended a call, if one has.
inline StoppedBy ended_by(const QueryBudget& budget) {
  for (const std::atomic<bool>* const flag : {budget.cancel, budget.abandon}) {
    if (flag != nullptr && flag->load(std::memory_order_relaxed)) return StoppedBy::cancel;
  }
  const bool is_late = budget.deadline && std::chrono::steady_clock::now() >= *budget.deadline;
  return is_late ? StoppedBy::deadline : StoppedBy::nothing;
}

/// Takes into account what has stopped a part of a search, if anything has: what ends all stays.
inline void note(StoppedBy part, StoppedBy& search) {
  if (!ends_all(search) && part != StoppedBy::nothing) search = part;
}

}  // namespace scene
}  // namespace limber
